// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// Finds the pen of a line by its colour and its layers. The names of pens are those of
/// `named_pens`: "red", "#00f", "colour 30" (an AutoCAD colour index), "layer red", "Etch".
class PenFinder {
 public:
  explicit PenFinder(const std::vector<std::string>& names);

  /// Whether a person named any pen; if not, nothing has to be looked for.
  [[nodiscard]] bool any() const { return !pens_.empty(); }
  /// The pen of a layer, group or element with this name; 0: none. `listed`: it is one of `seen`.
  [[nodiscard]] std::uint8_t of_layer(std::string_view name, bool listed = true);
  /// The pen of a colour, 0xRRGGBB; 0: none.
  [[nodiscard]] std::uint8_t of_colour(std::uint32_t rgb);
  /// The pen of an AutoCAD colour index; 0: none. 1 to 7 are red, yellow, green, cyan, blue,
  /// magenta, and black or white.
  [[nodiscard]] std::uint8_t of_index(int index);
  /// "layer Etch", "#ff0000", "colour 30": what the drawing has, as far as it was asked for; a few.
  [[nodiscard]] const std::vector<std::string>& seen() const { return seen_; }

 private:
  struct Pen {
    std::optional<std::uint32_t> rgb;
    std::optional<int> index;
    std::string label;  ///< of a layer, see `plain_name`; empty: a colour
  };
  void see(std::string what);
  template <typename Fits>
  [[nodiscard]] std::uint8_t find(Fits fits) const;

  std::vector<Pen> pens_;
  std::vector<std::string> seen_;
};

/// Numbers looks of lines, from 1.
class LookFinder {
 public:
  /// @param wanted  otherwise it has none
  explicit LookFinder(bool wanted) : wanted_(wanted) {}

  [[nodiscard]] bool any() const { return wanted_; }
  /// The number of the look of lines of this colour, on a layer whose name is not known, or "";
  /// that of the last look if there are too many.
  [[nodiscard]] std::uint8_t of_colour(std::string layer, std::uint32_t rgb);
  [[nodiscard]] std::uint8_t of_index(std::string layer, int index);
  [[nodiscard]] std::vector<DrawnLook>& seen() { return seen_; }

 private:
  std::uint8_t of(DrawnLook look);

  bool wanted_;
  std::vector<DrawnLook> seen_;
};

}  // namespace popcut
