// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/service/service_store.hpp"
#include "daemon/store/job_table.hpp"

namespace popcut::daemon {

/// Seconds, millimetres and sheets of attempts that ended from `from` up to before `to`, by
/// "owner", "device" or "material".
[[nodiscard]] std::vector<UsageRow> usage_by(Database& database, std::optional<TimeMs> from,
                                             std::optional<TimeMs> to, const std::string& by);

/// What a sheet of a job took of a device.
struct SheetUse {
  std::string operator_name, device;
  int sheet{};
  double seconds{}, cut_mm{};
  int sheets{};  ///< finished: 1 or 0
};
/// Notes the use, in a transaction.
void record_usage(ServiceStore& store, const JobRow& job, const SheetUse& use);

/// Lines of OpenMetrics about jobs, devices and the store; no names of jobs or people.
[[nodiscard]] std::string metrics_text(ServiceStore& store, JobTable& jobs,
                                       const std::vector<DeviceRecord>& devices);

}  // namespace popcut::daemon
