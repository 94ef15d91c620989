// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace popcut::daemon {

/// How many seconds something took each time, counted in buckets. `add` takes no memory.
class Histogram {
 public:
  /// @param bounds  upper bounds of the buckets in seconds, ascending; one more bucket has none
  explicit Histogram(std::vector<double> bounds);
  void add(double seconds);
  [[nodiscard]] double longest_s() const { return longest_s_; }
  /// Appends its OpenMetrics lines; `labels` are empty, or as in `device="sim:cameo3"`.
  void append(std::string& text, std::string_view name, const std::string& labels) const;

 private:
  std::vector<double> bounds_;
  std::vector<std::uint64_t> buckets_;
  std::uint64_t count_{};
  double seconds_{}, longest_s_{};
};

/// A label's value in OpenMetrics: backslash and quote escaped, a newline as a blank.
[[nodiscard]] std::string metric_label(const std::string& text);

}  // namespace popcut::daemon
