// SPDX-License-Identifier: MIT
#include "daemon/store/job_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "daemon/store/columns.hpp"
#include "daemon/store/ulid.hpp"

namespace popcut::daemon {
namespace {

// Rows that one request looks at, whether or not they are in its answer.
constexpr int kMostLooked = 2000;

// "SELECT id, rev, ... FROM job WHERE " and the rest.
std::string select(std::string_view rest) {
  static const std::string head = fmt::format("SELECT {} FROM job WHERE ", column_names<JobRow>());
  return head + std::string(rest);
}

}  // namespace

void JobTable::insert(const JobRow& row) {
  static const std::string into = "job(" + column_names<JobRow>() + ")";
  ColumnValues values;
  put_row(values, row);
  db_.insert_list(into, values.all());
}

void JobTable::update(JobRow& row) {
  static const std::string sql = fmt::format("UPDATE job SET rev=rev+1, {} WHERE id=? AND rev=?",
                                             column_names<JobRow>(false, "=?"));
  ColumnValues values;
  put_row(values, row, false);
  values.put(row.id);
  values.put(row.rev);
  const int changed = db_.run_list(sql, values.all());
  if (changed != 1)
    throw StoreFault(FaultKind::Again, "job " + row.id + " has changed in the meantime");
  ++row.rev;
}

std::optional<JobRow> JobTable::find(std::string_view id) {
  static const std::string sql = select("id=? AND deleted=0");
  return first_of(db_.rows(sql, id), read_row<JobRow>);
}

std::vector<JobRow> JobTable::list(const JobFilter& filter, const std::string& after, int limit,
                                   std::string& looked_to) {
  // Each state is a run of an index in the order of ids; a page is the first of all these runs. One
  // member of the filter chooses the run, the others are held against its rows.
  const bool by_state = !filter.states.empty();
  std::string sql = select(filter.newest_first ? "id<?1" : "id>?1");
  if (by_state)
    sql += " AND state=?3";
  else if (!filter.owner.empty())
    sql += " AND owner=?3";
  else if (!filter.device.empty())
    sql += " AND device=?3";
  sql += filter.newest_first ? " ORDER BY id DESC LIMIT ?2" : " ORDER BY id LIMIT ?2";
  const auto before = [&](const std::string& a, const std::string& b) {
    return filter.newest_first ? a > b : a < b;
  };
  constexpr const char* kAboveAllIds = "~";
  std::string from = after.empty() && filter.newest_first ? kAboveAllIds : after;
  // One below the first id of that time, so that it is itself found.
  const std::string oldest = filter.since ? first_ulid_of(*filter.since - 1) : std::string();
  if (!filter.newest_first) from = std::max(from, oldest);
  std::vector<std::string_view> keys{!filter.owner.empty() ? filter.owner : filter.device};
  if (by_state) {
    keys.clear();
    for (const JobState state : filter.states) keys.push_back(name_of(state));
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  const int most = std::max(limit, kMostLooked / static_cast<int>(keys.size()));
  static const int deleted_at = column_at<JobRow>("deleted"), owner_at = column_at<JobRow>("owner"),
                   device_at = column_at<JobRow>("device"), site_at = column_at<JobRow>("site"),
                   id_at = column_at<JobRow>("id");
  const auto fits = [&](const Rows& rows) {
    return rows.integer(deleted_at) == 0 &&
           (filter.owner.empty() || rows.text(owner_at) == filter.owner) &&
           (filter.device.empty() || rows.text(device_at) == filter.device) &&
           (filter.site.empty() || rows.text(site_at) == filter.site);
  };
  std::vector<JobRow> all;
  looked_to.clear();
  for (const std::string_view key : keys) {
    const bool has_key = by_state || !filter.owner.empty() || !filter.device.empty();
    int looked = 0, found = 0;
    std::string last = from;
    // A shared database answers with all rows at once, so it is asked for few.
    for (int piece = db_.is_shared() ? std::min(most, 2 * limit + 1) : most, got = piece;
         got == piece && found < limit && looked < most;) {
      const std::array<Bound, 3> values{last, piece, key};
      Rows rows = db_.rows_list(sql, std::span(values).first(has_key ? 3 : 2));
      got = 0;
      while (found < limit && looked < most && rows.next()) {
        ++got;
        if (filter.newest_first && rows.text(id_at) <= oldest) break;
        ++looked;
        last = rows.text(id_at);
        if (!fits(rows)) continue;
        ++found;
        all.push_back(read_row<JobRow>(rows));
      }
    }
    // Of the others of this run nothing is known yet.
    if (found < limit && looked == most && (looked_to.empty() || before(last, looked_to)))
      looked_to = last;
  }
  // The rows of one state come in order.
  const auto is_before = [&](const JobRow& a, const JobRow& b) { return before(a.id, b.id); };
  if (!std::is_sorted(all.begin(), all.end(), is_before))
    std::sort(all.begin(), all.end(), is_before);
  if (!looked_to.empty())
    std::erase_if(all, [&](const JobRow& row) { return before(looked_to, row.id); });
  if (all.size() >= static_cast<std::size_t>(limit)) looked_to.clear();
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

JobTable::QueueSlice JobTable::queue(const std::string& device,
                                     const std::optional<QueuePlace>& after, int most) {
  constexpr int kAboveAll = 1000;
  const QueuePlace from = after.value_or(QueuePlace{kAboveAll, 0, {}});
  static const std::string sql = select(
      "state NOT IN ('done', 'failed', 'cancelled') AND priority<=?2 AND "
      "(priority<?2 OR (position, id)>(?3, ?4)) ORDER BY priority DESC, position, id LIMIT ?1");
  QueueSlice slice;
  Rows rows = db_.rows(sql, most, from.priority, from.position, from.id);
  int looked = 0;
  for (; looked < most && rows.next(); ++looked) {
    auto row = read_row<JobRow>(rows);
    slice.last = {row.priority, row.position, row.id};
    const std::string& bound = row.device.empty() ? row.requested_device : row.device;
    if (device.empty() || bound.empty() || bound == device) slice.jobs.push_back(std::move(row));
  }
  slice.is_end = looked < most;
  return slice;
}

std::vector<JobRow> JobTable::waiting_for(const std::string& plan, JobState state, int limit) {
  static const std::string sql = select("plan=? AND state=? LIMIT ?");
  return all_of(db_.rows(sql, plan, name_of(state), limit), read_row<JobRow>);
}

std::optional<JobRow> JobTable::on_device(const std::string& device) {
  static const std::string sql = select("device=? AND state IN ('armed', 'cutting', 'paused')");
  return first_of(db_.rows(sql, device), read_row<JobRow>);
}

std::int64_t JobTable::last_position() { return db_.number("SELECT max(position) FROM job"); }

std::int64_t JobTable::count(JobState state) {
  return db_.number("SELECT sum(jobs) FROM tally WHERE state=?", name_of(state));
}

std::int64_t JobTable::open_count() {
  return db_.number(
      "SELECT sum(jobs) FROM tally WHERE state NOT IN ('done', 'failed', 'cancelled')");
}

std::int64_t JobTable::open_count_of(const std::string& owner) {
  return db_.number(
      "SELECT count(*) FROM job WHERE owner=? AND state NOT IN ('done', 'failed', 'cancelled')",
      owner);
}

std::optional<std::int64_t> JobTable::make_room(const JobRow& next, const std::string& moved) {
  constexpr int kMostMoved = 500;
  constexpr std::int64_t kLeastGap = 16;  // so that the next few need not move them again
  // Those before it come in the opposite order of the index, ids too: the nearest is the first.
  const std::int64_t low = db_.number(
      "SELECT position FROM job WHERE priority=? AND (position, id)<(?, ?) AND id!=? AND state NOT "
      "IN ('done', 'failed', 'cancelled') ORDER BY position DESC, id DESC LIMIT 1",
      next.priority, next.position, next.id, moved);
  if (next.position - low > 1) return low + (next.position - low) / 2;
  std::vector<std::string> ids;
  std::optional<std::int64_t> high;
  Rows rows = db_.rows(
      "SELECT id, position FROM job WHERE priority=? AND (position, id)>=(?, ?) AND id!=? AND "
      "state "
      "NOT IN ('done', 'failed', 'cancelled') ORDER BY position, id LIMIT ?",
      next.priority, next.position, next.id, moved, kMostMoved + 1);
  while (rows.next()) {
    // They fit in front of this one: `ids`, and the one that is to come before them.
    if (rows.integer(1) - low > kLeastGap * static_cast<std::int64_t>(ids.size() + 2)) {
      high = rows.integer(1);
      break;
    }
    ids.push_back(rows.text(0));
  }
  if (!high && ids.size() > kMostMoved) return std::nullopt;
  const auto count = static_cast<std::int64_t>(ids.size());
  const std::int64_t gap = high ? (*high - low) / (count + 2) : kPositionStep;
  for (std::int64_t k = 0; k < count; ++k)
    db_.run("UPDATE job SET position=? WHERE id=?", low + gap * (k + 2),
            ids[static_cast<std::size_t>(k)]);
  return low + gap;
}

}  // namespace popcut::daemon
