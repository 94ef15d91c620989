// SPDX-License-Identifier: MIT
#include "core/hands/waste.hpp"

#include <utility>
#include <vector>

namespace popcut::hands {
namespace {

constexpr double kLeastPiece_mm2 = 0.01;

}  // namespace

// Edges with a face on one side alone, taken with the face to their left, run around the sheet
// counter-clockwise and around holes clockwise. The two sides of a slit enclose nothing. Sides that
// touch in a vertex may be followed in any order: what they enclose together stays.
std::vector<std::vector<std::uint32_t>> waste_outlines(const Pattern& pattern) {
  std::vector<std::vector<std::uint32_t>> next(pattern.vertices.size());
  const auto add = [&](std::uint32_t from, std::uint32_t to) { next[from].push_back(to); };
  for (const PatternEdge& e : pattern.edges) {
    if (e.left >= 0 && e.right < 0) add(e.from, e.to);
    if (e.right >= 0 && e.left < 0) add(e.to, e.from);
  }
  std::vector<std::vector<std::uint32_t>> pieces;
  for (std::uint32_t start = 0; start < next.size(); ++start)
    while (!next[start].empty()) {
      double area_mm2 = 0.0;
      std::vector<std::uint32_t> around;
      std::uint32_t at = start;
      while (!next[at].empty()) {
        const std::uint32_t to = next[at].back();
        next[at].pop_back();
        const PatternVertex &a = pattern.vertices[at], &b = pattern.vertices[to];
        area_mm2 += 0.5 * (pattern.u(a) * b.v - pattern.u(b) * a.v);
        around.push_back(at);
        at = to;
        if (at == start) break;
      }
      if (area_mm2 < -kLeastPiece_mm2) pieces.push_back(std::move(around));
    }
  return pieces;
}

std::size_t waste_pieces(const Pattern& pattern) { return waste_outlines(pattern).size(); }

}  // namespace popcut::hands
