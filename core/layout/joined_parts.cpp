// SPDX-License-Identifier: MIT
// Part of core/layout/layout.hpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/layout/layout.hpp"
#include "core/layout/line_index.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {
namespace {

// The parts of an outline along v that lie on none of the part's seams.
std::vector<std::array<double, 2>> free_of_seams(const Pattern& part, const SheetLine& line) {
  std::vector<std::array<double, 2>> free{{std::min(line.u0, line.u1), std::max(line.u0, line.u1)}};
  if (line.role != EdgeRole::Outline || std::abs(line.v0 - line.v1) > kOn) return free;
  for (const Seam& seam : part.seams) {
    if (std::abs(seam.v_mm - line.v0) > kOn) continue;
    const double low = std::min(seam.u0_mm, seam.u1_mm), high = std::max(seam.u0_mm, seam.u1_mm);
    std::vector<std::array<double, 2>> rest;
    for (const auto& [from, to] : free) {
      if (std::min(to, low) > from + kOn) rest.push_back({from, std::min(to, low)});
      if (to > std::max(from, high) + kOn) rest.push_back({std::max(from, high), to});
    }
    free = std::move(rest);
  }
  return free;
}

}  // namespace

JoinedParts join_parts(const std::vector<const Pattern*>& parts) {
  JoinedParts out;
  for (const Pattern* part : parts) {
    Pattern placed;  // only its lines are used
    placed.lines.reserve(part->lines.size());
    const double u = part->place.u_mm, v = part->place.v_mm;
    for (SheetLine line : part->lines) {
      const bool along = std::abs(line.v0 - line.v1) <= kOn;
      if (line.role == EdgeRole::Outline && along) {
        for (const auto& [from, to] : free_of_seams(*part, line))
          placed.lines.push_back({from + u, line.v0 + v, to + u, line.v1 + v, line.role});
        continue;
      }
      placed.lines.push_back({line.u0 + u, line.v0 + v, line.u1 + u, line.v1 + v, line.role});
    }
    const LineWork work = linework_from_pattern(placed);
    for (const DrawnLine& line : work.lines)
      out.drawing.append(line.operation, work.points_of(line));
    for (const Seam& seam : part->seams)
      if (seam.v_mm > kOn) out.seams_x.push_back(seam.v_mm + v);
  }
  const Box box = bounds(out.drawing);
  for (double& x : out.seams_x) x -= box.x0;
  std::sort(out.seams_x.begin(), out.seams_x.end());
  return out;
}

}  // namespace popcut
