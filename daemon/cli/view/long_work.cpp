// SPDX-License-Identifier: MIT
#include "daemon/cli/view/long_work.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "daemon/cli/view/progress_bar.hpp"

namespace popcut::cli {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{250};

double now_s() {
  const auto since = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(since).count();
}

}  // namespace

LongWork::LongWork(bool wanted, std::string_view what)
    : what_(what), since_s_(now_s()), part_since_s_(since_s_) {
  if (wanted && isatty(STDERR_FILENO) == 1) thread_ = std::thread([this] { draw(); });
}

LongWork::~LongWork() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  over_.notify_all();
  thread_.join();
}

void LongWork::now(std::string_view what, double done) {
  if (!thread_.joinable()) return;
  const std::lock_guard lock(mutex_);
  // Another thing is done, or the same again.
  if (what_ != what || done < done_) {
    what_ = what;
    part_since_s_ = now_s();
    part_begun_ = std::max(done, 0.0);
  }
  done_ = done;
}

Progress LongWork::progress() {
  if (!thread_.joinable()) return {};
  return [this](std::string_view what, double done) { now(what, done); };
}

void LongWork::draw() {
  ProgressBar bar(true);
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, kBetweenLooks, [this] { return ended_; })) {
    const double at = now_s(), taken = at - part_since_s_, gained = done_ - part_begun_;
    if (done_ >= 0.0 && gained > 0.01)
      bar.show(what_, done_, taken * (1.0 - done_) / gained);
    else
      bar.show_time(what_, at - since_s_);
  }
}

}  // namespace popcut::cli
