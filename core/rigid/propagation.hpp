// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/rigid/section.hpp"

namespace popcut::rigid {

/// Follows one of the two systems of a section (see `mobility`) from the panels that are held.
///
/// The panels of one direction are lines, which have an affine function each; those of the other
/// direction are nodes, which have one number each. A node lies on a line where they meet in a
/// fold, at the node's offset. A line that is held holds its nodes. Two held nodes at different
/// places hold a line. O(folds) for all calls together.
class Propagation {
 public:
  explicit Propagation(const Section& section)
      : section_(section), held_(section.panels(), 0), first_(section.panels(), kNone) {}

  /// Holds a line and what follows.
  void hold(std::uint32_t line);
  [[nodiscard]] bool is_held(std::size_t panel) const { return held_[panel] != 0; }

  /// Holds a line by pins, with what follows: first all lines on which one node is held, since each
  /// of these takes one pin; then the line itself, which takes two.
  /// @return the number of pins
  int pin(std::uint32_t line);

 private:
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

  void reach(std::uint32_t line, std::uint32_t node);

  const Section& section_;
  std::vector<std::uint8_t> held_;
  std::vector<std::uint32_t> first_;  ///< the first held node of each line
  std::vector<std::uint32_t> work_, with_one_node_;
};

}  // namespace popcut::rigid
