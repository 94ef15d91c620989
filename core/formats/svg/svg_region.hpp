// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/formats/svg/syntax/svg_path.hpp"

namespace popcut {

/// An area on the page that shows what is drawn: shapes by their fill rules, and what any or all of
/// them have in common. Lengths are mm.
///
/// Add shapes and combinations, then `finish` with the one that is the area. Comparisons of a line
/// with an edge use up `steps`; with none left the answers mean nothing.
class SvgRegion {
 public:
  using Part = std::uint32_t;
  static constexpr std::size_t kMostEdges = 200'000;

  /// The inside of closed lines (open ones are closed), nonzero or even-odd (SVG 2, 13.4.2).
  Part add_shape(const SvgLines& lines, bool even_odd);
  /// What lies in any of `parts`; nothing if there are none.
  Part add_any(std::vector<Part> parts);
  /// What lies in all of `parts`; everything if there are none.
  Part add_all(std::vector<Part> parts);
  /// Another finished region as a part of this one.
  Part add_region(const SvgRegion& other);
  void finish(Part area);

  [[nodiscard]] std::size_t edges() const { return edges_.size(); }
  [[nodiscard]] bool contains(const PagePoint& p, std::size_t& steps) const;
  /// Whether a corner of `other` lies in this region.
  [[nodiscard]] bool contains_corner_of(const SvgRegion& other, std::size_t& steps) const;

  /// Appends the parts of `line` inside, its border included, to `out`. A closed line that is cut
  /// open goes on through its seam. Returns whether the line lost something.
  bool cut(std::span<const PagePoint> line, std::size_t& steps, SvgLines& out) const;

  /// The border of the region as closed lines.
  [[nodiscard]] SvgLines border(std::size_t& steps) const;

 private:
  struct Edge {
    PagePoint a, b;
    std::uint32_t shape{};
  };
  struct Node {
    enum class Kind : std::uint8_t { NonZero, EvenOdd, Any, All } kind{};
    std::uint32_t shape{};
    std::vector<Part> parts;
  };
  struct Band {
    std::size_t first{}, last{};
  };
  [[nodiscard]] Band bands_of(double y0, double y1) const;
  [[nodiscard]] bool holds(Part part) const;
  /// Where, from 0 to 1, edges meet the line from `a` to `b`; ascending, with 0 and 1.
  void meet(const PagePoint& a, const PagePoint& b, std::size_t& steps) const;

  std::vector<Edge> edges_;
  std::vector<Node> nodes_;
  std::uint32_t shapes_{};
  Part area_{};
  double least_y_{}, band_height_{1.0};
  double same_mm_{};
  std::vector<std::vector<std::uint32_t>> bands_;  ///< edges by their height
  mutable std::vector<int> windings_;              ///< of each shape around one point
  mutable std::vector<double> places_;
};

}  // namespace popcut
