// SPDX-License-Identifier: MIT
#include "daemon/model/metrics.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut::daemon {

Histogram::Histogram(std::vector<double> bounds)
    : bounds_(std::move(bounds)), buckets_(bounds_.size() + 1) {}

void Histogram::add(double seconds) {
  const auto bucket = std::lower_bound(bounds_.begin(), bounds_.end(), seconds) - bounds_.begin();
  ++buckets_[static_cast<std::size_t>(bucket)];
  ++count_;
  seconds_ += seconds;
  longest_s_ = std::max(longest_s_, seconds);
}

void Histogram::append(std::string& text, std::string_view name, const std::string& labels) const {
  const std::string before = labels.empty() ? "" : labels + ",";
  const std::string alone = labels.empty() ? "" : "{" + labels + "}";
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < buckets_.size(); ++i) {
    below += buckets_[i];
    const std::string bound = i < bounds_.size() ? fmt::format("{}", bounds_[i]) : "+Inf";
    text += fmt::format("{}_bucket{{{}le=\"{}\"}} {}\n", name, before, bound, below);
  }
  text += fmt::format("{0}_sum{1} {2:.6f}\n{0}_count{1} {3}\n", name, alone, seconds_, count_);
}

std::string metric_label(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

}  // namespace popcut::daemon
