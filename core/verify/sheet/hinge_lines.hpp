// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/vec.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// A line about which two panels turn against each other: all folds between the two in that line.
/// Going `from` to `to`, panel `left` is on the left hand.
struct HingeLine {
  std::uint32_t left{}, right{};
  Vec2 from, to;          ///< on the flat sheet: the ends of all its folds
  std::uint32_t hinge{};  ///< the first of its folds, an index into `Sheet::hinges`
};

/// The hinge lines of a sheet, sorted by their panels. Two lines already lock two panels, so no
/// more than three are kept for any two.
[[nodiscard]] std::vector<HingeLine> hinge_lines(const FoldModel& file, const Sheet& sheet);

/// Where a panel's velocity is told (the mean of its hinges' middles), and its size.
struct PanelFrame {
  Vec2 middle;
  double size_mm{};
  std::size_t hinges{};
};

[[nodiscard]] std::vector<PanelFrame> panel_frames(const std::vector<HingeLine>& lines,
                                                   std::size_t panels);

}  // namespace popcut::verify
