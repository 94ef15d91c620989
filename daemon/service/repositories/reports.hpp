// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/service_store.hpp"
#include "daemon/service/service_thread.hpp"
#include "daemon/store/job_table.hpp"

namespace popcut::daemon {

/// Sums finished attempts by "owner", "device" or "material". `from` is included, `to` is not.
/// Attempts that end after construction are not counted.
class UsageSum {
 public:
  UsageSum(Database& database, std::optional<TimeMs> from, std::optional<TimeMs> to,
           const std::string& by);
  /// Adds up to `rows` more attempts. True if there are no more.
  ///
  /// @throws StoreFault
  [[nodiscard]] bool step(std::int64_t rows);
  /// The sums, by key.
  [[nodiscard]] std::vector<UsageRow> rows() const;

 private:
  Database& database_;
  TimeMs from_, to_;
  const char* column_;
  std::int64_t at_{0}, last_;
  std::map<std::string, UsageRow> sums_{};
};

/// The use of a device for a sheet of a job.
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

/// Lines of OpenMetrics about the turns of the service's thread.
[[nodiscard]] std::string turns_text(const ServiceThread& thread);

}  // namespace popcut::daemon
