// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "daemon/previews/previewer.hpp"

namespace popcut::testing {

/// A previewer that has every answer at once, or keeps tasks until a test lets them go: what a
/// service is tested with.
class FakePreviewer final : public daemon::Previewer {
 public:
  std::string blob{"{}"};  ///< what every file holds; set it before the first task
  std::atomic<bool> holds{false};
  std::atomic<int> called_off{0};  ///< tasks that were, while they were held

  std::uint64_t start(daemon::PreviewTask task, Done done) override {
    std::unique_lock lock(mutex_);
    const std::uint64_t number = ++last_;
    seen_ = std::move(task);
    if (const auto problem = std::exchange(problem_, std::nullopt)) {
      lock.unlock();
      done(tl::unexpected<daemon::Problem>(*problem));
      return number;
    }
    if (holds) {
      held_.emplace(number, std::move(done));
      return number;
    }
    const daemon::PlanningOutcome made = outcome();
    lock.unlock();
    done(made);
    return number;
  }
  void cancel(std::uint64_t task) override {
    std::unique_lock lock(mutex_);
    const auto found = held_.extract(task);
    lock.unlock();
    if (found.empty()) return;
    ++called_off;
    found.mapped()(daemon::refuse(daemon::ProblemKind::Unavailable, "it was called off"));
  }
  void stop() override {
    for (std::uint64_t task = 1; task <= last_; ++task) cancel(task);
  }

  [[nodiscard]] std::size_t held() const {
    const std::lock_guard lock(mutex_);
    return held_.size();
  }
  /// Answers what is held.
  void release() {
    std::unique_lock lock(mutex_);
    const auto all = std::exchange(held_, {});
    const daemon::PlanningOutcome made = outcome();
    lock.unlock();
    for (const auto& [number, done] : all) done(made);
  }
  /// The next task fails with it.
  void fail_next(daemon::Problem problem) {
    const std::lock_guard lock(mutex_);
    problem_ = std::move(problem);
  }
  [[nodiscard]] daemon::PreviewTask last_task() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  [[nodiscard]] daemon::PlanningOutcome outcome() const {
    daemon::PlanningOutcome made;
    for (const char* name :
         {"lattice", "spec.json", "deployed.svg", "pattern.svg", "artwork.pdf", "make.json"})
      made.files.push_back({name, blob});
    if (const auto file = seen_.task.options.find("file"); file != seen_.task.options.end())
      made.files.push_back({file->second, blob});
    return made;
  }

  mutable std::mutex mutex_;
  std::map<std::uint64_t, Done> held_;
  std::optional<daemon::Problem> problem_;
  daemon::PreviewTask seen_;
  std::atomic<std::uint64_t> last_{0};
};

}  // namespace popcut::testing
