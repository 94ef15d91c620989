// SPDX-License-Identifier: MIT
#include "core/design/slices/plane_section.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

namespace popcut {
namespace {

constexpr std::size_t kMostGaps = 2000;  ///< of one plane; their search is quadratic

bool is_before(const Vec2& a, const Vec2& b) {
  return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
}

/// Where a side of a triangle meets a plane. Both triangles of a side get the same bits.
Vec2 place_on_side(Vec3 a, Vec3 b, int axis, double at) {
  if (std::lexicographical_compare(b.data(), b.data() + 3, a.data(), a.data() + 3)) std::swap(a, b);
  const double t = (at - a[axis]) / (b[axis] - a[axis]);
  return in_plane(Vec3(a + t * (b - a)), axis);
}

struct SectionSide {
  Vec2 from, to;
};

/// Joins sides to closed lines.
class RingJoiner {
 public:
  explicit RingJoiner(std::vector<SectionSide> sides) : sides_(std::move(sides)) {
    std::sort(sides_.begin(), sides_.end(),
              [](const SectionSide& a, const SectionSide& b) { return is_before(a.from, b.from); });
    used_.assign(sides_.size(), false);
  }

  /// @return false if there are too many gaps to close
  bool run() {
    for (const SectionSide& side : sides_) length_mm += norm(Vec2(side.to - side.from));
    for (std::size_t k = 0; k < sides_.size(); ++k)
      if (!used_[k]) follow(k);
    return close_gaps();
  }

  FlatRings rings;
  std::size_t gaps{};
  double gaps_mm{}, length_mm{};

 private:
  void follow(std::size_t first) {
    std::vector<Vec2> line{sides_[first].from};
    for (std::size_t k = first;;) {
      used_[k] = true;
      const Vec2 end = sides_[k].to;
      if (end == line.front()) {
        rings.push_back(std::move(line));
        return;
      }
      line.push_back(end);
      const auto next = std::lower_bound(
          sides_.begin(), sides_.end(), end,
          [](const SectionSide& side, const Vec2& at) { return is_before(side.from, at); });
      auto n = static_cast<std::size_t>(next - sides_.begin());
      while (n < sides_.size() && sides_[n].from == end && used_[n]) ++n;
      if (n == sides_.size() || sides_[n].from != end) break;
      k = n;
    }
    open_.push_back(std::move(line));
  }

  bool close_gaps() {
    if (open_.size() > kMostGaps) return false;
    while (!open_.empty()) {
      std::vector<Vec2>& line = open_.back();
      std::size_t best = 0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < open_.size(); ++k)
        if (const double off = norm(Vec2(open_[k].front() - line.back())); off < nearest)
          nearest = off, best = k;
      if (nearest > 0.0) ++gaps, gaps_mm += nearest;
      if (best + 1 == open_.size()) {
        rings.push_back(std::move(line));
        open_.pop_back();
        continue;
      }
      line.insert(line.end(), open_[best].begin(), open_[best].end());
      open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return true;
  }

  std::vector<SectionSide> sides_;
  std::vector<bool> used_;
  FlatRings open_;
};

}  // namespace

Vec2 in_plane(const Vec3& p, int axis) {
  return axis == 0 ? Vec2{p.y(), p.z()} : axis == 1 ? Vec2{p.x(), p.z()} : Vec2{p.x(), p.y()};
}

Result<PlaneSections> plane_sections(const TriangleSoup& mesh, int axis,
                                     std::span<const double> at_mm, double most_open) {
  std::vector<std::vector<SectionSide>> sides(at_mm.size());
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const std::array<Vec3, 3> p{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
    auto plane = std::upper_bound(at_mm.begin(), at_mm.end(), low);
    for (; plane != at_mm.end() && *plane <= high; ++plane) {
      SectionSide side;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = p[k], &b = p[(k + 1) % 3];
        const bool is_a = a[axis] >= *plane, is_b = b[axis] >= *plane;
        if (is_a == is_b) continue;
        (is_a ? side.from : side.to) = place_on_side(a, b, axis, *plane);
      }
      if (side.from != side.to)
        sides[static_cast<std::size_t>(plane - at_mm.begin())].push_back(side);
    }
  }
  PlaneSections out;
  double length_mm = 0.0;
  bool is_closed = true;
  for (std::size_t k = 0; k < at_mm.size() && is_closed; ++k) {
    RingJoiner joiner(std::move(sides[k]));
    is_closed = joiner.run();
    out.planes.push_back(std::move(joiner.rings));
    out.gaps += joiner.gaps, out.gaps_mm += joiner.gaps_mm, length_mm += joiner.length_mm;
  }
  if (!is_closed || out.gaps_mm > most_open * length_mm)
    return fail(ErrorKind::Infeasible, "/surface",
                "has no inside: its triangles leave large gaps, or face different ways; close the "
                "mesh in a modelling program");
  return out;
}

}  // namespace popcut
