// SPDX-License-Identifier: MIT
#include "core/verify/sheet/loops.hpp"

#include <algorithm>

namespace popcut::verify {
namespace {

constexpr std::int32_t kNoHinge = -1;

/// Walks around vertices and along borders, side by side.
class Walker {
 public:
  Walker(const FoldModel& file, const Sheet& sheet)
      : file_(file), sheet_(sheet), hinge_of_edge_(file.edges.size(), kNoHinge) {
    for (std::uint32_t h = 0; h < sheet.hinges.size(); ++h)
      hinge_of_edge_[sheet.hinges[h].edge] = static_cast<std::int32_t>(h);
    loops_.first.push_back(0);
  }

  /// Around each vertex that is not on a border.
  void around_vertices() {
    std::vector<std::uint8_t> seen(sheet_.side_twin.size(), 0);
    for (std::uint32_t start = 0; start < seen.size(); ++start) {
      bool open = false;
      std::uint32_t side = start;
      while (seen[side] == 0) {
        seen[side] = 1;
        if (sheet_.side_twin[side] < 0) {
          open = true;
          break;
        }
        side = cross(side);
      }
      if (!open && side == start && loops_.crossings.size() > loops_.first.back()) close();
      loops_.crossings.resize(loops_.first.back());
    }
  }

  /// Along each border except the outer ones: those with the largest area of their piece.
  void along_borders() {
    const std::vector<BorderLoop> borders = border_loops(file_, sheet_);
    const auto piece = [&](const BorderLoop& b) {
      return sheet_.piece_of_face[sheet_.side_face[b.start]];
    };
    std::vector<std::size_t> outer(sheet_.pieces, borders.size());
    for (std::size_t b = 0; b < borders.size(); ++b) {
      std::size_t& best = outer[piece(borders[b])];
      if (best == borders.size() || borders[b].area_mm2 > borders[best].area_mm2) best = b;
    }
    for (std::size_t b = 0; b < borders.size(); ++b) {
      if (outer[piece(borders[b])] == b) continue;
      walk(borders[b].start);
      close();
    }
  }

  [[nodiscard]] Loops take() { return std::move(loops_); }

 private:
  void close() { loops_.first.push_back(static_cast<std::uint32_t>(loops_.crossings.size())); }

  /// Crosses the fold at `side` and returns the side beyond it that leaves the same vertex.
  std::uint32_t cross(std::uint32_t side) {
    const auto twin = static_cast<std::uint32_t>(sheet_.side_twin[side]);
    const std::int32_t h = hinge_of_edge_[static_cast<std::size_t>(sheet_.side_edge[side])];
    if (h != kNoHinge) {
      const auto hinge = static_cast<std::uint32_t>(h);
      loops_.crossings.push_back({hinge, sheet_.hinges[hinge].left == sheet_.side_face[twin]});
    }
    return sheet_.next(file_, twin);
  }

  void walk(std::uint32_t start) {
    std::uint32_t side = start;
    do {
      side = sheet_.next(file_, side);
      while (sheet_.side_twin[side] >= 0) side = cross(side);
    } while (side != start);
  }

  const FoldModel& file_;
  const Sheet& sheet_;
  std::vector<std::int32_t> hinge_of_edge_;
  Loops loops_;
};

}  // namespace

std::optional<Loops> loops_of(const FoldModel& file, const Sheet& sheet) {
  if (std::any_of(sheet.side_edge.begin(), sheet.side_edge.end(),
                  [](std::int32_t e) { return e < 0; }))
    return {};
  std::size_t ties = 0;  // sides where a face borders itself
  for (std::size_t s = 0; s < sheet.side_twin.size(); ++s) {
    if (sheet.side_twin[s] < 0) continue;
    const auto twin = static_cast<std::size_t>(sheet.side_twin[s]);
    if (sheet.side_twin[twin] != static_cast<std::int32_t>(s)) return {};
    ties += twin > s && sheet.side_face[twin] == sheet.side_face[s] ? 1 : 0;
  }
  Walker walker(file, sheet);
  walker.around_vertices();
  walker.along_borders();
  Loops loops = walker.take();
  if (loops.size() + file.faces() != sheet.hinges.size() + ties + sheet.pieces) return {};
  return loops;
}

}  // namespace popcut::verify
