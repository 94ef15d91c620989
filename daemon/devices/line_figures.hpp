// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "daemon/model/metrics.hpp"

namespace popcut::daemon {

/// What went over the line to one cutter. From any thread.
class LineFigures {
 public:
  struct Shown {
    Histogram writes{{0.001, 0.005, 0.02, 0.1, 0.5, 2, 5, 20}};
    std::map<std::string, std::uint64_t> errors{};  ///< by kind
  };

  void note_write(double seconds);
  /// Counts an error as nodev, timeout, overflow, stall, short or other; `short_write`: a part of
  /// what was offered was taken.
  void note_error(const Error& error, bool short_write);
  [[nodiscard]] Shown shown() const;

 private:
  mutable std::mutex mutex_;
  Shown figures_;
};

/// The figures of some devices, by id, as lines of OpenMetrics.
[[nodiscard]] std::string line_metrics(
    const std::vector<std::pair<std::string, LineFigures::Shown>>& devices);

}  // namespace popcut::daemon
