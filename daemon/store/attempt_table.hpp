// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/jobs/resume.hpp"
#include "daemon/model/model.hpp"
#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// Which popcutd of a fleet writes, and in which of its runs. Without a fleet: no name, epoch 0.
struct NodeMark {
  std::string name{};
  std::string identity{};  ///< of its machine and state folder: a copy of them is another one
  std::int64_t epoch{0};
  std::int64_t fence{0};  ///< the greatest that it has seen; a START gets a greater one
  /// With what the names of its runs begin.
  [[nodiscard]] std::string mark() const { return identity.substr(0, 16); }
};

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
  std::string node{};    ///< in a fleet, whose cutter it is
  std::int64_t epoch{};  ///< of that node
  std::optional<std::int64_t> fence{};
  std::string identity{};  ///< of the state folder whose journal knows the most of it
};

/// What of an attempt is written down while it runs: strokes `first .. certain` are cut, those up
/// to `taken` have a byte with the device, those up to `intended` are about to be sent.
struct AttemptMarks {
  std::int64_t first{}, certain{-1}, taken{-1}, intended{-1};
};

/// The statements over `attempt`, `chunk`, `sheet` and `arm`. All throw StoreFault. In a fleet,
/// `attempt`, `chunk` and `arm` are written by functions of the database (daemon/fleet/schema.sql),
/// which check the node, its epoch and its lease: Refused says what is wrong.
class AttemptTable {
 public:
  AttemptTable(Database& database, const NodeMark& node) : db_(database), node_(node) {}

  /// The START of a blank that is armed. Its fence: greater than all before; in a fleet only.
  ///
  /// @throws StoreFault  Constraint: that blank was started before
  std::int64_t start(const AttemptRow& row);
  /// An attempt that the database lost: it has ended, all up to `doubt_upto` in doubt.
  void bring_back(const AttemptRow& row, TimeMs now, std::int64_t doubt_upto,
                  const std::string& remark, const std::string& end_kind = "crash");
  /// What is known while it runs, in at most three chunks, and how many bytes the device took.
  void mark(const std::string& attempt, const AttemptMarks& marks, std::uint64_t bytes_taken);
  /// The final fates; they replace what was marked.
  void finish(const std::string& attempt, TimeMs ended, const std::string& end_kind,
              const std::string& last_status, std::uint64_t bytes_taken,
              const std::vector<FateRun>& fates);
  /// As if it had never been started: not a byte was sent.
  void never_started(const std::string& attempt, TimeMs now);
  /// At a restart: strokes that are not certain are in doubt from `first` to `doubt_upto`. `remark`
  /// is its last status.
  ///
  /// @param end_kind  "crash"; "lost": its node does not answer; "superseded": it came back too
  /// late
  void crash(const AttemptRow& attempt, TimeMs now, std::int64_t doubt_upto,
             const std::string& remark, const std::string& end_kind = "crash");
  /// One that was lost goes on: its node is back.
  void go_on(const std::string& attempt);
  /// The last stroke of which any chunk says something; -1: none.
  [[nodiscard]] std::int64_t last_recorded(const std::string& attempt);

  [[nodiscard]] std::vector<AttemptRow> of_sheet(const std::string& job, int sheet);
  [[nodiscard]] std::optional<AttemptRow> find(const std::string& attempt);
  /// The greatest blank and segment of a sheet that was started; nothing if none was.
  struct Begun {
    int blank{}, segment{};
    std::int64_t first_stroke{};
  };
  [[nodiscard]] std::optional<Begun> last_begun(const std::string& job, int sheet);
  /// Those of this node that have not ended.
  [[nodiscard]] std::vector<AttemptRow> open();
  /// Those of a run of a node, or of its runs before, that have not ended.
  [[nodiscard]] std::vector<AttemptRow> open_of(const std::string& node, std::int64_t epoch);
  [[nodiscard]] bool knows(const std::string& attempt);
  /// In a fleet: those of `ids` that the database knows and nobody took for lost, each with the
  /// time of its creation.
  [[nodiscard]] std::vector<std::pair<std::string, TimeMs>> known_among(
      std::span<const std::string> ids);
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
    std::string node{};
    std::int64_t epoch{};
  };
  void arm(const ArmRow& row);
  void disarm(const std::string& job);
  /// All that this node armed.
  void disarm_all();
  /// The jobs that a run of a node armed, or its runs before.
  [[nodiscard]] std::vector<std::string> armed_by(const std::string& node, std::int64_t epoch);
  [[nodiscard]] std::optional<ArmRow> armed(const std::string& job);

 private:
  void put_chunk(const std::string& attempt, int seq, PathRange paths, std::string_view state);
  void put_all(const AttemptRow& row);
  Database& db_;
  const NodeMark& node_;
};

}  // namespace popcut::daemon
