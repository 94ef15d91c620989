// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/reports.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "daemon/jobs/rules.hpp"
#include "daemon/model/metrics.hpp"

namespace popcut::daemon {
namespace {

void put_durations(std::string& text, std::string_view name, std::string_view help,
                   const Histogram& durations) {
  text += fmt::format("# TYPE {0} histogram\n# HELP {0} {1}\n", name, help);
  durations.append(text, name, "");
  text +=
      fmt::format("# TYPE {0}_longest gauge\n{0}_longest {1:.6f}\n", name, durations.longest_s());
}

}  // namespace

UsageSum::UsageSum(Database& database, std::optional<TimeMs> from, std::optional<TimeMs> to,
                   const std::string& by)
    : database_(database),
      from_(from.value_or(std::numeric_limits<TimeMs>::min())),
      to_(to.value_or(std::numeric_limits<TimeMs>::max())),
      column_(by == "device"     ? "device"
              : by == "material" ? "material"
                                 : "owner"),
      last_(database.number("SELECT max(seq) FROM usage")) {}

bool UsageSum::step(std::int64_t rows) {
  const std::int64_t end = std::min(last_, at_ + rows);
  const char* const column = column_;
  Rows some = database_.rows(
      fmt::format("SELECT {0}, sum(seconds), sum(cut_mm), sum(sheets) FROM usage WHERE seq>? AND "
                  "seq<=? AND time>=? AND time<? GROUP BY {0}",
                  column),
      at_, end, from_, to_);
  while (some.next()) {
    UsageRow row;
    some.read(0, std::tie(row.key, row.seconds, row.cut_mm, row.sheets));
    UsageRow& sum = sums_[row.key];
    sum.key = row.key;
    sum.seconds += row.seconds;
    sum.cut_mm += row.cut_mm;
    sum.sheets += row.sheets;
  }
  at_ = end;
  return at_ >= last_;
}

std::vector<UsageRow> UsageSum::rows() const {
  std::vector<UsageRow> all;
  all.reserve(sums_.size());
  for (const auto& [key, sum] : sums_) all.push_back(sum);
  return all;
}

void record_usage(ServiceStore& store, const JobRow& job, const SheetUse& use) {
  store.db().insert_later(
      "usage(time, owner, operator, device, material, job, k, seconds, cut_mm, sheets)",
      store.now(), job.owner, use.operator_name, use.device, job.material, job.id, use.sheet,
      use.seconds, use.cut_mm, use.sheets);
}

std::string metrics_text(ServiceStore& store, JobTable& jobs,
                         const std::vector<DeviceRecord>& devices) {
  std::string text;
  const auto out = std::back_inserter(text);
  Database& db = store.db();
  fmt::format_to(out, "# TYPE popcut_jobs gauge\n# HELP popcut_jobs Jobs by state.\n");
  for (const JobState state : all_states())
    fmt::format_to(out, "popcut_jobs{{state=\"{}\"}} {}\n", name_of(state), jobs.count(state));
  const std::int64_t oldest =
      db.number("SELECT created FROM job WHERE state='queued' ORDER BY id LIMIT 1");
  fmt::format_to(out,
                 "# TYPE popcut_queue_oldest_seconds gauge\n# HELP popcut_queue_oldest_seconds Age "
                 "of the oldest queued job.\npopcut_queue_oldest_seconds {:.3f}\n",
                 oldest == 0 ? 0.0 : static_cast<double>(store.now() - oldest) / 1000);
  fmt::format_to(out,
                 "# TYPE popcut_sheets counter\n# HELP popcut_sheets Sheets by "
                 "outcome.\n");
  for (const DeviceRecord& device : devices)
    fmt::format_to(out, "popcut_sheets_total{{device=\"{}\",outcome=\"done\"}} {}\n",
                   metric_label(device.id), device.sheets_done);
  Rows ends = db.rows(
      "SELECT device, CASE end_kind WHEN 'cancelled' THEN 'cancelled' ELSE 'interrupted' END AS "
      "outcome, sum(attempts) FROM end_tally WHERE end_kind NOT IN ('done', 'refused') GROUP BY "
      "device, outcome ORDER BY device, outcome");
  while (ends.next())
    fmt::format_to(out, "popcut_sheets_total{{device=\"{}\",outcome=\"{}\"}} {}\n",
                   metric_label(ends.text(0)), ends.text(1), ends.integer(2));
  fmt::format_to(out, "# TYPE popcut_cut_mm counter\n");
  for (const DeviceRecord& device : devices)
    fmt::format_to(out, "popcut_cut_mm_total{{device=\"{}\"}} {:.1f}\n", metric_label(device.id),
                   device.cut_mm);
  fmt::format_to(out, "# TYPE popcut_interrupted counter\n");
  Rows causes = db.rows(
      "SELECT end_kind, sum(attempts) FROM end_tally WHERE end_kind NOT IN ('done', 'cancelled', "
      "'refused') GROUP BY end_kind ORDER BY end_kind");
  while (causes.next())
    fmt::format_to(out, "popcut_interrupted_total{{cause=\"{}\"}} {}\n",
                   metric_label(causes.text(0)), causes.integer(1));
  const ServiceStore::Figures& figures = store.figures();
  put_durations(text, "popcut_db_commit_seconds", "Duration of database commits.", figures.commits);
  put_durations(text, "popcut_stream_wait_seconds",
                "Time a cutter waits until its next paths are recorded.", figures.stream_waits);
  fmt::format_to(out, "# TYPE popcut_db_free_bytes gauge\npopcut_db_free_bytes {}\n",
                 store.folder().free_bytes());
  fmt::format_to(out, "# TYPE popcut_db_degraded gauge\npopcut_db_degraded {}\n",
                 store.degraded() ? 1 : 0);
  return text;
}

std::string turns_text(const ServiceThread& thread) {
  constexpr std::string_view kName = "popcut_service_turn_seconds";
  using Lane = ServiceThread::Lane;
  std::string text = fmt::format(
      "# TYPE {0} histogram\n# HELP {0} Time for which one piece of work kept the thread that "
      "feeds "
      "and stops the knife.\n",
      kName);
  const std::array<std::pair<std::string, Turns>, 2> lanes{
      {{"cutting", thread.turns(Lane::Cutting)}, {"asking", thread.turns(Lane::Asking)}}};
  for (const auto& [lane, turns] : lanes)
    turns.append_histogram(text, kName, fmt::format("lane=\"{}\"", lane));
  const auto put = [&](const char* name, double TurnTime::*member) {
    text += fmt::format("# TYPE {} gauge\n", name);
    for (const auto& [lane, turns] : lanes)
      for (const auto& [work, time] : turns.longest())
        text += fmt::format("{}{{lane=\"{}\",work=\"{}\"}} {:.6f}\n", name, lane,
                            metric_label(work), time.*member);
  };
  put("popcut_service_turn_longest_seconds", &TurnTime::wall_s);
  put("popcut_service_turn_longest_cpu_seconds", &TurnTime::cpu_s);
  return text;
}

}  // namespace popcut::daemon
