// SPDX-License-Identifier: MIT
#include "daemon/store/attempt_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/store/columns.hpp"

namespace popcut::daemon {
template <typename See>
void list_fields(const AttemptRow*, See&& see) {
  see("id", &AttemptRow::id);
  see("job", &AttemptRow::job);
  see("k", &AttemptRow::sheet);
  see("blank", &AttemptRow::blank);
  see("segment", &AttemptRow::segment);
  see("first_stroke", &AttemptRow::first_stroke);
  see("strokes", &AttemptRow::strokes);
  see("device", &AttemptRow::device);
  see("device_session", &AttemptRow::device_session);
  see("operator", &AttemptRow::operator_name);
  see("plan_sha256", &AttemptRow::plan_sha256);
  see("invocation", &AttemptRow::invocation);
  see("created", &AttemptRow::created);
  see("started_at", &AttemptRow::started);
  see("ended", &AttemptRow::ended);
  see("end_kind", &AttemptRow::end_kind);
  see("bytes_taken", &AttemptRow::bytes_taken);
  see("last_status", &AttemptRow::last_status);
  see("node", &AttemptRow::node);
  see("epoch", &AttemptRow::epoch);
  see("fence", &AttemptRow::fence);
  see("identity", &AttemptRow::identity);
}

template <typename See>
void list_fields(const AttemptTable::ArmRow*, See&& see) {
  using ArmRow = AttemptTable::ArmRow;
  see("job", &ArmRow::job);
  see("sheet", &ArmRow::sheet);
  see("blank", &ArmRow::blank);
  see("device", &ArmRow::device);
  see("plan_sha256", &ArmRow::plan_sha256);
  see("operator", &ArmRow::operator_name);
  see("armed", &ArmRow::armed);
  see("invocation", &ArmRow::invocation);
  see("node", &ArmRow::node);
  see("epoch", &ArmRow::epoch);
}

template <typename See>
void list_fields(const AttemptTable::SheetRow*, See&& see) {
  using SheetRow = AttemptTable::SheetRow;
  see("k", &SheetRow::sheet);
  see("blank", &SheetRow::blank);
  see("segment", &SheetRow::segment);
  see("state", &SheetRow::state);
  see("started", &SheetRow::started);
  see("finished", &SheetRow::finished);
}

namespace {

template <typename Row>
std::string select(std::string_view table, std::string_view where) {
  return fmt::format("SELECT {} FROM {} WHERE {}", column_names<Row>(), table, where);
}

}  // namespace

void AttemptTable::put_all(const AttemptRow& row) {
  static const std::string into = "attempt(" + column_names<AttemptRow>() + ")";
  ColumnValues values;
  put_row(values, row);
  db_.insert_list(into, values.all());
}

std::int64_t AttemptTable::start(const AttemptRow& row) {
  if (db_.is_shared())
    return db_.number("SELECT knife_start(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                      node_.name, node_.epoch, row.id, row.job, row.sheet, row.blank, row.segment,
                      row.first_stroke, row.strokes, row.device, row.device_session,
                      row.operator_name, row.plan_sha256, row.invocation, row.created, node_.fence);
  put_all(row);
  disarm(row.job);
  return 0;
}

void AttemptTable::bring_back(const AttemptRow& row, TimeMs now, std::int64_t doubt_upto,
                              const std::string& remark, const std::string& end_kind) {
  if (db_.is_shared())
    db_.run("SELECT knife_bring_back(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            node_.name, node_.epoch, row.id, row.job, row.sheet, row.blank, row.segment,
            row.first_stroke, row.strokes, row.device, row.device_session, row.operator_name,
            row.plan_sha256, row.invocation, row.created, row.started, row.fence, row.identity);
  else
    put_all(row);
  crash(row, now, doubt_upto, remark, end_kind);
}

void AttemptTable::put_chunk(const std::string& attempt, int seq, PathRange paths,
                             std::string_view state) {
  if (paths.last < paths.first) return;
  db_.put("chunk(attempt, seq, path_from, path_to, state)", "attempt, seq", attempt, seq,
          paths.first, paths.last, state);
}

void AttemptTable::mark(const std::string& attempt, const AttemptMarks& marks,
                        std::uint64_t bytes_taken) {
  if (db_.is_shared()) {
    db_.run("SELECT knife_mark(?, ?, ?, ?, ?, ?, ?, ?)", node_.name, node_.epoch, attempt,
            marks.first, marks.certain, marks.taken, marks.intended, bytes_taken);
    return;
  }
  const std::int64_t taken = std::max(marks.taken, marks.certain);
  db_.run("DELETE FROM chunk WHERE attempt=?", attempt);
  put_chunk(attempt, 0, {marks.first, marks.certain}, "certain");
  put_chunk(attempt, 1, {std::max(marks.first, marks.certain + 1), taken}, "sent");
  put_chunk(attempt, 2, {std::max(marks.first, taken + 1), marks.intended}, "intent");
  db_.run("UPDATE attempt SET bytes_taken=?1 WHERE id=?2 AND bytes_taken<?1", bytes_taken, attempt);
}

void AttemptTable::finish(const std::string& attempt, TimeMs ended, const std::string& end_kind,
                          const std::string& last_status, std::uint64_t bytes_taken,
                          const std::vector<FateRun>& fates) {
  if (db_.is_shared()) {
    std::string from, to, states;
    for (const FateRun& run : fates) {
      if (run.fate == PathFate::NotSent || run.paths.last < run.paths.first) continue;
      const char* const comma = from.empty() ? "" : ",";
      from += comma + std::to_string(run.paths.first);
      to += comma + std::to_string(run.paths.last);
      states += std::string(comma) + (run.fate == PathFate::Certain ? "certain" : "doubt");
    }
    db_.later("SELECT knife_end(?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", node_.name, node_.epoch, attempt,
              ended, end_kind, last_status, bytes_taken, "{" + from + "}", "{" + to + "}",
              "{" + states + "}");
    return;
  }
  db_.run("UPDATE attempt SET ended=?, end_kind=?, last_status=? WHERE id=?", ended, end_kind,
          last_status, attempt);
  db_.run("UPDATE attempt SET bytes_taken=?1 WHERE id=?2 AND bytes_taken<?1", bytes_taken, attempt);
  db_.run("DELETE FROM chunk WHERE attempt=?", attempt);
  int seq = 0;
  for (const FateRun& run : fates)
    if (run.fate != PathFate::NotSent)
      put_chunk(attempt, seq++, run.paths, run.fate == PathFate::Certain ? "certain" : "doubt");
}

void AttemptTable::never_started(const std::string& attempt, TimeMs now) {
  if (db_.is_shared()) {
    db_.run("SELECT knife_never(?, ?, ?, ?)", node_.name, node_.epoch, attempt, now);
    return;
  }
  db_.run("UPDATE attempt SET started_at=NULL, ended=?, end_kind='refused' WHERE id=?", now,
          attempt);
  db_.run("DELETE FROM chunk WHERE attempt=?", attempt);
}

void AttemptTable::crash(const AttemptRow& attempt, TimeMs now, std::int64_t doubt_upto,
                         const std::string& remark, const std::string& end_kind) {
  if (db_.is_shared()) {
    db_.run("SELECT knife_crash(?, ?, ?, ?, ?, ?, ?)", node_.name, node_.epoch, attempt.id, now,
            end_kind, remark, doubt_upto);
    return;
  }
  db_.run("UPDATE attempt SET ended=?, end_kind=?, last_status=? WHERE id=?", now, end_kind, remark,
          attempt.id);
  const std::int64_t certain =
      db_.number("SELECT coalesce(max(path_to), -1) FROM chunk WHERE attempt=? AND state='certain'",
                 attempt.id);
  db_.run("DELETE FROM chunk WHERE attempt=? AND state!='certain'", attempt.id);
  put_chunk(attempt.id, 1, {std::max(attempt.first_stroke, certain + 1), doubt_upto}, "doubt");
}

void AttemptTable::go_on(const std::string& attempt) {
  db_.run("SELECT knife_again(?, ?, ?)", node_.name, node_.epoch, attempt);
}

std::int64_t AttemptTable::last_recorded(const std::string& attempt) {
  return db_.number("SELECT coalesce(max(path_to), -1) FROM chunk WHERE attempt=?", attempt);
}

bool AttemptTable::knows(const std::string& attempt) {
  return db_.number("SELECT EXISTS(SELECT 1 FROM attempt WHERE id=?)", attempt) != 0;
}

std::vector<std::pair<std::string, TimeMs>> AttemptTable::known_among(
    std::span<const std::string> ids) {
  constexpr std::size_t kAtOnce = 1000;
  std::vector<std::pair<std::string, TimeMs>> all;
  for (; !ids.empty(); ids = ids.subspan(std::min(kAtOnce, ids.size()))) {
    std::string list;
    for (const std::string& id : ids.first(std::min(kAtOnce, ids.size())))
      list += (list.empty() ? "" : ",") + id;
    Rows rows = db_.rows(
        "SELECT id, created FROM attempt WHERE id = ANY(string_to_array(?, ',')) AND "
        "end_kind<>'lost'",
        list);
    while (rows.next()) all.emplace_back(rows.text(0), rows.integer(1));
  }
  return all;
}

std::vector<AttemptRow> AttemptTable::of_sheet(const std::string& job, int sheet) {
  static const std::string sql = select<AttemptRow>("attempt", "job=? AND k=? ORDER BY id");
  return all_of(db_.rows(sql, job, sheet), read_row<AttemptRow>);
}

std::vector<AttemptRow> AttemptTable::open_of(const std::string& node, std::int64_t epoch) {
  static const std::string sql =
      select<AttemptRow>("attempt", "ended IS NULL AND node=? AND epoch<=? ORDER BY id");
  return all_of(db_.rows(sql, node, epoch), read_row<AttemptRow>);
}

std::optional<AttemptTable::Begun> AttemptTable::last_begun(const std::string& job, int sheet) {
  return first_of(
      db_.rows("SELECT blank, segment, first_stroke FROM attempt WHERE job=? AND k=? AND "
               "started_at IS NOT NULL ORDER BY blank DESC, segment DESC LIMIT 1",
               job, sheet),
      [](const Rows& rows) {
        return Begun{rows.small(0), rows.small(1), rows.integer(2)};
      });
}

std::optional<AttemptRow> AttemptTable::find(const std::string& attempt) {
  static const std::string sql = select<AttemptRow>("attempt", "id=?");
  return first_of(db_.rows(sql, attempt), read_row<AttemptRow>);
}

std::vector<AttemptRow> AttemptTable::open() {
  static const std::string sql =
      select<AttemptRow>("attempt", "ended IS NULL AND node=? ORDER BY id");
  return all_of(db_.rows(sql, node_.name), read_row<AttemptRow>);
}

std::vector<FateRun> AttemptTable::fates(const std::string& attempt) {
  return all_of(
      db_.rows("SELECT path_from, path_to, state FROM chunk WHERE attempt=? ORDER BY path_from",
               attempt),
      [](const Rows& rows) {
        return FateRun{{rows.integer(0), rows.integer(1)},
                       rows.text(2) == "certain" ? PathFate::Certain : PathFate::InDoubt};
      });
}

void AttemptTable::put_sheet(const std::string& job, int sheet, int blank, int segment,
                             std::string_view state, std::optional<TimeMs> started,
                             std::optional<TimeMs> finished) {
  db_.later(
      "INSERT INTO sheet(job, k, blank, segment, state, started, finished) "
      "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7) ON CONFLICT(job, k) DO UPDATE SET blank=?3, "
      "segment=?4, state=?5, started=coalesce(?6, sheet.started), finished=?7",
      job, sheet, blank, segment, state, started, finished);
}

std::vector<AttemptTable::SheetRow> AttemptTable::sheets(const std::string& job, int first,
                                                         int last) {
  static const std::string sql =
      select<SheetRow>("sheet", "job=? AND k BETWEEN ? AND ? ORDER BY k");
  return all_of(db_.rows(sql, job, first, last), read_row<SheetRow>);
}

std::optional<AttemptTable::SheetRow> AttemptTable::sheet(const std::string& job, int sheet) {
  static const std::string sql = select<SheetRow>("sheet", "job=? AND k=?");
  return first_of(db_.rows(sql, job, sheet), read_row<SheetRow>);
}

void AttemptTable::arm(const ArmRow& row) {
  if (db_.is_shared()) {
    db_.later("SELECT knife_arm(?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", node_.name, node_.epoch, row.job,
              row.sheet, row.blank, row.device, row.plan_sha256, row.operator_name, row.armed,
              row.invocation);
    return;
  }
  static const std::string into = "arm(" + column_names<ArmRow>() + ")";
  ArmRow own = row;
  own.node = node_.name;
  own.epoch = node_.epoch;
  ColumnValues values;
  put_row(values, own);
  db_.put_list(into, "job", values.all());
}

void AttemptTable::disarm(const std::string& job) {
  db_.later(db_.is_shared() ? "SELECT knife_disarm(?)" : "DELETE FROM arm WHERE job=?", job);
}

void AttemptTable::disarm_all() {
  for (const std::string& job :
       all_of(db_.rows("SELECT job FROM arm WHERE node=?", node_.name), first_text))
    disarm(job);
}

std::vector<std::string> AttemptTable::armed_by(const std::string& node, std::int64_t epoch) {
  return all_of(db_.rows("SELECT job FROM arm WHERE node=? AND epoch<=?", node, epoch), first_text);
}

std::optional<AttemptTable::ArmRow> AttemptTable::armed(const std::string& job) {
  static const std::string sql = select<ArmRow>("arm", "job=?");
  return first_of(db_.rows(sql, job), read_row<ArmRow>);
}

}  // namespace popcut::daemon
