// SPDX-License-Identifier: MIT
#include <poll.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/planning/fair_line.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/planning/worker_talk.hpp"

namespace popcut::daemon {
namespace {

using planning::CallOff;

class ProcessPlanner final : public Planner {
 public:
  ProcessPlanner(const PlanningLimits& limits, std::string program)
      : limits_(limits), check_limits_(limits), program_(std::move(program)) {
    check_limits_.is_check = limits.check_s < limits.cpu_s;
    check_limits_.cpu_s = std::min(limits.cpu_s, limits.check_s);
    for (int k = 0; k < std::max(1, limits_.processes); ++k)
      threads_.emplace_back([this] { supervise(Lane::Plans); });
    for (const Lane lane : {Lane::Checks, Lane::Checks, Lane::Searches})
      threads_.emplace_back([this, lane] { supervise(lane); });
    threads_.emplace_back([this] { tell_called_off(); });
  }

  ~ProcessPlanner() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      for (std::deque<Task>& queue : waiting_) {
        for (Task& task : queue) called_off_.push_back(std::move(task));
        queue.clear();
      }
      for (const auto& [id, call_off] : running_) call_off->call();
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  ProcessPlanner(const ProcessPlanner&) = delete;
  ProcessPlanner& operator=(const ProcessPlanner&) = delete;

  std::uint64_t start(PlanningTask task, Done done) override {
    std::uint64_t id = 0;
    {
      const std::lock_guard lock(mutex_);
      id = ++last_id_;
      if (!stopping_ && lane_of(task.kind) == Lane::Checks)
        (void)checks_.add({.id = id, .who = task.who, .key = {}});
      std::deque<Task>& queue = stopping_ ? called_off_ : waiting(lane_of(task.kind));
      queue.push_back({id, std::move(task), std::move(done)});
    }
    changed_.notify_all();
    return id;
  }

  void cancel(std::uint64_t id) override {
    const std::lock_guard lock(mutex_);
    if (const auto found = running_.find(id); found != running_.end()) return found->second->call();
    for (std::deque<Task>& queue : waiting_) {
      const auto waits =
          std::find_if(queue.begin(), queue.end(), [&](const Task& task) { return task.id == id; });
      if (waits == queue.end()) continue;
      called_off_.push_back(std::move(*waits));
      queue.erase(waits);
      checks_.remove(id);
      return changed_.notify_all();
    }
  }

 private:
  struct Task {
    std::uint64_t id{};
    PlanningTask task;
    Done done;
  };

  enum class Lane : std::uint8_t { Checks, Plans, Searches };
  static Lane lane_of(PlanningTask::Kind kind) {
    if (kind == PlanningTask::Kind::Check) return Lane::Checks;
    return kind == PlanningTask::Kind::Search ? Lane::Searches : Lane::Plans;
  }
  std::deque<Task>& waiting(Lane lane) { return waiting_.at(static_cast<std::size_t>(lane)); }

  /// Whether a check of `who` may begin here: another process must stay free for the checks of
  /// others, unless this is the only one of `who`.
  [[nodiscard]] bool may_check(Lane lane, const std::string& who) const {
    return std::find(checked_for_.begin(), checked_for_.end(), who) == checked_for_.end() ||
           idle_checkers_ > (lane == Lane::Checks ? 1 : 0);
  }

  /// Takes what is next in a lane; in that of plans a check, where no plan waits.
  std::optional<Task> take(Lane lane) {
    std::deque<Task>& own = waiting(lane);
    if (lane != Lane::Checks && !own.empty()) {
      Task task = std::move(own.front());
      own.pop_front();
      return task;
    }
    if (lane == Lane::Searches) return std::nullopt;
    const auto next = checks_.next([&](const std::string& who) { return may_check(lane, who); });
    if (!next) return std::nullopt;
    std::deque<Task>& checks = waiting(Lane::Checks);
    const auto found = std::find_if(checks.begin(), checks.end(),
                                    [&](const Task& task) { return task.id == next->id; });
    Task task = std::move(*found);
    checks.erase(found);
    return task;
  }

  void supervise(Lane lane) {
    const bool is_checker = lane == Lane::Checks;
    std::unique_lock lock(mutex_);
    if (is_checker) ++idle_checkers_;
    while (!stopping_) {
      std::optional<Task> task = take(lane);
      if (!task) {
        changed_.wait(lock);
        continue;
      }
      const bool is_check = task->task.kind == PlanningTask::Kind::Check;
      if (is_checker) --idle_checkers_;
      if (is_check) checked_for_.push_back(task->task.who);
      CallOff call_off;
      running_[task->id] = &call_off;
      lock.unlock();
      Result<PlanningOutcome> outcome = outcome_of(task->task, call_off);
      lock.lock();
      running_.erase(task->id);
      if (is_checker) ++idle_checkers_;
      if (is_check)
        checked_for_.erase(std::find(checked_for_.begin(), checked_for_.end(), task->task.who));
      lock.unlock();
      changed_.notify_all();
      tell(*task, std::move(outcome));
      task.reset();
      lock.lock();
    }
  }

  // An exception that left one of these threads would end popcutd, and with it a cut.

  Result<PlanningOutcome> outcome_of(PlanningTask& task, const CallOff& call_off) {
    try {
      find_assets(task);
      return run(task, call_off);
    } catch (const std::exception&) {
      return fail(ErrorKind::Internal, "", "out of memory");  // so short that it needs none
    }
  }

  static void tell(const Task& task, Result<PlanningOutcome> outcome) {
    try {
      task.done(std::move(outcome));
    } catch (const std::exception&) {  // no memory to take it
    }
  }

  /// A worker that somebody killed is no fault of the design: it gets two more.
  Result<PlanningOutcome> run(const PlanningTask& task, const CallOff& call_off) {
    constexpr std::size_t kMostTries = 3;
    std::vector<int> signals;
    for (;;) {
      int killed_by = 0;
      Result<PlanningOutcome> outcome = planning::run_in_worker(
          task, task.kind == PlanningTask::Kind::Check ? check_limits_ : limits_, program_,
          call_off, &killed_by);
      if (killed_by == 0) return outcome;
      signals.push_back(killed_by);
      if (signals.size() >= kMostTries)
        return fail(ErrorKind::Infeasible, "",
                    fmt::format("was tried {} times, and each time somebody else killed the "
                                "planner (signal {}); signal 9 is often the system's, for want of "
                                "memory: free some, or lower planner.memory_mib in popcutd.toml",
                                signals.size(), fmt::join(signals, ", then ")));
      // Whatever was short of memory may have ended meanwhile.
      pollfd called{call_off.descriptor(), POLLIN, 0};
      ::poll(&called, 1, 200 * static_cast<int>(signals.size()));
      if (call_off.called()) return fail(ErrorKind::Refused, "", "the planning was cancelled");
    }
  }

  /// Tells those that were called off before they had begun, without waiting for a free process.
  void tell_called_off() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return stopping_ || !called_off_.empty(); });
      if (called_off_.empty()) return;
      Task task = std::move(called_off_.front());
      called_off_.pop_front();
      lock.unlock();
      tell(task, fail(ErrorKind::Refused, "", "the planning was cancelled"));
      task = {};
      lock.lock();
    }
  }

  const PlanningLimits limits_;
  PlanningLimits check_limits_;
  const std::string program_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<std::deque<Task>, 3> waiting_;  ///< by lane
  /// The order of the checks; each of their clients waits for its answer, which limits their
  /// number.
  FairLine checks_{std::numeric_limits<std::size_t>::max(),
                   std::numeric_limits<std::size_t>::max()};
  std::vector<std::string> checked_for_;  ///< the principal of each check at work
  int idle_checkers_{0};                  ///< processes that do only checks, and do none now
  std::deque<Task> called_off_;
  std::map<std::uint64_t, CallOff*> running_;
  std::uint64_t last_id_{};
  bool stopping_{false};
  std::vector<std::thread> threads_;
};

}  // namespace

void find_assets(PlanningTask& task) {
  constexpr std::size_t kMostAssets = 64, kMostLookups = 1000, kIdSize = 71;
  constexpr std::uintmax_t kMostBytes = 64u << 20;
  constexpr std::string_view kPrefix = "sha256-";
  if (task.assets_folder.empty() || task.media_type.find("json") == std::string::npos) return;
  std::error_code ignored;
  std::string text;
  if (!task.design_path.empty()) {
    const std::uintmax_t size = std::filesystem::file_size(task.design_path, ignored);
    if (ignored || size > kMostBytes) return;
    text.resize(size);
    std::ifstream file(task.design_path, std::ios::binary);
    file.read(text.data(), static_cast<std::streamsize>(size));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  }
  const std::string_view all = task.design_path.empty() ? task.design_text : text;
  std::unordered_set<std::string_view> seen;
  for (std::size_t at = all.find(kPrefix);
       at != std::string_view::npos && at + kIdSize <= all.size();
       at = all.find(kPrefix, at + kPrefix.size())) {
    const std::string_view id = all.substr(at, kIdSize);
    const bool is_id = id.find_first_not_of("0123456789abcdef", kPrefix.size()) == id.npos;
    if (!is_id || !seen.insert(id).second) continue;
    std::string place = task.assets_folder + "/" + std::string(id);
    if (std::filesystem::exists(place, ignored))
      task.asset_paths[std::string(id)] = std::move(place);
    if (task.asset_paths.size() >= kMostAssets || seen.size() >= kMostLookups) return;
  }
}

std::unique_ptr<Planner> make_planner(const PlanningLimits& limits, std::string program) {
  return std::make_unique<ProcessPlanner>(limits, std::move(program));
}

}  // namespace popcut::daemon
