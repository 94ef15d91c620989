// SPDX-License-Identifier: MIT
#include "core/fit/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace popcut {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Rounding of a coordinate to a float, as a share of it, and then some.
constexpr float kRounding = 2.5e-7f;

constexpr Eigen::Index lane(std::size_t k) { return static_cast<Eigen::Index>(k); }

}  // namespace

/// Halves ranges of `order_` until they are leaves.
class TriangleTree::Builder {
 public:
  Builder(const TriangleSoup& soup, TriangleTree& tree) : soup_(soup), tree_(tree) {
    order_.resize(soup.size());
    std::iota(order_.begin(), order_.end(), 0u);
    middles_.resize(order_.size());
    for (std::size_t t = 0; t < order_.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const double* c = soup.corners.data() + 9 * t + i;
        middles_[t][i] = static_cast<float>((c[0] + c[3] + c[6]) / 3.0);
        tree_.size_mm_ =
            std::max({tree_.size_mm_, static_cast<float>(std::abs(c[0])),
                      static_cast<float>(std::abs(c[3])), static_cast<float>(std::abs(c[6]))});
      }
  }

  void build() {
    if (order_.empty()) return;
    tree_.nodes_.reserve(order_.size());
    add_node({0, static_cast<std::uint32_t>(order_.size())});
    tree_.corners_.resize(soup_.corners.size());
    for (std::size_t n = 0; n < order_.size(); ++n) {
      const double* from = soup_.corners.data() + 9 * static_cast<std::size_t>(order_[n]);
      std::copy(from, from + 9, tree_.corners_.data() + 9 * n);
    }
    tree_.triangles_ = order_;
  }

 private:
  /// Each node halves at least once, so the depth is at most 32.
  std::uint32_t add_node(Range range) {
    const auto node = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    const std::uint32_t middle = halve(range);
    const std::array<Range, 2> half{{{range.from, middle}, {middle, range.to}}};
    std::size_t slot = 0;
    for (const Range& part : half) {
      const std::uint32_t quarter = part.to - part.from > kLeaf ? halve(part) : part.to;
      add_child(node, slot++, {part.from, quarter});
      add_child(node, slot++, {quarter, part.to});
    }
    return node;
  }

  void add_child(std::uint32_t node, std::size_t slot, Range range) {
    const std::uint32_t count = range.to - range.from;
    const bool is_leaf = count <= kLeaf;
    const std::uint32_t child = is_leaf ? range.from : add_node(range);
    Node& here = tree_.nodes_[node];
    here.child[slot] = child, here.is_leaf[slot] = is_leaf;
    here.count[slot] = static_cast<std::uint8_t>(is_leaf ? count : 1);
    const float wider = kRounding * tree_.size_mm_;
    for (std::size_t i = 0; i < 3; ++i) {
      double low = kFar, high = -kFar;
      if (!is_leaf) {
        const Node& below = tree_.nodes_[child];
        for (std::size_t k = 0; k < kChildren; ++k) {
          low = std::min(low, static_cast<double>(below.low[i][lane(k)]));
          high = std::max(high, static_cast<double>(below.high[i][lane(k)]));
        }
      } else {
        for (std::uint32_t n = range.from; n < range.to; ++n)
          for (std::size_t k = i; k < 9; k += 3) {
            const double at = soup_.corners[9 * static_cast<std::size_t>(order_[n]) + k];
            low = std::min(low, at), high = std::max(high, at);
          }
        low -= wider, high += wider;
      }
      here.low[i][lane(slot)] = static_cast<float>(low),
      here.high[i][lane(slot)] = static_cast<float>(high);
    }
  }

  /// Puts the half with the lower middles, along the longest side of what holds them all, first;
  /// returns where the other half begins.
  std::uint32_t halve(Range range) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (std::uint32_t n = range.from; n < range.to; ++n)
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], middles_[order_[n]][i]);
        high[i] = std::max(high[i], middles_[order_[n]][i]);
      }
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (high[i] - low[i] > high[longest] - low[longest]) longest = i;
    const std::uint32_t middle = range.from + (range.to - range.from + 1) / 2;
    // Equal middles are told apart by their numbers: the same tree in every run.
    std::nth_element(order_.begin() + range.from, order_.begin() + middle,
                     order_.begin() + range.to, [&](std::uint32_t a, std::uint32_t b) {
                       const float at_a = middles_[a][longest], at_b = middles_[b][longest];
                       return at_a < at_b || (at_a == at_b && a < b);
                     });
    return middle;
  }

  const TriangleSoup& soup_;
  TriangleTree& tree_;
  std::vector<std::uint32_t> order_;
  std::vector<std::array<float, 3>> middles_;
};

TriangleTree::TriangleTree(const TriangleSoup& soup) { Builder(soup, *this).build(); }

// Ericson, Real-Time Collision Detection (2005), section 5.1.5: the point is in the region of a
// corner, of an edge, or of the inside.
void TriangleTree::look_at(std::uint32_t place, const Vec3& p, Nearest& best) const {
  using Place = std::array<double, 3>;
  const double* t = corners_.data() + 9 * static_cast<std::size_t>(place);
  const double* q = p.data();
  Place ab, ac, ap;
  for (std::size_t i = 0; i < 3; ++i) {
    ab[i] = t[3 + i] - t[i];
    ac[i] = t[6 + i] - t[i];
    ap[i] = q[i] - t[i];
  }
  const auto dot3 = [](const Place& a, const Place& b) {
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
  Place point;
  double squared = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    point[i] = t[i] + v * ab[i] + w * ac[i];
    squared += (q[i] - point[i]) * (q[i] - point[i]);
  }
  if (squared < best.squared) best = {squared, place, Vec3(point.data())};
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& p, std::uint32_t hint) const {
  Nearest best;
  if (size() == 0) return best;
  if (hint < size()) look_at(hint, p, best);
  const std::array<float, 3> at{static_cast<float>(p[0]), static_cast<float>(p[1]),
                                static_cast<float>(p[2])};
  // Nothing is left out that rounding made farther than it is.
  const float closer =
      kRounding * std::max({size_mm_, std::abs(at[0]), std::abs(at[1]), std::abs(at[2])});
  struct Ahead {
    std::uint32_t node;
    float squared;
  };
  std::array<Ahead, 128> stack;  // at most three of a level wait
  std::size_t depth = 0;
  stack[depth++] = {0, 0.0f};
  while (depth > 0) {
    const Ahead next = stack[--depth];
    if (next.squared >= best.squared) continue;
    const Node& node = nodes_[next.node];
    Eigen::Array4f squared = Eigen::Array4f::Zero();
    for (std::size_t i = 0; i < 3; ++i)
      squared += ((node.low[i] - at[i]).max(at[i] - node.high[i]) - closer).max(0.0f).square();
    // The leaves first: they bring the others down.
    for (std::size_t k = 0; k < kChildren; ++k)
      if (node.is_leaf[k] && squared[lane(k)] < best.squared)
        for (std::uint32_t n = 0; n < node.count[k]; ++n) look_at(node.child[k] + n, p, best);
    const std::size_t first = depth;
    for (std::size_t k = 0; k < kChildren; ++k) {
      if (node.is_leaf[k] || squared[lane(k)] >= best.squared) continue;
      std::size_t to = depth++;
      for (; to > first && stack[to - 1].squared < squared[lane(k)]; --to)
        stack[to] = stack[to - 1];
      stack[to] = {node.child[k], squared[lane(k)]};
    }
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
  std::array<std::uint32_t, 128> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    for (std::size_t k = 0; k < kChildren; ++k) {
      if (!(node.low[1][lane(k)] <= p[1] && p[1] <= node.high[1][lane(k)] &&
            node.high[0][lane(k)] > p[0] && node.high[2][lane(k)] > p[2]))
        continue;
      if (!node.is_leaf[k]) {
        stack[depth++] = node.child[k];
        continue;
      }
      for (std::uint32_t n = 0; n < node.count[k]; ++n)
        if (beyond(node.child[k] + n, p)) return true;
    }
  }
  return false;
}

}  // namespace popcut
