// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// A fold that a loop crosses, from one face to the next.
struct Crossing {
  std::uint32_t hinge{};  ///< index into `Sheet::hinges`
  bool to_left{};         ///< from its right face to its left one
};

/// Closed ways over the faces that all other closed ways are made of: one around each vertex inside
/// the sheet and one around each slit and hole. Those of loop k are `first[k] .. first[k + 1]`.
struct Loops {
  std::vector<std::uint32_t> first;
  std::vector<Crossing> crossings;

  [[nodiscard]] std::size_t size() const { return first.size() - 1; }
};

/// Nothing where the sheet is not sound enough for them: its loops do not number hinges less faces
/// plus pieces, as those of a sheet in a plane do (Euler).
[[nodiscard]] std::optional<Loops> loops_of(const FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify
