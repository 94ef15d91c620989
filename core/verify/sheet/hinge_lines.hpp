// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/vec.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// A line about which two panels turn: all folds between the two in that line. Going from `from` to
/// `to`, panel `left` is on the left.
struct HingeLine {
  std::uint32_t left{}, right{};
  Vec2 from, to;          ///< on the flat sheet: the extreme ends of its folds
  std::uint32_t hinge{};  ///< its first fold, an index into `Sheet::hinges`
};

/// The hinge lines of a sheet, sorted by their panels. Two lines already lock two panels, so at
/// most three are kept for any two panels.
[[nodiscard]] std::vector<HingeLine> hinge_lines(const FoldModel& file, const Sheet& sheet);

/// The point of a panel at which its velocity is measured (the mean of its hinges' middles), and
/// the panel's size.
struct PanelFrame {
  Vec2 middle;
  double size_mm{};
  std::size_t hinges{};
};

/// The frames of `panels` panels, by index.
[[nodiscard]] std::vector<PanelFrame> panel_frames(const std::vector<HingeLine>& lines,
                                                   std::size_t panels);

}  // namespace popcut::verify
