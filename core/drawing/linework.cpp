// SPDX-License-Identifier: MIT
#include "core/drawing/linework.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/pattern/pattern.hpp"

namespace popcut {
namespace {

// The part of a..b within the area, as parameters t0, t1 in 0..1 (Liang and Barsky 1984).
bool clip_segment(const PagePoint& a, const PagePoint& b, const Box& area, double& t0, double& t1) {
  t0 = 0.0;
  t1 = 1.0;
  const auto side = [&](double p, double q) {  // p t <= q
    if (p == 0.0) return q >= 0.0;
    const double r = q / p;
    if (p < 0.0) t0 = std::max(t0, r);
    if (p > 0.0) t1 = std::min(t1, r);
    return t0 <= t1;
  };
  return side(a.x - b.x, a.x - area.x0) && side(b.x - a.x, area.x1 - a.x) &&
         side(a.y - b.y, a.y - area.y0) && side(b.y - a.y, area.y1 - a.y);
}

}  // namespace

void LineWork::append(PenOperation operation, std::span<const PagePoint> line) {
  if (line.size() < 2) return;
  lines.push_back({operation, static_cast<std::uint32_t>(points.size()),
                   static_cast<std::uint32_t>(line.size())});
  points.insert(points.end(), line.begin(), line.end());
}

Box bounds(const LineWork& work) {
  Box box;
  for (const DrawnLine& line : work.lines)
    for (const PagePoint& p : work.points_of(line)) box.add(p);
  return box;
}

bool is_fold(Operation operation) {
  return operation == Operation::FoldMountain || operation == Operation::FoldValley;
}

int strength(Operation operation) {
  constexpr std::array kStrengths{0, 1, 3, 2, 4, 5};  // by operation
  return kStrengths.at(static_cast<std::size_t>(operation));
}

bool is_cut(Operation operation) {
  return operation == Operation::Cut || operation == Operation::Outline;
}

LineWork linework_from_pattern(const Pattern& pattern) {
  constexpr std::array kOperations{Operation::FoldMountain, Operation::FoldValley, Operation::Cut,
                                   Operation::Outline};  // by role
  LineWork work;
  work.name = pattern.name;
  work.points.reserve(2 * pattern.lines.size());
  work.lines.reserve(pattern.lines.size());
  for (const SheetLine& line : pattern.lines)
    work.append(kOperations.at(static_cast<std::size_t>(line.role)),
                std::array{PagePoint{line.v0, line.u0}, PagePoint{line.v1, line.u1}});
  return work;
}

const char* operation_name(Operation operation) {
  constexpr std::array kNames{"draw", "score", "fold-mountain", "fold-valley", "cut", "outline"};
  return kNames.at(static_cast<std::size_t>(operation));
}

void clip_line(std::span<const PagePoint> line, PenOperation operation, const Box& area,
               std::vector<PagePoint>& run, LineWork& out) {
  const std::size_t first_line = out.lines.size();
  run.clear();
  for (std::size_t i = 1; i < line.size(); ++i) {
    double t0 = 0.0, t1 = 0.0;
    const bool some = clip_segment(line[i - 1], line[i], area, t0, t1) && t1 > t0;
    if (!some || t0 > 0.0) {
      out.append(operation, run);
      run.clear();
    }
    if (!some) continue;
    if (run.empty()) run.push_back(between(line[i - 1], line[i], t0));
    run.push_back(between(line[i - 1], line[i], t1));
    if (t1 < 1.0) {
      out.append(operation, run);
      run.clear();
    }
  }
  // A closed line that was cut open continues through its seam.
  const bool through_seam = closed(line) && run.size() > 1 && out.lines.size() > first_line &&
                            out.points[out.lines[first_line].first] == run.back();
  if (through_seam) {
    const auto head = out.points_of(out.lines[first_line]);
    run.insert(run.end(), head.begin() + 1, head.end());
    out.lines.erase(out.lines.begin() + static_cast<std::ptrdiff_t>(first_line));
  }
  out.append(operation, run);
  run.clear();
}

}  // namespace popcut
