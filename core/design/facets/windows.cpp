// SPDX-License-Identifier: MIT
#include "core/design/facets/windows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/disjoint_sets.hpp"

namespace popcut {
namespace {

constexpr double kLeastArea_mm2 = 4.0;
// Between two points of the picture what is seen jumps where it goes back by more than this, and
// more steeply than 72 degrees.
constexpr double kLeastJump_mm = 1.0, kSteep = 3.0;

/// A stretch of a strip that is to be cut out.
struct WindowStretch {
  int strip{}, begin{}, end{};
};

class WindowCutter {
 public:
  WindowCutter(LabelImage& image, const FacetPlanes& planes, const SeenTarget& target,
               double deeper_mm, double min_panel_mm, double min_side_mm)
      : image_(image),
        planes_(planes),
        target_(target),
        deeper_mm_(deeper_mm),
        least_area_mm2_(std::max(kLeastArea_mm2, min_side_mm * min_side_mm)) {
    least_ = std::max(1, static_cast<int>(std::ceil(min_panel_mm / grid().step_mm - 1e-9)));
    ring_ = std::max(1, static_cast<int>(std::ceil(min_panel_mm / grid().strip_mm - 1e-9)));
    slit_.assign(static_cast<std::size_t>(grid().strips) * static_cast<std::size_t>(grid().columns),
                 0);
  }

  std::size_t run() {
    std::vector<WindowStretch> all;
    for (int s = ring_; s + ring_ < grid().strips; ++s) find(s, all);
    // Windows are stretches that touch along a line between strips.
    DisjointSets sets(all.size());
    for (std::uint32_t a = 0; a < all.size(); ++a)
      for (std::uint32_t b = a + 1; b < all.size() && all[b].strip <= all[a].strip + 1; ++b)
        if (all[b].strip == all[a].strip + 1 && meet(all[a], all[b])) sets.join(a, b);
    std::vector<std::uint32_t> window;
    const std::size_t count = sets.number(window);
    std::size_t cut = 0;
    for (std::uint32_t w = 0; w < count; ++w) {
      std::vector<WindowStretch> parts;
      for (std::uint32_t k = 0; k < all.size(); ++k)
        if (window[k] == w) parts.push_back(all[k]);
      if (!is_sound(parts) || !has_edges(parts)) continue;
      const Label label = label_at(parts.front().strip, parts.front().begin);
      fill(parts, kNoLabel);
      open(parts.front(), true);
      if (is_whole(parts.front())) {
        ++cut;
      } else {
        open(parts.front(), false);
        fill(parts, label);
      }
    }
    return cut;
  }

 private:
  [[nodiscard]] const FacetGrid& grid() const { return image_.grid; }

  /// Points of the picture in cells.
  struct Points {
    std::int64_t row{}, row_end{}, column{}, column_end{};
  };
  [[nodiscard]] Points points_of(int s, int column) const {
    const SheetRaster& raster = target_.raster;
    const auto along = static_cast<std::int64_t>(raster.rows) / grid().strips;
    const double from = grid().across(column) * grid().step_mm;
    const std::int64_t first = std::llround((from - raster.from_mm) / raster.column_mm);
    return {s * along, (s + 1) * along, first,
            first + std::llround(grid().step_mm / raster.column_mm)};
  }
  [[nodiscard]] bool is_on_picture(const Points& points) const {
    return points.row >= 0 && points.row_end <= static_cast<std::int64_t>(target_.raster.rows) &&
           points.column >= 0 &&
           points.column_end <= static_cast<std::int64_t>(target_.raster.columns);
  }

  /// How far the target is behind a plane at a point, mm.
  [[nodiscard]] double behind_at(std::int64_t row, std::int64_t column,
                                 const FacetPlane& plane) const {
    const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(column);
    return plane.offset * grid().step_mm -
           (plane.upright ? target_.x_mm(r, c) : target_.z_mm(r, c));
  }

  /// The same of a cell, the least of its points.
  [[nodiscard]] double behind(int s, int column, const FacetPlane& plane) const {
    const Points points = points_of(s, column);
    if (!is_on_picture(points)) return 0.0;
    double least = 1e9;
    for (std::int64_t r = points.row; r < points.row_end; ++r)
      for (std::int64_t c = points.column; c < points.column_end; ++c)
        least = std::min(least, behind_at(r, c, plane));
    return least;
  }

  /// What the border between two cells says of a window in the first one.
  enum class Border { Open, Edge, Slope };
  [[nodiscard]] Border border_between(int s, int column, int other_s, int other_column,
                                      const FacetPlane& plane) const {
    const Points in = points_of(s, column), out = points_of(other_s, other_column);
    // The paper around a window may be all that covers what is behind: it begins farther out.
    if (!is_on_picture(in) || !is_on_picture(out) ||
        behind(other_s, other_column, plane) > deeper_mm_)
      return Border::Open;
    const bool along = s != other_s;
    const std::int64_t row = std::min(in.row, out.row), row_end = std::max(in.row_end, out.row_end),
                       first = std::min(in.column, out.column),
                       last = std::max(in.column_end, out.column_end);
    const double jump_mm = std::max(
        kLeastJump_mm, kSteep * (along ? target_.raster.row_mm : target_.raster.column_mm));
    for (std::int64_t r = row; r < row_end - (along ? 1 : 0); ++r)
      for (std::int64_t c = first; c < last - (along ? 0 : 1); ++c)
        if (std::abs(behind_at(r + (along ? 1 : 0), c + (along ? 0 : 1), plane) -
                     behind_at(r, c, plane)) > jump_mm)
          return Border::Edge;
    return Border::Slope;
  }

  /// Whether what is seen jumps back along most of a window's border. Else the shape only curves
  /// away from its patch, and shows more as paper than as a hole.
  [[nodiscard]] bool has_edges(const std::vector<WindowStretch>& parts) const {
    const FacetPlane& plane = planes_[label_at(parts.front().strip, parts.front().begin)];
    const auto is_inside = [&](int s, int column) {
      return std::any_of(parts.begin(), parts.end(), [&](const WindowStretch& part) {
        return part.strip == s && column >= part.begin && column < part.end;
      });
    };
    double edge_mm = 0.0, slope_mm = 0.0;
    const auto look = [&](int s, int column, int other_s, int other_column) {
      if (is_inside(other_s, other_column)) return;
      const double length_mm = s == other_s ? grid().strip_mm : grid().step_mm;
      const Border border = border_between(s, column, other_s, other_column, plane);
      if (border == Border::Edge) edge_mm += length_mm;
      if (border == Border::Slope) slope_mm += length_mm;
    };
    for (const WindowStretch& part : parts) {
      look(part.strip, part.begin, part.strip, part.begin - 1);
      look(part.strip, part.end - 1, part.strip, part.end);
      for (int i = part.begin; i < part.end; ++i)
        for (const int beside : {part.strip - 1, part.strip + 1}) look(part.strip, i, beside, i);
    }
    return edge_mm >= slope_mm;
  }

  /// Stretches of a strip that may be cut out.
  void find(int s, std::vector<WindowStretch>& out) const {
    const auto strip = image_.strip(s);
    for (int i = 0; i < grid().columns;) {
      const int begin = i;
      while (i < grid().columns && is_free(s, i) &&
             strip[static_cast<std::size_t>(i)] == strip[static_cast<std::size_t>(begin)])
        ++i;
      if (i - begin >= least_) out.push_back({s, begin, i});
      if (i == begin) ++i;
    }
  }

  /// Whether a cell hides what is farther back, with its own plane all around it.
  [[nodiscard]] bool is_free(int s, int column) const {
    const Label label = image_.strip(s)[static_cast<std::size_t>(column)];
    if (label == kNoLabel || label == kWallLabel || label == kGroundLabel) return false;
    if (planes_.is_of_kite(label) || planes_.carries_roof(label)) return false;
    if (column < least_ || column + least_ >= grid().columns) return false;
    for (int k = s - ring_; k <= s + ring_; ++k)
      for (int i = column - least_; i <= column + least_; ++i)
        if (image_.strip(k)[static_cast<std::size_t>(i)] != label) return false;
    return behind(s, column, planes_[label]) > deeper_mm_;
  }

  [[nodiscard]] static bool meet(const WindowStretch& a, const WindowStretch& b) {
    return a.begin < b.end && b.begin < a.end;
  }

  /// Wide enough to be cut, and of a form that one slit opens: it begins in one strip only.
  [[nodiscard]] bool is_sound(const std::vector<WindowStretch>& parts) const {
    double area = 0.0;
    int begins = 0;
    for (const WindowStretch& part : parts) {
      area += (part.end - part.begin) * grid().step_mm * grid().strip_mm;
      bool has_before = false, has_twin = false;
      for (const WindowStretch& other : parts) {
        has_before = has_before || (other.strip == part.strip - 1 && meet(other, part));
        has_twin = has_twin || (other.strip == part.strip && other.begin != part.begin);
      }
      if (has_twin) return false;
      begins += has_before ? 0 : 1;
    }
    if (area < least_area_mm2_ || begins != 1) return false;
    return slit_end(parts.front()) > 0;
  }

  [[nodiscard]] Label label_at(int s, int column) const {
    return image_.strip(s)[static_cast<std::size_t>(column)];
  }

  void fill(const std::vector<WindowStretch>& parts, Label label) {
    for (const WindowStretch& part : parts) {
      const auto strip = image_.strip(part.strip);
      std::fill(strip.begin() + part.begin, strip.begin() + part.end, label);
    }
  }

  /// The column at which the slit of a window ends, which goes up from it between its first strip
  /// and the one before: where its patch does in that strip, or at a window above, which has a slit
  /// of its own.
  [[nodiscard]] int slit_end(const WindowStretch& first) const {
    const Label label = label_at(first.strip, first.begin - 1);
    int i = first.begin;
    while (i > 0 && label_at(first.strip, i - 1) == label) --i;
    return i;
  }

  /// Marks the slit of a window, or takes the marks away.
  void open(const WindowStretch& first, bool slit) {
    for (int i = slit_end(first); i < first.begin; ++i) slit_[cell(first.strip, i)] = slit ? 1 : 0;
  }

  [[nodiscard]] std::size_t cell(int s, int column) const {
    return static_cast<std::size_t>(s) * static_cast<std::size_t>(grid().columns) +
           static_cast<std::size_t>(column);
  }

  /// Whether the patch on both sides of a window's slit is one piece around it: a slit from window
  /// to window parts the paper between them.
  [[nodiscard]] bool is_whole(const WindowStretch& first) const {
    const int column = first.begin - 1;
    const Label label = label_at(first.strip, column);
    std::vector<std::uint8_t> reached(slit_.size(), 0);
    std::vector<std::pair<int, int>> work;
    const auto reach = [&](int s, int i) {
      if (s < 0 || i < 0 || s >= grid().strips || i >= grid().columns) return;
      if (label_at(s, i) != label || std::exchange(reached[cell(s, i)], std::uint8_t{1}) != 0)
        return;
      work.emplace_back(s, i);
    };
    reach(first.strip, column);
    while (!work.empty()) {
      const auto [s, i] = work.back();
      work.pop_back();
      reach(s, i - 1), reach(s, i + 1);
      if (slit_[cell(s, i)] == 0) reach(s - 1, i);
      if (s + 1 < grid().strips && slit_[cell(s + 1, i)] == 0) reach(s + 1, i);
    }
    return reached[cell(first.strip - 1, column)] != 0;
  }

  LabelImage& image_;
  const FacetPlanes& planes_;
  const SeenTarget& target_;
  double deeper_mm_, least_area_mm2_;
  int least_{}, ring_{};
  std::vector<std::uint8_t> slit_;  ///< of each cell, whether a slit parts it from the strip before
};

}  // namespace

std::size_t cut_windows(LabelImage& image, const FacetPlanes& planes, const SeenTarget& target,
                        double deeper_mm, double min_panel_mm, double min_side_mm) {
  return WindowCutter(image, planes, target, deeper_mm, min_panel_mm, min_side_mm).run();
}

}  // namespace popcut
