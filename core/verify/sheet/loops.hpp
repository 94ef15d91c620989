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
  bool to_left{};         ///< true: from its right face to its left face
};

/// A basis of the closed paths over the faces: one around each vertex inside the sheet, and one
/// around each slit and hole. The crossings of loop k are `first[k] .. first[k + 1]`.
struct Loops {
  std::vector<std::uint32_t> first;
  std::vector<Crossing> crossings;

  [[nodiscard]] std::size_t size() const { return first.size() - 1; }
};

/// None if the sheet is inconsistent: its number of loops is not hinges minus faces plus pieces, as
/// it is for a planar sheet (Euler).
[[nodiscard]] std::optional<Loops> loops_of(const FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify
