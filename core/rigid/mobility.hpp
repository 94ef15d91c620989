// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/buckets.hpp"

namespace popcut::rigid {

/// Panels parallel to wall or ground, seen along the spine, to which all their folds are parallel.
/// Only panels of different directions meet in folds, at x = offset of the upright one and
/// z = offset of the level one.
struct Section {
  std::vector<std::uint8_t> upright;  ///< one a panel: 1 parallel to the wall, 0 to the ground
  std::vector<double> offset;         ///< one a panel: its x if it is upright, else its z
  Buckets<std::uint32_t> folds;       ///< the panels that each panel meets in a fold
  /// For `Propagation` alone, one a panel: folds of a panel that are nearer to each other are one
  /// place. Empty: only folds at the same place are.
  std::vector<double> apart{};

  [[nodiscard]] std::size_t panels() const { return upright.size(); }
};

/// How a section can move.
struct Mobility {
  int degrees_of_freedom{};
  int pieces{};
  std::vector<std::uint8_t> loose;  ///< one a panel: 1 where it moves in more than the one way
};

/// Counts the freedoms exactly, in O(panels) where there is one.
///
/// All folds are parallel to the spine, so every small motion is planar. An upright panel at x = X
/// moves with velocities (a - w z, B) and a level one at z = Z with (C, e + w x). Folds equate
/// them, and the two coordinates part: on each upright panel the C of its folds are affine in z, on
/// each level panel the B are affine in x. Both systems are solved by `Propagation`. What it does
/// not reach, loose ends mostly, falls into components, and the rank of each one's interpolation
/// equations is found by a QR factorisation. Freedoms = unknowns of both systems less the three
/// motions of the whole.
[[nodiscard]] Mobility mobility(const Section& section);

/// Follows one of the two systems of `mobility` from the panels that are held.
///
/// The panels of one direction are lines, which have an affine function each; those of the other
/// direction are nodes, which have one number each. A node lies on a line where they meet in a
/// fold, at the node's offset. A line that is held holds its nodes. Two held nodes at different
/// places, farther apart than `Section::apart`, hold a line. O(folds) for all calls together.
class Propagation {
 public:
  explicit Propagation(const Section& section)
      : section_(section), held_(section.panels(), 0), ends_(section.panels()) {}

  /// Holds a line and what follows.
  void hold(std::uint32_t line);
  [[nodiscard]] bool is_held(std::size_t panel) const { return held_[panel] != 0; }

  /// Holds a line by pins, with what follows: first all lines on which one node is held, since each
  /// of these takes one pin; then the line itself, which takes two.
  /// @return the number of pins
  int pin(std::uint32_t line);

 private:
  /// The places of the held nodes of a line lie between these.
  struct Ends {
    double low{1.0}, high{0.0};  ///< low > high: there are none
  };

  void reach(std::uint32_t line, std::uint32_t node);

  const Section& section_;
  std::vector<std::uint8_t> held_;
  std::vector<Ends> ends_;  ///< one a line
  std::vector<std::uint32_t> work_, with_one_node_;
};

}  // namespace popcut::rigid
