// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut::testing {

/// The least number of strokes that draw each line of `work` once, counted without the planner's
/// code. An end within `snap` mm of a node is that node; inner vertices of lines are nodes; equal
/// edges of one operation count once. A component of one operation takes half as many strokes as it
/// has odd nodes, but at least one.
class EulerCount {
 public:
  EulerCount(const LineWork& work, double snap) : snap_(snap) {
    std::set<std::tuple<Operation, std::size_t, std::size_t>> edges;
    std::vector<std::size_t> node_of(work.points.size());
    for (const bool ends : {false, true})
      for (const DrawnLine& line : work.lines) {
        const bool ring = closed(work.points_of(line));
        for (std::size_t i = 0; i < line.count; ++i) {
          const bool is_end = !ring && (i == 0 || i + 1 == line.count);
          if (is_end == ends)
            node_of[line.first + i] = node(work.points[line.first + i], ends ? snap : 0.001);
        }
      }
    for (const DrawnLine& line : work.lines) {
      for (std::size_t i = 1; i < line.count; ++i) {
        const std::size_t a = node_of[line.first + i - 1], b = node_of[line.first + i];
        if (a != b) edges.insert({line.operation, std::min(a, b), std::max(a, b)});
      }
    }
    edges_ = edges.size();
    for (const auto& [operation, a, b] : edges) {
      edges_mm_ += std::hypot(nodes_[a].x - nodes_[b].x, nodes_[a].y - nodes_[b].y);
      const auto p = corner(operation, a), q = corner(operation, b);
      ++degree_[p];
      ++degree_[q];
      parent_[root(p)] = root(q);
    }
  }
  [[nodiscard]] std::size_t strokes() {
    std::vector<std::size_t> odd(parent_.size(), 0);
    for (std::size_t c = 0; c < parent_.size(); ++c) odd[root(c)] += degree_[c] % 2;
    std::size_t sum = 0;
    for (std::size_t c = 0; c < parent_.size(); ++c)
      if (root(c) == c) sum += std::max<std::size_t>(1, odd[c] / 2);
    return sum;
  }
  [[nodiscard]] std::size_t edges() const { return edges_; }
  [[nodiscard]] double edges_mm() const { return edges_mm_; }

 private:
  std::size_t node(const PagePoint& p, double within) {
    const auto cx = static_cast<std::int64_t>(std::floor(p.x / snap_));
    const auto cy = static_cast<std::int64_t>(std::floor(p.y / snap_));
    double best = within;
    std::size_t found = nodes_.size();
    for (std::int64_t x = cx - 1; x <= cx + 1; ++x)
      for (std::int64_t y = cy - 1; y <= cy + 1; ++y)
        if (const auto cell = cells_.find({x, y}); cell != cells_.end())
          for (const std::size_t n : cell->second)
            if (const double d = std::hypot(nodes_[n].x - p.x, nodes_[n].y - p.y); d <= best) {
              best = d;
              found = n;
            }
    if (found == nodes_.size()) {
      nodes_.push_back(p);
      cells_[{cx, cy}].push_back(found);
    }
    return found;
  }
  // A node as one operation has it.
  std::size_t corner(Operation operation, std::size_t node) {
    const auto [at, fresh] = corners_.try_emplace({operation, node}, parent_.size());
    if (fresh) {
      parent_.push_back(parent_.size());
      degree_.push_back(0);
    }
    return at->second;
  }
  std::size_t root(std::size_t c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }

  double snap_;
  std::size_t edges_{};
  double edges_mm_{};
  std::vector<PagePoint> nodes_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> cells_;
  std::map<std::pair<Operation, std::size_t>, std::size_t> corners_;
  std::vector<std::size_t> parent_, degree_;
};

}  // namespace popcut::testing
