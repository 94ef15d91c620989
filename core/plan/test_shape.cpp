// SPDX-License-Identifier: MIT
#include "core/plan/test_shape.hpp"

#include <array>

namespace popcut {

LineWork test_shape() {
  LineWork work;
  work.name = "test";
  constexpr std::array<PagePoint, 4> kTriangle{{{2, 8}, {8, 8}, {5, 3}, {2, 8}}};
  constexpr std::array<PagePoint, 5> kSquare{{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}}};
  constexpr std::array<PagePoint, 2> kFold{{{14, 0}, {14, 10}}};
  work.append(Operation::FoldValley, kFold);
  work.append(Operation::Cut, kTriangle);
  work.append(Operation::Outline, kSquare);
  return work;
}

}  // namespace popcut
