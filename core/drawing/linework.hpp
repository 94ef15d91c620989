// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/warning.hpp"

namespace popcut {

struct Pattern;

/// One line of a drawing: points `first .. first + count` of its `LineWork`. A closed line repeats
/// its first point at the end.
struct DrawnLine {
  PenOperation operation;
  std::uint32_t first{};
  std::uint32_t count{};
};

/// How lines look of which nobody said what they are for, or folds to which side.
struct DrawnLook {
  std::string layer;   ///< its name, which says no more; empty: none
  std::string colour;  ///< as `parse_colour_uses` reads it
  friend bool operator==(const DrawnLook&, const DrawnLook&) = default;
};

/// A drawing as flat polylines in page mm (x right, y down). Folds are not dashed yet.
struct LineWork {
  std::string name;
  std::vector<PagePoint> points;
  std::vector<DrawnLine> lines;
  std::vector<Warning> warnings;
  bool has_page{false};              ///< the drawing's place on its page matters (SVG)
  bool dashed{false};                ///< its folds are dashes already: cut them as they are
  std::vector<std::string> looks{};  ///< colours and layers of its lines; only if pens were named
  /// Of lines without a meaning, if a reader was asked for them: the pen of such a line is the
  /// number of its look, from 1. The last one stands for all further ones.
  std::vector<DrawnLook> unsaid{};
  std::string asks{};  ///< "layers" or "colors": the option that must say what those are for

  [[nodiscard]] std::span<const PagePoint> points_of(const DrawnLine& line) const {
    return std::span(points).subspan(line.first, line.count);
  }
  /// What is known of the drawing besides its lines.
  [[nodiscard]] LineWork without_lines() const {
    return {name, {}, {}, warnings, has_page, dashed};
  }
  /// Appends a line. Ignores lines of fewer than two points.
  void append(PenOperation operation, std::span<const PagePoint> line);
};

inline constexpr std::size_t kMaxDrawnPoints = 20'000'000;  ///< of one drawing
inline constexpr double kMaxCoordinate = 100'000.0;         ///< mm; coordinates go up to 100 m

/// The bounding box of all lines, mm; empty if there are none.
[[nodiscard]] Box bounds(const LineWork& work);
/// FoldMountain and FoldValley.
[[nodiscard]] bool is_fold(Operation operation);
/// Cut and Outline: lines that go through the paper along their whole length.
[[nodiscard]] bool is_cut(Operation operation);

/// Of two lines at one place the stronger one stays: outline, cut, mountain fold, valley fold,
/// score, draw.
[[nodiscard]] int strength(Operation operation);

/// The lines of a pattern on its page: x = v, y = u. This is a rotation as seen from the pop-up
/// side (docs/geometry.md, section 2). Mountain, Valley, Slit and Outline keep their meaning.
[[nodiscard]] LineWork linework_from_pattern(const Pattern& pattern);

/// "draw", "score", "fold-mountain", "fold-valley", "cut", "outline": names of layers, also in
/// reports.
[[nodiscard]] const char* operation_name(Operation operation);

/// Appends the parts of `line` inside `area`, cut exactly at its border. A closed line that is cut
/// open continues through its seam. `run` is a reusable buffer.
void clip_line(std::span<const PagePoint> line, PenOperation operation, const Box& area,
               std::vector<PagePoint>& run, LineWork& out);

}  // namespace popcut
