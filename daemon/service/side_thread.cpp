// SPDX-License-Identifier: MIT
#include "daemon/service/side_thread.hpp"

#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {

struct SideThread::State {
  struct Task {
    std::function<void()> work, then;
  };
  explicit State(ServiceThread& service) : thread(service) {}

  void loop() {
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [&] { return ending || !tasks.empty(); });
      if (ending) return;
      Task task = std::move(tasks.front());
      tasks.pop_front();
      lock.unlock();
      try {
        task.work();
      } catch (const std::exception&) {  // `then` finds no result, and says so
      }
      try {
        if (task.then) thread.post(ServiceThread::Lane::Asking, std::move(task.then));
      } catch (const std::exception&) {  // out of memory; requests that wait have a time limit
      }
      task = {};
      lock.lock();
    }
  }

  ServiceThread& thread;
  std::mutex mutex;
  std::condition_variable wake;
  std::deque<Task> tasks;
  std::uint64_t removed{0};
  bool ending{false};
  std::thread own;
};

SideThread::SideThread(ServiceThread& thread, std::function<void(const std::string&)> log)
    : state_(std::make_unique<State>(thread)), log_(std::move(log)) {
  state_->own = std::thread([state = state_.get()] { state->loop(); });
}

SideThread::~SideThread() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->wake.notify_all();
  state_->own.join();
}

void SideThread::run(std::function<void()> work, std::function<void()> then) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->tasks.push_back({std::move(work), std::move(then)});
  }
  state_->wake.notify_all();
}

void SideThread::remove(const std::string& path) {
  const std::filesystem::path place(path);
  const std::string gone = (place.parent_path() / fmt::format(".new-gone-{}-{}", ++state_->removed,
                                                              place.filename().string()))
                               .string();
  if (std::rename(path.c_str(), gone.c_str()) != 0) {
    if (errno != ENOENT && log_)
      log_(fmt::format("{} cannot be removed: {}", path, std::generic_category().message(errno)));
    return;
  }
  run([gone] { remove_tree(gone); });
}

}  // namespace popcut::daemon
