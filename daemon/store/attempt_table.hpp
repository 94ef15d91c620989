// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/jobs/resume.hpp"
#include "daemon/model/model.hpp"
#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// A row of the table of attempts: one START of one blank.
struct AttemptRow {
  std::string id, job;
  int sheet{}, blank{1}, segment{1};
  std::int64_t first_stroke{}, strokes{};
  std::string device, device_session, operator_name, plan_sha256, invocation;
  TimeMs created{};
  std::optional<TimeMs> started{}, ended{};
  std::string end_kind{};
  std::uint64_t bytes_taken{};
  std::string last_status{};
};

/// What of an attempt is written down while it runs: strokes `first .. certain` are cut, those up
/// to `taken` have a byte with the device, those up to `intended` are about to be sent.
struct AttemptMarks {
  std::int64_t first{}, certain{-1}, taken{-1}, intended{-1};
};

/// The statements over `attempt`, `chunk`, `sheet` and `arm`. All throw StoreFault.
class AttemptTable {
 public:
  explicit AttemptTable(Database& database) : db_(database) {}

  /// @throws StoreFault  Constraint: that blank was started before
  void insert(const AttemptRow& row);
  /// What is known while it runs, in at most three chunks.
  void mark(const std::string& attempt, const AttemptMarks& marks);
  void add_bytes(const std::string& attempt, std::uint64_t bytes_taken);
  /// The final fates; they replace what was marked.
  void finish(const std::string& attempt, TimeMs ended, const std::string& end_kind,
              const std::string& last_status, const std::vector<FateRun>& fates);
  /// As if it had never been started: not a byte was sent.
  void never_started(const std::string& attempt, TimeMs now);
  /// At a restart: strokes that are not certain are in doubt from `first` to `doubt_upto`. `remark`
  /// is its last status.
  void crash(const AttemptRow& attempt, TimeMs now, std::int64_t doubt_upto,
             const std::string& remark);
  /// The last stroke of which any chunk says something; -1: none.
  [[nodiscard]] std::int64_t last_recorded(const std::string& attempt);

  [[nodiscard]] std::vector<AttemptRow> of_sheet(const std::string& job, int sheet);
  [[nodiscard]] std::vector<AttemptRow> open();
  [[nodiscard]] bool knows(const std::string& attempt);
  [[nodiscard]] std::vector<FateRun> fates(const std::string& attempt);

  void put_sheet(const std::string& job, int sheet, int blank, int segment, std::string_view state,
                 std::optional<TimeMs> started, std::optional<TimeMs> finished);
  struct SheetRow {
    int sheet{}, blank{1}, segment{1};
    std::string state;
    std::optional<TimeMs> started{}, finished{};
  };
  [[nodiscard]] std::vector<SheetRow> sheets(const std::string& job, int first, int last);
  [[nodiscard]] std::optional<SheetRow> sheet(const std::string& job, int sheet);

  struct ArmRow {
    std::string job;
    int sheet{}, blank{};
    std::string device, plan_sha256, operator_name;
    TimeMs armed{};
    std::string invocation;
  };
  void arm(const ArmRow& row);
  void disarm(const std::string& job);
  [[nodiscard]] std::optional<ArmRow> armed(const std::string& job);

 private:
  void put_chunk(const std::string& attempt, int seq, PathRange paths, std::string_view state);
  Database& db_;
};

}  // namespace popcut::daemon
