// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/design/boxes/height_maps.hpp"

namespace popcut {

enum class BlockRoof : std::uint8_t { Flat, Gabled, Pyramid };

/// A part of a target with upright walls along and across the spine and a roof, or a roof alone.
struct Block {
  double from_mm{}, to_mm{};  ///< its ends, along the spine
  double middle_mm{};         ///< across it
  double half_mm{};           ///< from there to its walls; of a roof alone to its foot
  double height_mm{};         ///< of its walls; 0: a roof alone
  BlockRoof roof{};
  double rise_mm{};                  ///< of the ridge or the top above the walls
  double eaves_mm{};                 ///< beyond the walls, down the slope
  std::array<double, 2> verge_mm{};  ///< beyond the ends

  [[nodiscard]] bool is_tent() const { return height_mm == 0.0; }
  [[nodiscard]] double top_mm() const { return height_mm + rise_mm; }
  /// The height of its roof over a place; 0 beyond it.
  [[nodiscard]] double height_at(double x_mm, double y_mm) const;
};

/// What lies below a block's roof and what differs from it, seen from above: mm^3.
struct BlockMisfit {
  Block block;
  double misfit_mm3{};
};

/// Sizes below which paper is not glued.
struct BlockSizes {
  double half_mm{8.0}, length_mm{10.0}, height_mm{9.0};
  double tent_mm{8.0};  ///< rise of a roof alone
};

/// The block that a stretch of rows of a target is most like, or none where it is too small or has
/// no walls. Its walls are the planes in which most of its sides lie; its roof is the flat, gabled
/// or pyramid one that fits best, by least squares that pass over chimneys and dormers.
///
/// @param may_be_pyramid  whether its roof may be one
[[nodiscard]] std::optional<BlockMisfit> fit_block(const HeightMaps& maps, std::size_t from_row,
                                                   std::size_t to_row, const BlockSizes& sizes,
                                                   bool may_be_pyramid = true);

/// Finds the ends of a block: its walls across the spine, and how far its roof goes beyond them.
///
/// @param is_free  which of both ends stands free; the others stay where they are, without verge
void fit_ends(const HeightMaps& maps, const EndMaps& ends, std::array<bool, 2> is_free,
              Block& block);

/// Volume between a block and what stretches of rows have, as seen from above, mm^3.
[[nodiscard]] double misfit_of(const HeightMaps& maps, std::size_t from_row, std::size_t to_row,
                               const Block& block);
/// The volume below all that these rows have.
[[nodiscard]] double volume_of(const HeightMaps& maps, std::size_t from_row, std::size_t to_row);

}  // namespace popcut
