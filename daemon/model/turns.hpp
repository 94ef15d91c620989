// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "daemon/model/metrics.hpp"

namespace popcut::daemon {

/// Names the turn of the service's thread in which it is called ("POST /v1/designs", "tick"), for
/// its figures. Elsewhere it does nothing that anyone sees.
void name_turn(std::string_view name, std::string_view more = {});

/// How long one piece of work kept a thread.
struct TurnTime {
  double wall_s{};  ///< as whoever waits sees it
  double cpu_s{};   ///< of the processor; what else the computer does is not in it
};

/// Measures one turn from its construction on, and forgets the name of the one before.
class TurnClock {
 public:
  TurnClock();
  [[nodiscard]] TurnTime elapsed() const;
  /// What `name_turn` said since; "other" if nothing.
  [[nodiscard]] static const std::string& name();

 private:
  std::int64_t wall_ns_, cpu_ns_;
};

/// What the turns of one lane came to.
class Turns {
 public:
  void add(const std::string& name, const TurnTime& time);
  /// The longest of each name.
  [[nodiscard]] const std::map<std::string, TurnTime>& longest() const { return longest_; }
  /// Appends the OpenMetrics lines of its histogram; `labels` as in `lane="asking"`.
  void append_histogram(std::string& text, std::string_view name, const std::string& labels) const {
    wall_.append(text, name, labels);
  }

 private:
  Histogram wall_{{0.001, 0.003, 0.01, 0.03, 0.05, 0.1, 1}};
  std::map<std::string, TurnTime> longest_{};
};

}  // namespace popcut::daemon
