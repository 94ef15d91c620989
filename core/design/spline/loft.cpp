// SPDX-License-Identifier: MIT
#include "core/design/spline/loft.hpp"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace popcut {
namespace {

/// The steps at `y`, stretched to the sum `whole`.
std::vector<double> steps_at(const std::vector<MonotoneSpline>& steps, double y, double whole) {
  std::vector<double> out;
  out.reserve(steps.size());
  for (const MonotoneSpline& step : steps) out.push_back(step(y));
  const double sum = std::accumulate(out.begin(), out.end(), 0.0);
  for (double& step : out) step *= whole / sum;
  return out;
}

}  // namespace

Loft::Loft(std::vector<LoftStation> stations) : stations_(std::move(stations)) {
  if (stations_.size() < 2) return;
  const auto through = [&](auto value) {
    std::vector<std::array<double, 2>> points;
    for (const LoftStation& station : stations_)
      points.push_back({station.y, value(station.curve)});
    return MonotoneSpline(points);
  };
  for (std::size_t k = 1; k < stations_.front().curve.size(); ++k) {
    step_x_.push_back(through([k](const auto& curve) { return curve[k][0] - curve[k - 1][0]; }));
    step_z_.push_back(through([k](const auto& curve) { return curve[k - 1][1] - curve[k][1]; }));
  }
  end_.push_back(through([](const auto& curve) { return curve.front()[1]; }));
  end_.push_back(through([](const auto& curve) { return curve.back()[0]; }));
}

std::optional<FallingCurve> Loft::at(double y) const {
  if (end_.empty()) return FallingCurve(stations_.front().curve);
  const double h = end_[0](y), d = end_[1](y);
  if (std::isnan(h)) return std::nullopt;
  const std::vector<double> right = steps_at(step_x_, y, d), down = steps_at(step_z_, y, h);
  std::vector<std::array<double, 2>> points{{0.0, h}};
  for (std::size_t k = 0; k < right.size(); ++k)
    points.push_back({points.back()[0] + right[k], points.back()[1] - down[k]});
  points.back() = {d, 0.0};
  return FallingCurve(points);
}

}  // namespace popcut
