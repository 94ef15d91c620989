// SPDX-License-Identifier: MIT
#include "core/deploy/triangulate.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/deploy/pose_table.hpp"

namespace popcut {
namespace {

constexpr double kSliver = 1e-12;  // of the face's size squared

/// Twice the signed area of the triangle a, b, c on the sheet.
double turn(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// What is left of a polygon while its ears are clipped. Corners that can lie in the way of an ear
/// (reflex or flat ones) wait in buckets along the polygon's longer side.
class Ring {
 public:
  explicit Ring(std::vector<Vec3> corners) : at_(std::move(corners)), left_(at_.size()) {
    const auto n = static_cast<std::uint32_t>(at_.size());
    prev_.resize(n);
    next_.resize(n);
    blunt_.assign(n, 0);
    Vec3 low = at_[0], high = at_[0];
    for (std::uint32_t i = 0; i < n; ++i) {
      prev_[i] = (i + n - 1) % n;
      next_[i] = (i + 1) % n;
      for (std::size_t c = 0; c < 2; ++c) {
        low[c] = std::min(low[c], at_[i][c]);
        high[c] = std::max(high[c], at_[i][c]);
      }
    }
    axis_ = high[1] - low[1] > high[0] - low[0] ? 1 : 0;
    low_ = low[axis_];
    const double length = high[axis_] - low[axis_];
    per_mm_ = length > 0 ? n / length : 0;
    sliver_ = kSliver * dot(high - low, high - low);
    bucket_.resize(n + 1);
    for (std::uint32_t i = 0; i < n; ++i) mark(i);
  }

  /// Clips all ears; the triangles go to `take`. False when no ear is left to clip.
  template <typename Take>
  [[nodiscard]] bool clip_all(Take&& take) {
    std::size_t waited = 0;
    for (std::uint32_t i = 0; left_ > 3;) {
      if (!is_ear(i)) {
        i = next_[i];
        if (++waited <= left_) continue;
        if (sliver_ == 0) return false;
        sliver_ = 0;  // no ear but slivers: better those than none
        waited = 0;
        continue;
      }
      take(prev_[i], i, next_[i]);
      clip(i);
      i = next_[next_[i]];  // leave the neighbour: fans make slivers
      waited = 0;
    }
    const auto last = static_cast<std::uint32_t>(
        std::find(gone_.begin(), gone_.end(), std::uint8_t{0}) - gone_.begin());
    if (!(turn_at(last) > 0)) return false;
    take(prev_[last], last, next_[last]);
    return true;
  }

  void start() { gone_.assign(at_.size(), 0); }

 private:
  [[nodiscard]] double turn_at(std::uint32_t i) const {
    return turn(at_[prev_[i]], at_[i], at_[next_[i]]);
  }
  [[nodiscard]] std::size_t slot(const Vec3& p) const {
    return static_cast<std::size_t>(std::max(0.0, (p[axis_] - low_) * per_mm_));
  }
  void mark(std::uint32_t i) {
    const bool blunt = turn_at(i) <= sliver_;
    if (blunt && blunt_[i] == 0) bucket_[slot(at_[i])].push_back(i);
    blunt_[i] = blunt ? 1 : 0;
  }

  /// True when the corner is convex and no other corner lies in its triangle or on its rim.
  [[nodiscard]] bool is_ear(std::uint32_t i) {
    const Vec3 &a = at_[prev_[i]], &b = at_[i], &c = at_[next_[i]];
    if (!(turn(a, b, c) > sliver_)) return false;
    const auto [low, high] = std::minmax({slot(a), slot(b), slot(c)});
    for (std::size_t s = low; s <= high; ++s) {
      auto& bucket = bucket_[s];
      std::erase_if(bucket, [&](std::uint32_t k) { return blunt_[k] == 0; });
      for (const std::uint32_t k : bucket) {
        const Vec3& p = at_[k];
        if (k == prev_[i] || k == i || k == next_[i] || p == a || p == b || p == c) continue;
        const bool in =
            turn(a, b, p) >= -sliver_ && turn(b, c, p) >= -sliver_ && turn(c, a, p) >= -sliver_;
        if (in) return false;
      }
    }
    return true;
  }

  void clip(std::uint32_t i) {
    next_[prev_[i]] = next_[i];
    prev_[next_[i]] = prev_[i];
    blunt_[i] = 0;
    gone_[i] = 1;
    --left_;
    mark(prev_[i]);
    mark(next_[i]);
  }

  std::vector<Vec3> at_;
  std::vector<std::uint32_t> prev_, next_;
  std::vector<std::uint8_t> blunt_, gone_;
  std::vector<std::vector<std::uint32_t>> bucket_;
  std::size_t left_{}, axis_{};
  double low_{}, per_mm_{};
  double sliver_{};  ///< twice the area, mm^2, of what counts as none
};

/// The corners without those that do not turn: along sides, and the tips of notches without width.
std::vector<Vec3> true_corners(std::vector<Vec3> corners) {
  Vec3 low{1e300, 1e300, 0}, high{-1e300, -1e300, 0};
  for (const Vec3& p : corners) {
    for (std::size_t c = 0; c < 2; ++c) {
      low[c] = std::min(low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  }
  const double sliver = kSliver * norm(high - low);
  const auto turns = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return std::abs(turn(a, b, c)) > sliver * std::max(norm(b - a), norm(c - b));
  };
  // A corner that goes may make the one before it superfluous too: hence the stack.
  std::vector<Vec3> kept;
  for (const Vec3& p : corners) {
    while (!kept.empty() && (kept.back() == p ||
                             (kept.size() >= 2 && !turns(kept[kept.size() - 2], kept.back(), p))))
      kept.pop_back();
    kept.push_back(p);
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

double twice_area(const std::vector<Vec3>& corners) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    twice += turn(corners[0], corners[k], corners[k + 1]);
  return twice;
}

/// Appends one face. False when it is not a simple polygon.
bool add_face(std::vector<Vec3> corners, FaceTriangles& out) {
  corners = true_corners(std::move(corners));
  if (corners.size() < 3) return false;
  if (twice_area(corners) < 0) std::reverse(corners.begin(), corners.end());
  const double whole = twice_area(corners);
  const auto base = static_cast<std::uint32_t>(out.corner.size());
  double covered = 0;
  Ring ring(corners);
  ring.start();
  const bool clipped = ring.clip_all([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    covered += turn(corners[a], corners[b], corners[c]);
    out.triangle.push_back({base + a, base + b, base + c});
  });
  out.corner.insert(out.corner.end(), corners.begin(), corners.end());
  return clipped && std::abs(covered - whole) <= 1e-9 * whole;
}

}  // namespace

Result<FaceTriangles> triangulate_faces(const Pattern& pattern) {
  FaceTriangles out;
  out.first_corner.push_back(0);
  out.first_triangle.push_back(0);
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    std::vector<Vec3> corners;
    for (const std::uint32_t i : pattern.face(f))
      corners.push_back(flat_place(pattern, pattern.vertices[i]));
    if (!add_face(std::move(corners), out)) {
      return fail(ErrorKind::OutOfRange, fmt::format("faces/{}", f),
                  "is not a simple polygon with an area; a face must not cross itself");
    }
    out.first_corner.push_back(static_cast<std::uint32_t>(out.corner.size()));
    out.first_triangle.push_back(static_cast<std::uint32_t>(out.triangle.size()));
  }
  return out;
}

}  // namespace popcut
