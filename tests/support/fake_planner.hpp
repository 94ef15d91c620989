// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/digest/digest.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/planning/search/search_words.hpp"
#include "daemon/service/service_options.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::testing {

/// The fake planner's program for sheet `number`: strokes of ten bytes each.
inline EncodedProgram fake_program(const std::string& seed, int number, int strokes) {
  EncodedProgram program;
  program.dialect = Dialect::Gpgl;
  const std::string digest = daemon::sha256_hex(seed + std::to_string(number));
  program.bytes = "setup " + digest.substr(0, 4);
  program.setup = {{0, program.bytes.size()}};
  program.geometry.begin = program.bytes.size();
  for (int i = 0; i < strokes; ++i) {
    const std::uint64_t begin = program.bytes.size();
    program.bytes += "M" + digest.substr(static_cast<std::size_t>(i % 50), 9);
    program.strokes.push_back({begin, program.bytes.size()});
  }
  program.geometry.end = program.bytes.size();
  program.trailer = {program.bytes.size(), program.bytes.size() + 3};
  program.bytes += "END";
  return program;
}

/// "/sheet-01.gpgl"
inline std::string fake_name(int sheet) {
  return (sheet < 10 ? "/sheet-0" : "/sheet-") + std::to_string(sheet) + ".gpgl";
}

/// Reads what the fake planner stored.
inline Result<daemon::StoredProgram> read_fake_program(const std::string& folder, int sheet) {
  const auto bytes = daemon::read_whole(folder + fake_name(sheet), 1u << 24);
  if (!bytes) return tl::unexpected(bytes.error());
  EncodedProgram program;
  program.dialect = Dialect::Gpgl;
  program.bytes = *bytes;
  const std::uint64_t setup = 10;
  program.setup = {{0, setup}};
  program.geometry = {setup, program.bytes.size() - 3};
  for (std::uint64_t at = setup; at + 10 <= program.geometry.end; at += 10)
    program.strokes.push_back({at, at + 10});
  program.trailer = {program.geometry.end, program.bytes.size()};
  const auto index = daemon::read_whole(folder + "/" + daemon::index_name(sheet), 1u << 24);
  if (!index) return tl::unexpected(index.error());
  return daemon::StoredProgram{std::move(program), daemon::sha256_hex(*index)};
}

/// What the fake planner finds for a model: two cards, whose spec has the text of the model.
inline daemon::SearchFront fake_front(const std::string& model) {
  daemon::SearchFront front;
  for (int k = 1; k <= 2; ++k) {
    daemon::FoundCardRecord card;
    card.style = "facets";
    card.settings = "facets of 2 mm, planes 2 mm apart";
    card.error = 0.6 / k;
    card.seconds = 60.0 * k;
    card.seconds_range = {50.0 * k, 70.0 * k};
    card.sheet_mm = {150, 100};
    card.folds = 10 * k;
    card.spec = "{\"card\":" + std::to_string(k) + ",\"model\":\"" + model + "\"}";
    front.cards.push_back(std::move(card));
  }
  front.designed = 16, front.planned = 6, front.verified = 4;
  front.seen_share = 0.5;
  front.mat_mm = {300, 300};
  front.recommended = 1;
  return front;
}

/// Plans any design at once as `sheets` sheets of `strokes` strokes. A design whose file contains
/// "bad" fails; one that contains "slow" waits for `release`. Searches find `fake_front`.
class FakePlanner final : public daemon::Planner {
 public:
  int sheets{2};
  int strokes{5};
  std::array<double, 2> area_mm{200, 280};
  std::atomic<int> started{0}, cancelled{0};

  FakePlanner() : thread_([this] { loop(); }) {}
  ~FakePlanner() override {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }

  std::uint64_t start(daemon::PlanningTask task, Done done) override {
    const std::lock_guard lock(mutex_);
    ++started;
    tasks_.push_back({++last_, std::move(task), std::move(done)});
    wake_.notify_all();
    return last_;
  }
  void cancel(std::uint64_t task) override {
    const std::lock_guard lock(mutex_);
    cancels_.push_back(task);
    ++cancelled;
    wake_.notify_all();
  }
  void release() {
    const std::lock_guard lock(mutex_);
    released_ = true;
    wake_.notify_all();
  }
  /// Drops all tasks, and returns when nobody is being told of one: the service that asked is gone.
  void forget() {
    std::unique_lock lock(mutex_);
    tasks_.clear();
    forgotten_ = last_;
    wake_.notify_all();
    wake_.wait(lock, [&] { return !is_busy_; });
  }
  [[nodiscard]] daemon::PlanningTask last_task() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  struct One {
    std::uint64_t number;
    daemon::PlanningTask task;
    Done done;
  };
  void loop() {
    std::unique_lock lock(mutex_);
    for (;;) {
      is_busy_ = false;
      wake_.notify_all();
      wake_.wait(lock, [&] { return ending_ || !tasks_.empty(); });
      if (ending_) return;
      is_busy_ = true;
      One one = std::move(tasks_.front());
      tasks_.pop_front();
      const auto is_forgotten = [&] { return one.number <= forgotten_; };
      daemon::find_assets(one.task);
      seen_ = one.task;
      const std::string text = daemon::read_whole(one.task.design_path, 1u << 26).value_or("");
      const auto is_cancelled = [&] {
        return std::find(cancels_.begin(), cancels_.end(), one.number) != cancels_.end();
      };
      const bool is_check = one.task.kind == daemon::PlanningTask::Kind::Check;
      if (text.find(is_check ? "held" : "slow") != std::string::npos)
        wake_.wait(lock, [&] { return ending_ || released_ || is_cancelled() || is_forgotten(); });
      if (ending_) return;
      if (is_forgotten()) continue;
      Result<daemon::PlanningOutcome> outcome =
          is_cancelled() ? fail(ErrorKind::Refused, "", "cancelled") : outcome_of(one.task, text);
      lock.unlock();
      one.done(std::move(outcome));
      lock.lock();
    }
  }
  Result<daemon::PlanningOutcome> outcome_of(const daemon::PlanningTask& task,
                                             const std::string& text) {
    if (text.find("bad") != std::string::npos)
      return fail(ErrorKind::Malformed, "/surface", "is not known; one of sphere, saddle");
    daemon::PlanningOutcome outcome;
    outcome.design_kind = "spec";
    if (task.kind == daemon::PlanningTask::Kind::Check) {
      outcome.files.push_back({"preview.svg", "<svg/>"});
      for (const auto& [id, path] : task.asset_paths) outcome.assets.push_back(id);
      return outcome;
    }
    if (task.kind == daemon::PlanningTask::Kind::Search) {
      outcome.files.push_back({planning::kFrontFile, planning::front_text(fake_front(text))});
      for (int k = 1; k <= 2; ++k)
        outcome.files.push_back(
            {planning::thumbnail_file(k), "picture of card " + std::to_string(k)});
      return outcome;
    }
    std::string seed = text + task.machine_json + task.material_json;
    for (const auto& [name, value] : task.options) seed += name + value;
    daemon::Sha256 all;
    for (int number = 1; number <= sheets; ++number) {
      const EncodedProgram program = fake_program(seed, number, strokes);
      all.add(program.bytes);
      outcome.sheets.push_back({.number = number,
                                .paths = strokes,
                                .cut_mm = 100,
                                .fold_mm = 50,
                                .travel_mm = 30,
                                .seconds = 10,
                                .seconds_range = {8, 13},
                                .area_mm = area_mm,
                                .program_sha256 = daemon::sha256_hex(program.bytes)});
      outcome.files.push_back({fake_name(number).substr(1), program.bytes});
      outcome.files.push_back({daemon::index_name(number), std::to_string(strokes) + " strokes\n"});
    }
    outcome.files.push_back({"plan.json", "{}"});
    outcome.sha256 = all.hex();
    return outcome;
  }

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<One> tasks_;
  std::vector<std::uint64_t> cancels_;
  daemon::PlanningTask seen_;
  std::uint64_t last_{0}, forgotten_{0};
  bool released_{false}, ending_{false}, is_busy_{false};
  std::thread thread_;
};

}  // namespace popcut::testing
