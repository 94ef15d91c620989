// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/reports.hpp"

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

std::vector<UsageRow> usage_by(Database& database, std::optional<TimeMs> from,
                               std::optional<TimeMs> to, const std::string& by) {
  const char* const column = by == "device" ? "device" : by == "material" ? "material" : "owner";
  return all_of(
      database.rows(
          fmt::format(
              "SELECT {0}, sum(seconds), sum(cut_mm), sum(sheets) FROM usage WHERE time>=? AND "
              "time<? GROUP BY {0} ORDER BY {0}",
              column),
          from.value_or(std::numeric_limits<TimeMs>::min()),
          to.value_or(std::numeric_limits<TimeMs>::max())),
      [](const Rows& rows) {
        UsageRow row;
        rows.read(0, std::tie(row.key, row.seconds, row.cut_mm, row.sheets));
        return row;
      });
}

void record_usage(ServiceStore& store, const JobRow& job, const SheetUse& use) {
  store.db().insert(
      "INSERT INTO usage(time, owner, operator, device, material, job, k, seconds, cut_mm, sheets)",
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
  const std::int64_t oldest = db.number(
      "SELECT min(created) FROM (SELECT created FROM job WHERE state='queued' ORDER BY id LIMIT "
      "1)");
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
      "outcome, count(*) FROM attempt WHERE ended IS NOT NULL AND end_kind NOT IN ('done', "
      "'refused') GROUP BY device, outcome ORDER BY device, outcome");
  while (ends.next())
    fmt::format_to(out, "popcut_sheets_total{{device=\"{}\",outcome=\"{}\"}} {}\n",
                   metric_label(ends.text(0)), ends.text(1), ends.integer(2));
  fmt::format_to(out, "# TYPE popcut_cut_mm counter\n");
  for (const DeviceRecord& device : devices)
    fmt::format_to(out, "popcut_cut_mm_total{{device=\"{}\"}} {:.1f}\n", metric_label(device.id),
                   device.cut_mm);
  fmt::format_to(out, "# TYPE popcut_interrupted counter\n");
  Rows causes = db.rows(
      "SELECT end_kind, count(*) FROM attempt WHERE ended IS NOT NULL AND end_kind NOT IN ('done', "
      "'cancelled', 'refused') GROUP BY end_kind ORDER BY end_kind");
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

}  // namespace popcut::daemon
