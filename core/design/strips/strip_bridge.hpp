// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/design/spec/report.hpp"
#include "core/design/strips/strips.hpp"
#include "core/design/target/curve.hpp"

namespace popcut {

/// A place between two strips whose levels do not pair (another N on the other side, say), where a
/// connector is wanted.
struct BridgeAim {
  std::size_t left_strip{};    ///< the next strip is the right one
  const SliceCurve* target{};  ///< the target at the middle of the connector
};

struct BridgedStrips {
  Strips strips;
  std::vector<BridgeReport> made;
  std::vector<std::size_t> refused;  ///< indices of the aims for which no connector is valid
};

/// Puts a connector, called a bridge, at each aim where one is valid (docs/geometry.md, section 4:
/// "a connector is made wherever one is valid").
///
/// What a connector needs is less than paired levels: a monotone staircase from the wall to the
/// ground each of whose panels lies in a plane of the left or of the right strip and overlaps that
/// strip's own panel there. Then each panel belongs to a rigid face that already moves with the
/// common motion, so no freedom is added or lost for any N beside any N', and a staircase crosses
/// nothing. Among all such staircases the one is taken that lies nearest to the target with even
/// steps, by dynamic programming over the points where one plane of each kind meets near the
/// target. It is refused where none has panels and joints of at least `min_panel_mm`, joins both
/// sides, and stays within one mean step of the coarser side from the target.
///
/// A bridge is as wide as the two halves of connectors that a plain cut leaves out: half of each
/// neighbouring slice strip; boxes have their full width already. Aims are in the order of strips.
/// The strips must stand in a card.
[[nodiscard]] BridgedStrips add_bridges(const Strips& strips, std::span<const BridgeAim> aims,
                                        double min_panel_mm);

}  // namespace popcut
