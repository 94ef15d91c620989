// SPDX-License-Identifier: MIT
#include "core/design/target/mesh_slicer.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {
namespace {

/// Leaves of the ends those that no other end meets: first those that agree to the last bit, as
/// they do in a mesh whose triangles share corners, then those that agree within `near_mm`.
void keep_unmatched(std::vector<SectionPoint>& ends, double near_mm) {
  std::sort(ends.begin(), ends.end(), [](const SectionPoint& a, const SectionPoint& b) {
    return a.x != b.x ? a.x < b.x : a.z < b.z;
  });
  std::vector<SectionPoint> left;
  for (const SectionPoint& p : ends) {
    if (!left.empty() && left.back().x == p.x && left.back().z == p.z)
      left.pop_back();
    else
      left.push_back(p);
  }
  ends.clear();
  constexpr std::size_t kLook = 64;
  std::vector<bool> taken(left.size(), false);
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (taken[i]) continue;
    bool met = false;
    for (std::size_t j = i + 1; j < left.size() && j < i + kLook && !met; ++j) {
      if (left[j].x > left[i].x + near_mm) break;
      if (taken[j] || std::abs(left[j].z - left[i].z) > near_mm) continue;
      taken[j] = met = true;
    }
    if (!met) ends.push_back(left[i]);
  }
}

}  // namespace

MeshSlicer::MeshSlicer(TriangleMesh mesh) : mesh_(std::move(mesh)), box_(box_of(mesh_)) {
  const std::size_t n = mesh_.size();
  low_ = box_.low[1], high_ = box_.high[1];
  struct Key {
    float low{};
    std::uint32_t triangle{};
  };
  std::vector<Key> keys(n);
  for (std::size_t k = 0; k < n; ++k)
    keys[k] = {std::min({coordinate(k, 0, 1), coordinate(k, 1, 1), coordinate(k, 2, 1)}),
               static_cast<std::uint32_t>(k)};
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return a.low != b.low ? a.low < b.low : a.triangle < b.triangle;
  });
  order_.resize(n), smallest_.resize(n);
  largest_.emplace_back(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = order_[i] = keys[i].triangle;
    smallest_[i] = keys[i].low;
    largest_[0][i] = std::max({coordinate(k, 0, 1), coordinate(k, 1, 1), coordinate(k, 2, 1)});
  }
  while (largest_.back().size() > 1) {
    const std::vector<float>& fine = largest_.back();
    std::vector<float> coarse((fine.size() + kBranch - 1) / kBranch);
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      const auto begin = fine.begin() + static_cast<std::ptrdiff_t>(i * kBranch);
      const auto end =
          fine.begin() + static_cast<std::ptrdiff_t>(std::min(fine.size(), (i + 1) * kBranch));
      coarse[i] = *std::max_element(begin, end);
    }
    largest_.push_back(std::move(coarse));
  }
}

/// Triangles below `node` of `level` that begin below the plane (the first `begun`) and end at or
/// above it.
void MeshSlicer::collect(std::size_t level, std::size_t node, std::size_t begun, double s,
                         std::vector<std::uint32_t>& out) const {
  if (static_cast<double>(largest_[level][node]) < s) return;
  if (level == 0) {
    out.push_back(order_[node]);
    return;
  }
  std::size_t first_leaf = kBranch;
  for (std::size_t k = 1; k < level; ++k) first_leaf *= kBranch;
  const std::size_t leaves_a_child = first_leaf / kBranch;
  const std::size_t end = std::min(largest_[level - 1].size(), (node + 1) * kBranch);
  for (std::size_t child = node * kBranch; child < end && child * leaves_a_child < begun; ++child)
    collect(level - 1, child, begun, s, out);
}

SectionPoint MeshSlicer::crossing(std::size_t triangle, std::size_t below, std::size_t above,
                                  double s) const {
  const auto at = [&](std::size_t corner, std::size_t axis) {
    return static_cast<double>(coordinate(triangle, corner, axis));
  };
  const double y0 = at(below, 1), y1 = at(above, 1);
  const double share = std::clamp((s - y0) / (y1 - y0), 0.0, 1.0);
  return {at(below, 0) + share * (at(above, 0) - at(below, 0)),
          at(below, 2) + share * (at(above, 2) - at(below, 2))};
}

Section MeshSlicer::cut(double s_mm) const {
  Section section;
  const double inside = 1e-9 * (high_ - low_), touch = 1e-6 * (high_ - low_);
  double s = s_mm;
  if (s <= low_ + inside && s >= low_ - touch)
    s = std::nextafter(static_cast<float>(low_ + inside), 1e30F);
  if (s >= high_ - inside && s <= high_ + touch) s = high_;
  if (mesh_.size() == 0 || s <= low_ || s > high_) return section;
  const auto begun = static_cast<std::size_t>(
      std::lower_bound(smallest_.begin(), smallest_.end(), s,
                       [](float low, double plane) { return static_cast<double>(low) < plane; }) -
      smallest_.begin());
  std::vector<std::uint32_t> met;
  collect(largest_.size() - 1, 0, begun, s, met);
  const double touch_mm = 1e-6 * std::max({box_.high[0], box_.high[2], 0.0});
  std::vector<SectionPoint> ends;
  for (const std::uint32_t triangle : met) {
    std::array<bool, 3> above{};
    int count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      above[k] = static_cast<double>(coordinate(triangle, k, 1)) >= s;
      count += above[k] ? 1 : 0;
    }
    if (count == 0 || count == 3) continue;
    // The corner that is alone on its side, and the two crossings of its edges.
    const bool single = count == 1;
    const std::size_t alone = above[0] == single ? 0 : above[1] == single ? 1 : 2;
    std::array<SectionPoint, 2> p;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::size_t other = (alone + 1 + k) % 3;
      p[k] = single ? crossing(triangle, other, alone, s) : crossing(triangle, alone, other, s);
      if (p[k].x > touch_mm && p[k].z > touch_mm) ends.push_back(p[k]);
    }
    add_clipped(section, p[0], p[1], touch_mm);
  }
  keep_unmatched(ends, touch_mm);
  section.open_ends = std::move(ends);
  return section;
}

}  // namespace popcut
