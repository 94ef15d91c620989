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

/// A stretch of a strip that is to be cut out.
struct WindowStretch {
  int strip{}, begin{}, end{};
};

class WindowCutter {
 public:
  WindowCutter(LabelImage& image, const FacetPlanes& planes, const DepthImage& target,
               double deeper_mm, double min_panel_mm)
      : image_(image), planes_(planes), target_(target), deeper_mm_(deeper_mm) {
    least_ = std::max(1, static_cast<int>(std::ceil(min_panel_mm / grid().step_mm - 1e-9)));
    ring_ = std::max(1, static_cast<int>(std::ceil(min_panel_mm / grid().strip_mm - 1e-9)));
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
      if (!is_sound(parts)) continue;
      ++cut;
      for (const WindowStretch& part : parts) {
        const auto strip = image_.strip(part.strip);
        std::fill(strip.begin() + part.begin, strip.begin() + part.end, kNoLabel);
      }
    }
    return cut;
  }

 private:
  [[nodiscard]] const FacetGrid& grid() const { return image_.grid; }

  /// How far the target is behind a cell's plane, mm, the least of its points.
  [[nodiscard]] double behind(int s, int column, const FacetPlane& plane) const {
    const SheetRaster& raster = target_.raster;
    const std::size_t along = raster.rows / static_cast<std::size_t>(grid().strips);
    const double from = grid().across(column) * grid().step_mm;
    const auto first = std::lround((from - raster.from_mm) / raster.column_mm);
    const auto across = std::lround(grid().step_mm / raster.column_mm);
    double least = 1e9;
    for (std::size_t r = 0; r < along; ++r)
      for (long c = first; c < first + across; ++c) {
        if (c < 0 || c >= static_cast<long>(raster.columns)) return 0.0;
        const std::size_t row = static_cast<std::size_t>(s) * along + r;
        const auto at = static_cast<std::size_t>(c);
        least =
            std::min(least, plane.offset * grid().step_mm -
                                (plane.upright ? target_.x_mm(row, at) : target_.z_mm(row, at)));
      }
    return least;
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
    if (column < least_ || column + least_ >= grid().columns) return false;
    for (int k = s - ring_; k <= s + ring_; ++k)
      for (int i = column - least_; i <= column + least_; ++i)
        if (image_.strip(k)[static_cast<std::size_t>(i)] != label) return false;
    return behind(s, column, planes_[label]) > deeper_mm_;
  }

  [[nodiscard]] static bool meet(const WindowStretch& a, const WindowStretch& b) {
    return a.begin < b.end && b.begin < a.end;
  }

  /// Wide enough to be cut, and of a form that one slit opens: it begins in one strip only, and no
  /// other window is on the slit's way.
  [[nodiscard]] bool is_sound(const std::vector<WindowStretch>& parts) const {
    constexpr double kLeastArea = 4.0;  // mm^2
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
    if (area < kLeastArea || begins != 1) return false;
    const WindowStretch& first = parts.front();
    const Label label = image_.strip(first.strip)[static_cast<std::size_t>(first.begin)];
    for (int i = first.begin; i > 0; --i) {  // up to where the patch ends
      const auto at = static_cast<std::size_t>(i - 1);
      const Label here = image_.strip(first.strip)[at], before = image_.strip(first.strip - 1)[at];
      if (here == kNoLabel || before == kNoLabel) return false;
      if (here != label || before != label) return true;
    }
    return false;
  }

  LabelImage& image_;
  const FacetPlanes& planes_;
  const DepthImage& target_;
  double deeper_mm_;
  int least_{}, ring_{};
};

}  // namespace

std::size_t cut_windows(LabelImage& image, const FacetPlanes& planes, const DepthImage& target,
                        double deeper_mm, double min_panel_mm) {
  return WindowCutter(image, planes, target, deeper_mm, min_panel_mm).run();
}

}  // namespace popcut
