// SPDX-License-Identifier: MIT
#include "core/drawing/linework.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/pattern/pattern.hpp"

namespace popcut {

void LineWork::append(Operation operation, std::span<const PagePoint> line) {
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

bool is_cut(Operation operation) {
  return operation == Operation::Cut || operation == Operation::Outline;
}

LineWork linework_from_pattern(const Pattern& pattern) {
  const auto operation = [](EdgeRole role) {
    switch (role) {
      case EdgeRole::Mountain:
        return Operation::FoldMountain;
      case EdgeRole::Valley:
        return Operation::FoldValley;
      case EdgeRole::Slit:
        return Operation::Cut;
      case EdgeRole::Outline:
        break;
    }
    return Operation::Outline;
  };
  LineWork work;
  work.name = pattern.name;
  work.points.reserve(2 * pattern.lines.size());
  work.lines.reserve(pattern.lines.size());
  for (const SheetLine& line : pattern.lines)
    work.append(operation(line.role),
                std::array{PagePoint{line.v0, line.u0}, PagePoint{line.v1, line.u1}});
  return work;
}

const char* operation_name(Operation operation) {
  switch (operation) {
    case Operation::Draw:
      return "draw";
    case Operation::Score:
      return "score";
    case Operation::FoldMountain:
      return "fold-mountain";
    case Operation::FoldValley:
      return "fold-valley";
    case Operation::Cut:
      return "cut";
    case Operation::Outline:
      break;
  }
  return "outline";
}

}  // namespace popcut
