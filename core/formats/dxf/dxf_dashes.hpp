// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// A line type as parts of its period.
struct DxfDashes {
  struct Part {
    double from{}, to{};  ///< fraction of the period, 0..1
  };
  std::vector<Part> dashes;  ///< half of the last gap comes before the first dash
  double period{};           ///< in drawing units
};

/// The dashes of a line type's elements (above 0 a dash, below 0 a gap, 0 a dot, which cannot be
/// cut). Empty unless there are both dashes and gaps.
[[nodiscard]] DxfDashes dxf_dashes(std::span<const double> elements);

/// How many periods of `period` (mm) a line of `length` gets: at least one.
[[nodiscard]] double dxf_periods(double length, double period);

/// Calls `put(points)` for each dash of `line`, with `periods` periods end to end.
template <typename Put>
bool each_dash(std::span<const PagePoint> line, const DxfDashes& dashes, double periods, Put put) {
  const double l = length(line) / periods;  // of one period
  std::vector<PagePoint> dash;
  std::size_t i = 1;
  double before = 0.0;  // length up to line[i - 1]
  const auto go_to = [&](double s, bool keep) {
    double edge = distance(line[i - 1], line[i]);
    while (i + 1 < line.size() && before + edge < s) {
      before += edge;
      if (keep) dash.push_back(line[i]);
      ++i;
      edge = distance(line[i - 1], line[i]);
    }
    const double t = edge > 0.0 ? (s - before) / edge : 0.0;
    const double u = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    dash.push_back({line[i - 1].x + u * (line[i].x - line[i - 1].x),
                    line[i - 1].y + u * (line[i].y - line[i - 1].y)});
  };
  for (double k = 0; k < periods; k += 1.0)
    for (const DxfDashes::Part& part : dashes.dashes) {
      dash.clear();
      go_to((k + part.from) * l, false);
      go_to((k + part.to) * l, true);
      if (!put(std::span<const PagePoint>(dash))) return false;
    }
  return true;
}

}  // namespace popcut
