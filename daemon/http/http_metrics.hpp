// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace popcut::daemon::http {

/// Counters of the HTTP side. On its thread only.
class HttpMetrics {
 public:
  /// `route` is the pattern, never the path: no ids in labels.
  void count(std::string_view route, int status) { ++requests_[{std::string(route), status}]; }
  /// host, origin, auth, rate, size, depth, head or full.
  void reject(std::string_view why) { ++rejected_[std::string(why)]; }
  void set_streams(int streams) { streams_ = streams; }
  void drop_events(std::uint64_t count) { dropped_ += count; }
  /// OpenMetrics lines, without the last "# EOF".
  [[nodiscard]] std::string text(std::string_view build, int connections) const;

 private:
  std::map<std::pair<std::string, int>, std::uint64_t> requests_;
  std::map<std::string, std::uint64_t> rejected_;
  int streams_{0};
  std::uint64_t dropped_{0};
};

}  // namespace popcut::daemon::http
