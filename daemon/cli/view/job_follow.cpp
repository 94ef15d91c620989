// SPDX-License-Identifier: MIT
#include "daemon/cli/view/job_follow.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "daemon/cli/view/job_view.hpp"
#include "daemon/cli/view/progress_bar.hpp"

namespace popcut::cli {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

std::atomic<bool> end_asked{false};
extern "C" void end_the_view(int) { end_asked = true; }

constexpr double kLookEverySeconds = 0.25, kLookAnywaySeconds = 2, kAwaySeconds = 60;

double since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

/// Waits for an event, or the time to look without one. Errors are only looked at later.
void wait_for_change(client::EventStream& events) {
  const auto begun = Clock::now();
  std::this_thread::sleep_for(
      std::chrono::milliseconds(static_cast<int>(kLookEverySeconds * 1000)));
  while (!end_asked && since(begun) < kLookAnywaySeconds) {
    const auto got = events.next(0.5);
    if (got && !got->empty()) return;
    if (!got || !events.connected())  // asking now and then will do
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
}

/// Tells what is new about the job.
class Teller {
 public:
  explicit Teller(const Globals& globals) : globals_(globals), bar_(!globals.quiet) {}

  void tell(const Json& job) {
    const std::string state = client::text_of(job, "state");
    const std::vector<std::string> waits = waiting_for(job);
    std::string key = state + fmt::format("{}", job.value("sheet", Json()).dump());
    for (const std::string& line : waits) key += line;
    if (key != told_ && !globals_.quiet) {
      bar_.clear();
      fmt::print(stderr, "{}: {}\n", job_title(job), job_summary(job));
      for (const std::string& line : waiting_lines(waits, 2)) fmt::print(stderr, "{}\n", line);
      std::fflush(stderr);  // off a terminal too somebody waits for it
    }
    told_ = key;
    const double part = part_done(job);
    if (part >= 0) bar_.show(job_summary(job), part, seconds_left(job));
    const bool plans = state == "queued" || state == "planning";
    if (!plans) plan_since_.reset();
    if (plans && !plan_since_) plan_since_ = Clock::now();
    if (plans) bar_.show_time(job_summary(job), since(*plan_since_));
  }

 private:
  const Globals& globals_;
  ProgressBar bar_;
  std::string told_;
  std::optional<Clock::time_point> plan_since_{};  ///< while popcutd makes the plan
};

}  // namespace

ViewEnd::ViewEnd() : before_(std::signal(SIGINT, end_the_view)) { end_asked = false; }
ViewEnd::~ViewEnd() { std::signal(SIGINT, before_); }
bool ViewEnd::asked() { return end_asked; }

Result<Json> follow_job(client::Api& api, const std::string& id, const Globals& globals,
                        const std::function<bool(const Json&)>& enough) {
  const ViewEnd guard;
  client::EventStream events(api.http(), "/v1/events");
  Teller teller(globals);
  auto heard = Clock::now();
  bool away = false;
  while (!end_asked) {
    auto job = api.get("/v1/jobs/" + id, "job " + id);
    if (!job && end_asked) break;  // Ctrl-C broke off the question
    if (job) {
      heard = Clock::now();
      away = false;
      teller.tell(*job);
      if (has_ended(*job) || enough(*job)) return job;
    } else if (job.error().kind != ErrorKind::DeviceGone || since(heard) > kAwaySeconds) {
      return job;
    } else if (!away && !globals.quiet) {
      away = true;
      fmt::print(stderr, "popcutd does not answer; trying again\n");
      std::fflush(stderr);
    }
    wait_for_change(events);
  }
  return fail(ErrorKind::Refused, "job " + id,
              fmt::format("goes on in popcutd; 'popcut jobs {} --watch' follows it again",
                          id.substr(0, 12)));
}

Result<void> watch_events(client::Api& api, const std::function<Result<bool>()>& changed) {
  const ViewEnd guard;
  client::EventStream events(api.http(), "/v1/events");
  while (!end_asked) {
    const auto more = changed();
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
    wait_for_change(events);
  }
  return {};
}

Result<void> verdict(const Json& job) {
  if (client::text_of(job, "state") == "done") return {};
  return fail(ErrorKind::Refused, "job " + short_id(job), "is " + job_summary(job));
}

}  // namespace popcut::cli
