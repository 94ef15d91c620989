// SPDX-License-Identifier: MIT
#include "core/geometry/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace popcut {
namespace {

constexpr double kSliver = 1e-12;  // of the polygon's size squared

/// Twice the signed area of the triangle a, b, c.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

Eigen::AlignedBox2d box_of(std::span<const Vec2> points, std::span<const std::uint32_t> polygon) {
  Eigen::AlignedBox2d box;
  for (const std::uint32_t i : polygon) box.extend(points[i]);
  return box;
}

/// What is left of a polygon while its ears are clipped. Corners that can lie in the way of an ear
/// (reflex or flat ones) wait in about as many cells of a grid as it has corners.
class Ring {
 public:
  Ring(std::span<const Vec2> points, std::span<const std::uint32_t> polygon)
      : points_(points), polygon_(polygon), left_(polygon.size()) {
    const auto n = static_cast<std::uint32_t>(polygon.size());
    prev_.resize(n);
    next_.resize(n);
    blunt_.assign(n, 0);
    for (std::uint32_t i = 0; i < n; ++i) {
      prev_[i] = (i + n - 1) % n;
      next_[i] = (i + 1) % n;
    }
    const Eigen::AlignedBox2d box = box_of(points, polygon);
    const Vec2 size = box.sizes();
    low_ = box.min();
    // Cells as square as the polygon allows; one row for what has no height.
    const double longer = std::max(size[0], size[1]), shorter = std::min(size[0], size[1]);
    const double rows =
        longer > 0 ? std::clamp(std::sqrt(n * (shorter / longer)), 1.0, static_cast<double>(n))
                   : 1.0;
    const Eigen::Index along = size[1] > size[0] ? 1 : 0;
    for (const Eigen::Index axis : {Eigen::Index{0}, Eigen::Index{1}}) {
      const double cells = axis == along ? std::ceil(n / rows) : std::ceil(rows);
      last_cell_[static_cast<std::size_t>(axis)] = static_cast<std::size_t>(cells);
      per_mm_[axis] = size[axis] > 0 ? cells / size[axis] : 0;
    }
    sliver_ = kSliver * dot(size, size);
    bucket_.resize((last_cell_[0] + 1) * (last_cell_[1] + 1));
    for (std::uint32_t i = 0; i < n; ++i) mark(i);
  }

  /// Clips ears until two corners are left; the triangles go to `triangles`.
  /// @return twice the area of the triangles
  double clip_all(std::vector<Triangle>& triangles) {
    double covered = 0;
    std::size_t waited = 0;
    for (std::uint32_t i = 0; left_ > 2;) {
      if (!is_ear(i)) {
        i = next_[i];
        if (++waited <= left_) continue;
        if (loose_) break;
        loose_ = sliver_ == 0;  // no ear but slivers, or one with a corner on its rim: better
        sliver_ = 0;            // those than none
        waited = 0;
        continue;
      }
      if (const double twice = turn_at(i); twice > 0) {
        triangles.push_back({polygon_[prev_[i]], polygon_[i], polygon_[next_[i]]});
        covered += twice;
      }
      clip(i);
      i = next_[next_[i]];  // leave the neighbour: fans make slivers
      waited = 0;
    }
    return covered;
  }

 private:
  [[nodiscard]] const Vec2& at(std::uint32_t i) const { return points_[polygon_[i]]; }
  [[nodiscard]] double turn_at(std::uint32_t i) const {
    return turn(at(prev_[i]), at(i), at(next_[i]));
  }
  /// The cell of a coordinate along an axis.
  [[nodiscard]] std::size_t cell(const Vec2& p, Eigen::Index axis) const {
    const double at = std::max(0.0, (p[axis] - low_[axis]) * per_mm_[axis]);
    return std::min(static_cast<std::size_t>(at), last_cell_[static_cast<std::size_t>(axis)]);
  }
  [[nodiscard]] std::vector<std::uint32_t>& bucket(std::size_t x, std::size_t y) {
    return bucket_[y * (last_cell_[0] + 1) + x];
  }
  void mark(std::uint32_t i) {
    const bool blunt = turn_at(i) <= sliver_;
    if (blunt && blunt_[i] == 0) bucket(cell(at(i), 0), cell(at(i), 1)).push_back(i);
    blunt_[i] = blunt ? 1 : 0;
  }

  /// True when the corner is convex and no other corner lies in its triangle or, unless `loose_`,
  /// on its rim.
  [[nodiscard]] bool is_ear(std::uint32_t i) {
    const Vec2 &a = at(prev_[i]), &b = at(i), &c = at(next_[i]);
    const double twice = turn(a, b, c);
    if (loose_ && twice == 0) return true;  // a notch without width
    if (!(twice > sliver_)) return false;
    const double least = loose_ ? std::numeric_limits<double>::denorm_min() : -sliver_;
    const auto in_way = [&](std::uint32_t k) {
      const Vec2& p = at(k);
      if (k == prev_[i] || k == i || k == next_[i] || p == a || p == b || p == c) return false;
      return turn(a, b, p) >= least && turn(b, c, p) >= least && turn(c, a, p) >= least;
    };
    const auto [left, right] = std::minmax({cell(a, 0), cell(b, 0), cell(c, 0)});
    const auto [low, high] = std::minmax({cell(a, 1), cell(b, 1), cell(c, 1)});
    for (std::size_t y = low; y <= high; ++y)
      for (std::size_t x = left; x <= right; ++x) {
        auto& waiting = bucket(x, y);
        if (waiting.empty()) continue;
        std::erase_if(waiting, [&](std::uint32_t k) { return blunt_[k] == 0; });
        if (std::any_of(waiting.begin(), waiting.end(), in_way)) return false;
      }
    return true;
  }

  void clip(std::uint32_t i) {
    next_[prev_[i]] = next_[i];
    prev_[next_[i]] = prev_[i];
    blunt_[i] = 0;
    --left_;
    mark(prev_[i]);
    mark(next_[i]);
  }

  std::span<const Vec2> points_;
  std::span<const std::uint32_t> polygon_;
  std::vector<std::uint32_t> prev_, next_;
  std::vector<std::uint8_t> blunt_;
  std::vector<std::vector<std::uint32_t>> bucket_;
  std::size_t left_{};
  Vec2 low_, per_mm_;
  std::array<std::size_t, 2> last_cell_{};
  double sliver_{};  ///< twice the area, mm^2, of what counts as none
  bool loose_{false};
};

}  // namespace

double twice_area(std::span<const Vec2> points, std::span<const std::uint32_t> polygon) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
    twice += turn(points[polygon[0]], points[polygon[k]], points[polygon[k + 1]]);
  return twice;
}

std::vector<std::uint32_t> turning_corners(std::span<const Vec2> points,
                                           std::span<const std::uint32_t> polygon) {
  const double sliver = kSliver * box_of(points, polygon).diagonal().norm();
  const auto turns = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const Vec2 &a = points[i], &b = points[j], &c = points[k];
    const double longest = std::sqrt(std::max((b - a).squaredNorm(), (c - b).squaredNorm()));
    return std::abs(turn(a, b, c)) > sliver * longest;
  };
  // A corner that goes may make the one before it superfluous too: hence the stack.
  std::vector<std::uint32_t> kept;
  for (const std::uint32_t i : polygon) {
    while (!kept.empty() && (points[kept.back()] == points[i] ||
                             (kept.size() >= 2 && !turns(kept[kept.size() - 2], kept.back(), i))))
      kept.pop_back();
    kept.push_back(i);
  }
  // Where the ring closes, the same from both ends.
  std::size_t first = 0;
  for (bool changed = true; changed && kept.size() - first >= 3;) {
    changed = true;
    if (!turns(kept[kept.size() - 2], kept.back(), kept[first])) {
      kept.pop_back();
    } else if (!turns(kept.back(), kept[first], kept[first + 1])) {
      ++first;
    } else {
      changed = false;
    }
  }
  kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(first));
  return kept;
}

bool triangulate(std::span<const Vec2> points, std::span<const std::uint32_t> polygon,
                 std::vector<Triangle>& triangles) {
  const std::vector<std::uint32_t> corners = turning_corners(points, polygon);
  if (corners.size() < 3) return false;
  const double whole = twice_area(points, polygon);
  const double covered = Ring(points, corners).clip_all(triangles);
  return std::abs(covered - whole) <= 1e-9 * std::abs(whole);
}

double common_area(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  // Clips `a` by the three sides of `b`: a triangle gains at most one corner a side.
  std::array<Vec2, 6> shape{a[0], a[1], a[2]};
  std::size_t count = 3;
  for (std::size_t side = 0; side < 3 && count > 0; ++side) {
    const Vec2 from = b[side];
    const Vec2 way = b[(side + 1) % 3] - from;
    std::array<Vec2, 6> kept{};
    std::size_t size = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec2 p = shape[k];
      const Vec2 q = shape[(k + 1) % count];
      const double dp = cross(way, p - from);
      const double dq = cross(way, q - from);
      if (dp >= 0.0 && size < kept.size()) kept[size++] = p;
      if ((dp < 0.0) != (dq < 0.0) && size < kept.size())
        kept[size++] = p + (dp / (dp - dq)) * (q - p);
    }
    shape = kept;
    count = size;
  }
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < count; ++k)
    twice += cross(shape[k] - shape[0], shape[k + 1] - shape[0]);
  return 0.5 * std::abs(twice);
}

}  // namespace popcut
