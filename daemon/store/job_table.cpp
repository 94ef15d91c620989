// SPDX-License-Identifier: MIT
#include "daemon/store/job_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "daemon/store/ulid.hpp"

namespace popcut::daemon {
namespace {

#define POPCUT_JOB_COLUMNS                                                                     \
  "state, id, rev, reason, asked, name, note, owner, operator, wish, device, design, plan, "   \
  "material, priority, position, copies, held, sheets_total, sheet, blank, segment, "          \
  "first_stroke, paths_certain, paths_sent, paths_total, done_paths, done_mm, low_s, high_s, " \
  "created, started, finished, outcome, tags, attention, attention_text, attention_since"

constexpr std::string_view kUpdate =
    "UPDATE job SET rev=?, state=?, reason=?, asked=?, name=?, note=?, operator=?, wish=?, "
    "device=?, priority=?, position=?, held=?, sheets_total=?, sheet=?, blank=?, segment=?, "
    "first_stroke=?, paths_certain=?, paths_sent=?, paths_total=?, done_paths=?, done_mm=?, "
    "low_s=?, high_s=?, started=?, finished=?, outcome=?, attention=?, attention_text=?, "
    "attention_since=? WHERE id=? AND rev=?";
constexpr std::string_view kFind =
    "SELECT " POPCUT_JOB_COLUMNS " FROM job WHERE id=? AND deleted=0";
constexpr std::string_view kQueue =
    "SELECT " POPCUT_JOB_COLUMNS
    " FROM job WHERE state NOT IN ('done', 'failed', 'cancelled') AND deleted=0 AND "
    "(?1='' OR device=?1 OR (device='' AND wish IN ('', ?1))) AND "
    "priority<=?3 AND (priority<?3 OR (position, id)>(?4, ?5)) "
    "ORDER BY priority DESC, position, id LIMIT ?2";
constexpr std::string_view kWaiting =
    "SELECT " POPCUT_JOB_COLUMNS " FROM job WHERE plan=? AND state=? LIMIT ?";
constexpr std::string_view kOnDevice =
    "SELECT " POPCUT_JOB_COLUMNS
    " FROM job WHERE device=? AND state IN ('armed', 'cutting', 'paused')";

JobState state_of(const std::string& word) {
  if (const auto state = job_state_from(word)) return *state;
  throw StoreFault(FaultKind::Corrupt, fmt::format("a job's state is {:?}", word));
}

// The members in the order of the columns, without the state.
template <typename Row>
auto job_values(Row& row) {
  return std::tie(row.id, row.rev, row.reason, row.asked, row.name, row.note, row.owner,
                  row.operator_name, row.requested_device, row.device, row.design, row.plan,
                  row.material, row.priority, row.position, row.copies, row.held, row.sheets_total,
                  row.sheet, row.blank, row.segment, row.first_stroke, row.paths_certain,
                  row.paths_sent, row.paths_total, row.done_paths, row.done_mm, row.low_s,
                  row.high_s, row.created, row.started, row.finished, row.outcome, row.tags,
                  row.attention, row.attention_text, row.attention_since);
}

JobRow row_of(const Rows& rows) {
  JobRow row;
  row.state = state_of(rows.text(0));
  rows.read(1, job_values(row));
  return row;
}

}  // namespace

void JobTable::insert(const JobRow& row) {
  db_.insert("INSERT INTO job(" POPCUT_JOB_COLUMNS ")",
             std::tuple_cat(std::tuple(name_of(row.state)), job_values(row)));
}

void JobTable::update(JobRow& row) {
  const int changed =
      db_.run(kUpdate, row.rev + 1, name_of(row.state), row.reason, row.asked, row.name, row.note,
              row.operator_name, row.requested_device, row.device, row.priority, row.position,
              row.held, row.sheets_total, row.sheet, row.blank, row.segment, row.first_stroke,
              row.paths_certain, row.paths_sent, row.paths_total, row.done_paths, row.done_mm,
              row.low_s, row.high_s, row.started, row.finished, row.outcome, row.attention,
              row.attention_text, row.attention_since, row.id, row.rev);
  if (changed != 1)
    throw StoreFault(FaultKind::Other, "job " + row.id + " has changed in the meantime");
  ++row.rev;
}

std::optional<JobRow> JobTable::find(std::string_view id) {
  return first_of(db_.rows(kFind, id), row_of);
}

std::vector<JobRow> JobTable::list(const JobFilter& filter, const std::string& after, int limit) {
  // Each state is a run of an index in the order of ids; a page is the first of all these runs.
  std::string sql = "SELECT " POPCUT_JOB_COLUMNS " FROM job WHERE id>?1 AND deleted=0";
  if (!filter.owner.empty()) sql += " AND owner=?3";
  if (!filter.device.empty()) sql += " AND device=?4";
  if (!filter.states.empty()) sql += " AND state=?5";
  sql += " ORDER BY id LIMIT ?2";
  std::string low = after;
  // One below the first id of that time, so that it is itself found.
  if (filter.since) low = std::max(low, first_ulid_of(*filter.since - 1));
  std::vector<std::string_view> states{""};
  if (!filter.states.empty()) {
    states.clear();
    for (const JobState state : filter.states) states.push_back(name_of(state));
  }
  std::sort(states.begin(), states.end());
  states.erase(std::unique(states.begin(), states.end()), states.end());
  std::vector<JobRow> all;
  for (const std::string_view state : states) {
    const std::array<Bound, 5> values{low, limit, filter.owner, filter.device, state};
    const std::size_t used = !filter.states.empty()   ? 5
                             : !filter.device.empty() ? 4
                             : !filter.owner.empty()  ? 3
                                                      : 2;
    std::vector<JobRow> run = all_of(db_.rows_list(sql, std::span(values).first(used)), row_of);
    std::move(run.begin(), run.end(), std::back_inserter(all));
  }
  std::sort(all.begin(), all.end(), [](const JobRow& a, const JobRow& b) { return a.id < b.id; });
  if (all.size() > static_cast<std::size_t>(limit)) all.resize(static_cast<std::size_t>(limit));
  return all;
}

std::string text_of(const QueuePlace& place) {
  return fmt::format("{}.{}.{}", place.priority, place.position, place.id);
}

std::optional<QueuePlace> queue_place_from(const std::string& text) {
  QueuePlace place;
  const char* const end = text.data() + text.size();
  const auto priority = std::from_chars(text.data(), end, place.priority);
  if (priority.ec != std::errc() || priority.ptr == end || *priority.ptr != '.')
    return std::nullopt;
  const auto position = std::from_chars(priority.ptr + 1, end, place.position);
  if (position.ec != std::errc() || position.ptr == end || *position.ptr != '.')
    return std::nullopt;
  place.id.assign(position.ptr + 1, end);
  if (!is_ulid(place.id) || text_of(place) != text) return std::nullopt;
  return place;
}

std::vector<JobRow> JobTable::queue(const std::string& device,
                                    const std::optional<QueuePlace>& after, int limit) {
  constexpr int kAboveAll = 1000;
  const QueuePlace from = after.value_or(QueuePlace{kAboveAll, 0, {}});
  return all_of(db_.rows(kQueue, device, limit, from.priority, from.position, from.id), row_of);
}

std::vector<JobRow> JobTable::waiting_for(const std::string& plan, JobState state, int limit) {
  return all_of(db_.rows(kWaiting, plan, name_of(state), limit), row_of);
}

std::optional<JobRow> JobTable::on_device(const std::string& device) {
  return first_of(db_.rows(kOnDevice, device), row_of);
}

std::int64_t JobTable::last_position() { return db_.number("SELECT max(position) FROM job"); }

std::int64_t JobTable::count(JobState state) {
  return db_.number("SELECT jobs FROM tally WHERE state=?", name_of(state));
}

std::int64_t JobTable::open_count() {
  return db_.number(
      "SELECT sum(jobs) FROM tally WHERE state NOT IN ('done', 'failed', 'cancelled')");
}

}  // namespace popcut::daemon
