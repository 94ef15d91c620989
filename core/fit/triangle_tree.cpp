// SPDX-License-Identifier: MIT
#include "core/fit/triangle_tree.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace popcut {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Every third bit of the lower 10 bits.
std::uint32_t spread_bits(std::uint32_t bits) {
  bits = (bits | (bits << 16)) & 0x030000FFu;
  bits = (bits | (bits << 8)) & 0x0300F00Fu;
  bits = (bits | (bits << 4)) & 0x030C30C3u;
  return (bits | (bits << 2)) & 0x09249249u;
}

/// Numbers of the triangles, those with near middles near each other: Morton order of 1024 cells
/// along the longest side, by a radix sort.
std::vector<std::uint32_t> morton_order(const TriangleSoup& soup) {
  const std::size_t count = soup.size();
  std::array<double, 3> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (std::size_t k = 0; k < soup.corners.size(); k += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], soup.corners[k + i]);
      high[i] = std::max(high[i], soup.corners[k + i]);
    }
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, high[i] - low[i]);
  const double cells = longest > 0.0 ? 1023.0 / longest : 0.0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keys(count), sorted(count);
  for (std::size_t t = 0; t < count; ++t) {
    const double* c = soup.corners.data() + 9 * t;
    std::uint32_t key = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double middle = (c[i] + c[i + 3] + c[i + 6]) / 3.0 - low[i];
      key |= spread_bits(static_cast<std::uint32_t>(middle * cells)) << i;
    }
    keys[t] = {key, static_cast<std::uint32_t>(t)};
  }
  for (const unsigned shift : {0u, 10u, 20u}) {
    std::array<std::uint32_t, 1025> first{};
    for (const auto& [key, t] : keys) ++first[((key >> shift) & 1023u) + 1];
    for (std::size_t k = 0; k < 1024; ++k) first[k + 1] += first[k];
    for (const auto& one : keys) sorted[first[(one.first >> shift) & 1023u]++] = one;
    keys.swap(sorted);
  }
  std::vector<std::uint32_t> order(count);
  for (std::size_t t = 0; t < count; ++t) order[t] = keys[t].second;
  return order;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleSoup& soup) {
  const std::vector<std::uint32_t> order = morton_order(soup);
  corners_.resize(soup.corners.size());
  leaves_ = 1;
  while (leaves_ * kLeaf < order.size()) leaves_ *= 2;
  boxes_.assign(2 * leaves_, Box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}});
  for (std::size_t n = 0; n < order.size(); ++n) {
    const double* from = soup.corners.data() + 9 * static_cast<std::size_t>(order[n]);
    std::copy(from, from + 9, corners_.data() + 9 * n);
    Box& box = boxes_[leaves_ + n / kLeaf];
    for (std::size_t i = 0; i < 3; ++i) {
      box.low[i] = std::min({box.low[i], from[i], from[i + 3], from[i + 6]});
      box.high[i] = std::max({box.high[i], from[i], from[i + 3], from[i + 6]});
    }
  }
  for (std::size_t node = leaves_ - 1; node > 0; --node)
    for (std::size_t i = 0; i < 3; ++i) {
      const Box &left = boxes_[2 * node], &right = boxes_[2 * node + 1];
      boxes_[node].low[i] = std::min(left.low[i], right.low[i]);
      boxes_[node].high[i] = std::max(left.high[i], right.high[i]);
    }
}

double TriangleTree::squared_to(const Box& box, const Vec3& p) {
  double squared = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double at = p.data()[i];
    const double below = box.low[i] - at, above = at - box.high[i];
    const double off = below > above ? below : above;
    if (off > 0.0) squared += off * off;
  }
  return squared;
}

// Ericson, Real-Time Collision Detection (2005), section 5.1.5: the point is in the region of a
// corner, of an edge, or of the inside.
void TriangleTree::look_at(std::uint32_t place, const Vec3& p, Nearest& best) const {
  const double* t = corners_.data() + 9 * static_cast<std::size_t>(place);
  const double* q = p.data();
  double ab[3], ac[3], ap[3];
  for (std::size_t i = 0; i < 3; ++i) {
    ab[i] = t[3 + i] - t[i];
    ac[i] = t[6 + i] - t[i];
    ap[i] = q[i] - t[i];
  }
  const auto dot3 = [](const double* a, const double* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  const double bb = dot3(ab, ab), bc = dot3(ab, ac), cc = dot3(ac, ac);
  const double d1 = dot3(ab, ap), d2 = dot3(ac, ap);
  const double d3 = d1 - bb, d4 = d2 - bc, d5 = d1 - bc, d6 = d2 - cc;
  double v = 0.0, w = 0.0;  // the point is a + v ab + w ac
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (d1 <= 0.0 && d2 <= 0.0) {
    // corner a
  } else if (d3 >= 0.0 && d4 <= d3) {
    v = 1.0;
  } else if (d6 >= 0.0 && d5 <= d6) {
    w = 1.0;
  } else if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    v = d1 / (d1 - d3);
  } else if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    w = d2 / (d2 - d6);
  } else if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    v = 1.0 - w;
  } else {
    const double all = va + vb + vc;
    v = vb / all, w = vc / all;
  }
  double point[3], squared = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    point[i] = t[i] + v * ab[i] + w * ac[i];
    squared += (q[i] - point[i]) * (q[i] - point[i]);
  }
  if (squared < best.squared) best = {squared, place, Vec3(point)};
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& p, std::uint32_t hint) const {
  Nearest best;
  if (size() == 0) return best;
  if (hint < size()) look_at(hint, p, best);
  struct Ahead {
    std::size_t node;
    double squared;
  };
  std::array<Ahead, 64> stack;  // one entry a level
  std::size_t depth = 0;
  stack[depth++] = {1, squared_to(boxes_[1], p)};
  while (depth > 0) {
    auto [node, squared] = stack[--depth];
    if (squared >= best.squared) continue;
    while (node < leaves_) {
      const double left = squared_to(boxes_[2 * node], p);
      const double right = squared_to(boxes_[2 * node + 1], p);
      const bool left_first = left <= right;
      const double far = left_first ? right : left;
      if (far < best.squared) stack[depth++] = {2 * node + (left_first ? 1u : 0u), far};
      squared = left_first ? left : right;
      node = 2 * node + (left_first ? 0u : 1u);
      if (squared >= best.squared) break;
    }
    if (node < leaves_ || squared >= best.squared) continue;
    const std::size_t from = (node - leaves_) * kLeaf, to = std::min(from + kLeaf, size());
    for (std::size_t k = from; k < to; ++k) look_at(static_cast<std::uint32_t>(k), p, best);
  }
  return best;
}

bool TriangleTree::beyond(std::uint32_t place, const Vec3& p) const {
  const double* t = corners_.data() + 9 * static_cast<std::size_t>(place);
  std::array<std::array<double, 2>, 2> end{};  // of the triangle's cut by the plane: (x, z)
  std::size_t found = 0;
  for (std::size_t k = 0; k < 3 && found < 2; ++k) {
    const double *a = t + 3 * k, *b = t + 3 * ((k + 1) % 3);
    const double to_a = a[1] - p[1], to_b = b[1] - p[1];
    if ((to_a < 0.0) == (to_b < 0.0)) continue;
    const double share = to_a / (to_a - to_b);
    end[found++] = {a[0] + share * (b[0] - a[0]), a[2] + share * (b[2] - a[2])};
  }
  if (found < 2) return false;
  double from = 0.0, to = 1.0;  // the stretch of the cut that lies beyond in x and in z
  for (std::size_t i = 0; i < 2; ++i) {
    const double begin = end[0][i] - (i == 0 ? p[0] : p[2]);
    const double finish = end[1][i] - (i == 0 ? p[0] : p[2]);
    if (begin <= 0.0 && finish <= 0.0) return false;
    if (begin <= 0.0) from = std::max(from, begin / (begin - finish));
    if (finish <= 0.0) to = std::min(to, begin / (begin - finish));
  }
  return from < to;
}

bool TriangleTree::any_beyond(const Vec3& p) const {
  if (size() == 0) return false;
  std::array<std::size_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 1;
  while (depth > 0) {
    const std::size_t node = stack[--depth];
    const Box& box = boxes_[node];
    if (!(box.low[1] <= p[1] && p[1] <= box.high[1] && box.high[0] > p[0] && box.high[2] > p[2]))
      continue;
    if (node < leaves_) {
      stack[depth++] = 2 * node;
      stack[depth++] = 2 * node + 1;
      continue;
    }
    const std::size_t from = (node - leaves_) * kLeaf, to = std::min(from + kLeaf, size());
    for (std::size_t k = from; k < to; ++k)
      if (beyond(static_cast<std::uint32_t>(k), p)) return true;
  }
  return false;
}

}  // namespace popcut
