// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon {

/// A response as it is kept with an idempotency key.
struct Rendered {
  int status{200};
  std::string body;
  std::string etag{}, location{};
  bool replayed{false};
};

/// A request that may arrive twice and must take effect once.
struct IdempotentRequest {
  std::string key;     ///< empty: the request names none
  std::string sha256;  ///< of method, path, body and principal
};

struct ServiceHealth {
  bool database{false};
  std::uint64_t disk_free_mb{};
  bool accepts_work{false};
  std::string remark;
};

/// What concerns the service as a whole: keys of requests, events, figures, the database. See
/// `Service`.
class Operations {
 public:
  virtual ~Operations() = default;
  /// Runs `effect` and keeps its response under the key, in one transaction. The second time, the
  /// same request is answered with the kept response, and `effect` does not run. A response of
  /// status 500 or above, or 429, is rolled back and not kept.
  [[nodiscard]] virtual Answer<Rendered> once(const Principal&, const IdempotentRequest&,
                                              const std::function<Rendered()>& effect) = 0;

  [[nodiscard]] virtual Answer<std::vector<Event>> events(std::int64_t after, int limit,
                                                          const std::string& job) = 0;
  [[nodiscard]] virtual std::int64_t last_event() = 0;
  [[nodiscard]] virtual std::int64_t first_event() = 0;
  /// `listener` is called on the service's thread for each event after its commit, in order.
  virtual void listen(std::function<void(const Event&)> listener) = 0;

  [[nodiscard]] virtual std::vector<UsageRow> usage(std::optional<TimeMs> from,
                                                    std::optional<TimeMs> to,
                                                    const std::string& by) = 0;
  [[nodiscard]] virtual ServiceHealth health() = 0;
  /// OpenMetrics lines of the jobs, devices and the store (HTTP adds its own).
  [[nodiscard]] virtual std::string metrics() = 0;

  /// A copy of the database by VACUUM INTO; gives its path.
  [[nodiscard]] virtual Answer<std::string> backup(const Principal&) = 0;
  [[nodiscard]] virtual Answer<std::string> check_integrity(const Principal&) = 0;
};

}  // namespace popcut::daemon
