// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/devices/cutters.hpp"

namespace popcut::testing {

/// Fake cutters. A sheet waits for the test to advance it with `intend`, `settle` and `finish`. In
/// `automatic` mode each cut runs by itself on its own thread and obeys pause and cancel between
/// strokes. `knife` records what reaches a knife.
class FakeCutters final : public daemon::Cutters {
 public:
  /// One stroke at a knife: only after its intent was committed.
  struct Cut {
    std::string attempt;
    std::int64_t stroke{};
  };

  bool automatic{false};
  bool refuses{false};
  std::atomic<bool> reset_throws{false};

  explicit FakeCutters(std::vector<std::string> ids = {"sim:cameo3"}) {
    for (const std::string& id : ids) plug(id);
  }
  ~FakeCutters() override {
    for (std::thread& thread : threads_) thread.join();
  }

  void plug(const std::string& id, const std::string& state = "idle",
            const std::string& model = "cameo3") {
    daemon::DeviceRecord record;
    record.id = id;
    record.model = model;
    record.title = "Silhouette Cameo 3";
    record.state = state;
    record.simulated = true;
    record.width_mm = 304.8;
    record.length_mm = 3000;
    change([&] { devices_[id] = record; });
  }
  void unplug(const std::string& id) {
    change([&] { devices_.erase(id); });
  }
  /// Unplugged and plugged in again, so quickly that `list` never shows it absent.
  void replug(const std::string& id) {
    change([&] { ++devices_.at(id).plugs; });
  }
  void set_state(const std::string& id, const std::string& state) {
    change([&] { devices_.at(id).state = state; });
  }

  void on_change(std::function<void()> changed) override {
    const std::lock_guard lock(mutex_);
    changed_ = std::move(changed);
  }
  std::vector<daemon::DeviceRecord> list() const override {
    const std::lock_guard lock(mutex_);
    std::vector<daemon::DeviceRecord> all;
    for (const auto& [id, record] : devices_) {
      all.push_back(record);
      if (running_.contains(id)) all.back().state = "busy";
    }
    return all;
  }
  Result<Machine> machine(const std::string& device) const override {
    const std::lock_guard lock(mutex_);
    if (!devices_.contains(device)) return fail(ErrorKind::DeviceGone, device, "is not there");
    return find_machine(devices_.at(device).model);
  }
  Result<void> cut(daemon::CutOrder order, std::shared_ptr<daemon::CutJournal> journal) override {
    const std::lock_guard lock(mutex_);
    if (refuses) return fail(ErrorKind::Refused, order.device, "is cutting already");
    if (!devices_.contains(order.device))
      return fail(ErrorKind::DeviceGone, order.device, "is not there");
    ++cuts_;
    const std::string device = order.device;
    auto run = std::make_shared<Run>();
    run->strokes = static_cast<std::int64_t>(order.program.strokes.size());
    run->next = order.first_stroke;
    run->order = std::move(order);
    run->journal = std::move(journal);
    running_[device] = run;
    if (automatic) threads_.emplace_back([this, device, run] { cut_through(device, run); });
    return {};
  }
  void pause(const std::string& device) override {
    const std::lock_guard lock(mutex_);
    ++pauses_;
    if (running_.contains(device)) running_.at(device)->paused = true;
  }
  void resume(const std::string& device) override {
    const std::lock_guard lock(mutex_);
    ++resumes_;
    if (running_.contains(device)) running_.at(device)->paused = false;
    wake_.notify_all();
  }
  void cancel(const std::string& device) override {
    const std::lock_guard lock(mutex_);
    ++cancels_;
    if (running_.contains(device)) running_.at(device)->cancelled = true;
    wake_.notify_all();
  }
  Result<void> reset(const std::string&) override {
    if (reset_throws) throw std::bad_alloc();
    return {};
  }
  void stop_all(double) override {
    for (const std::string& device : busy()) {
      cancel(device);
      if (!automatic) finish(device, {.cancelled = true});
    }
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, std::chrono::seconds(60), [&] { return running_.empty(); });
  }
  bool alive() const override { return true; }

  // The test moves a cut. Not from the service's thread, except where it waits for nothing.

  /// The intent of strokes up to `last`; if it is committed they go to the knife.
  Result<void> intend(const std::string& device, std::int64_t last) {
    const auto run = find(device);
    Result<void> done = run->journal->intend(last);
    if (!done) return done;
    const std::lock_guard lock(mutex_);
    for (; run->next <= last; ++run->next) knife_.push_back({run->order.attempt, run->next});
    return done;
  }
  void settle(const std::string& device, std::int64_t certain, std::int64_t taken) {
    (void)find(device)->journal->settle(certain, taken, static_cast<std::uint64_t>(taken + 1) * 10);
  }
  void progress(const std::string& device, const SessionProgress& progress) {
    find(device)->journal->progress(progress);
  }
  struct Ending {
    std::optional<Error> error{};
    bool cancelled{false};
    bool confirmed{true};
    std::int64_t certain{-1}, doubt{-1};  ///< last certain stroke, last one in doubt
  };
  /// Ends the cut. Without an error and not cancelled: all strokes certain, unless said otherwise.
  void finish(const std::string& device, const Ending& ending) {
    const auto run = find(device);
    SessionEnd end;
    end.error = ending.error;
    end.cancelled = ending.cancelled;
    end.confirmed = ending.confirmed && !ending.error && !ending.cancelled;
    end.seconds = 7;
    for (std::int64_t i = 0; i < run->strokes; ++i)
      end.fates.push_back(i < run->order.first_stroke ? StrokeFate::NotSent
                          : i <= ending.certain       ? StrokeFate::Certain
                          : i <= ending.doubt         ? StrokeFate::InDoubt
                                                      : StrokeFate::NotSent);
    {
      const std::lock_guard lock(mutex_);
      running_.erase(device);
    }
    run->journal->ended(end);
    tell();
    const std::lock_guard lock(mutex_);
    wake_.notify_all();
  }
  /// Cuts all that is left and ends well.
  void complete(const std::string& device) {
    const std::int64_t last = find(device)->strokes - 1;
    (void)intend(device, last);
    settle(device, last, last);
    finish(device, {.certain = last});
  }
  /// The process dies: whoever wrote the journal is gone.
  void forget() {
    const std::lock_guard lock(mutex_);
    running_.clear();
  }

  [[nodiscard]] std::vector<std::string> busy() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> all;
    for (const auto& [device, run] : running_) all.push_back(device);
    return all;
  }
  [[nodiscard]] std::vector<Cut> knife() const { return locked(knife_); }
  [[nodiscard]] int cuts() const { return locked(cuts_); }
  [[nodiscard]] int pauses() const { return locked(pauses_); }
  [[nodiscard]] int resumes() const { return locked(resumes_); }
  [[nodiscard]] int cancels() const { return locked(cancels_); }
  [[nodiscard]] std::int64_t first_stroke(const std::string& device) const {
    return find(device)->order.first_stroke;
  }

 private:
  struct Run {
    daemon::CutOrder order;
    std::shared_ptr<daemon::CutJournal> journal;
    std::int64_t strokes{};
    std::int64_t next{0};
    bool paused{false}, cancelled{false};
  };

  void cut_through(const std::string& device, const std::shared_ptr<Run>& run) {
    run->next = run->order.first_stroke;
    std::int64_t certain = run->next - 1;
    while (run->next < run->strokes) {
      {
        std::unique_lock lock(mutex_);
        if (run->paused && !run->cancelled) {
          lock.unlock();
          run->journal->progress({.phase = SessionPhase::Held});
          lock.lock();
          wake_.wait(lock, [&] { return !run->paused || run->cancelled; });
        }
        if (run->cancelled) break;
      }
      const std::int64_t stroke = run->next;
      if (const auto noted = intend(device, stroke); !noted)
        return finish(device, {.error = noted.error(), .certain = certain});
      certain = stroke;
      settle(device, certain, certain);
      std::this_thread::yield();
    }
    const bool cancelled = run->next < run->strokes;
    finish(device, {.cancelled = cancelled, .certain = certain});
  }
  [[nodiscard]] std::shared_ptr<Run> find(const std::string& device) const {
    const std::lock_guard lock(mutex_);
    return running_.at(device);
  }
  template <typename T>
  [[nodiscard]] T locked(const T& value) const {
    const std::lock_guard lock(mutex_);
    return value;
  }
  template <typename Change>
  void change(const Change& work) {
    {
      const std::lock_guard lock(mutex_);
      work();
    }
    tell();
  }
  void tell() {
    std::function<void()> changed;
    {
      const std::lock_guard lock(mutex_);
      changed = changed_;
    }
    if (changed) changed();
  }

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, daemon::DeviceRecord> devices_;
  std::map<std::string, std::shared_ptr<Run>> running_;
  std::function<void()> changed_;
  std::vector<Cut> knife_;
  int cuts_{0}, pauses_{0}, resumes_{0}, cancels_{0};
  std::vector<std::thread> threads_;
};

}  // namespace popcut::testing
