// SPDX-License-Identifier: MIT
#include "core/design/slices/flat_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include <clipper.hpp>

#include "core/geometry/segment_grid.hpp"

namespace popcut {
namespace {

using ClipperLib::cInt;
using ClipperLib::IntPoint;
using ClipperLib::Path;
using ClipperLib::Paths;

constexpr double kTouch_mm = 4.0 * kShapeStep_mm;  ///< rounding of places on an edge
constexpr double kApart_mm = 0.05;

cInt on_grid(double mm) { return static_cast<cInt>(std::llround(mm / kShapeStep_mm)); }
double off_grid(cInt steps) { return static_cast<double>(steps) * kShapeStep_mm; }

Path path_of(const std::vector<Vec2>& ring) {
  Path out;
  out.reserve(ring.size());
  for (const Vec2& p : ring) out.emplace_back(on_grid(p.x()), on_grid(p.y()));
  return out;
}

Paths paths_of(const FlatRings& shape) {
  Paths out;
  out.reserve(shape.size());
  for (const std::vector<Vec2>& ring : shape) out.push_back(path_of(ring));
  return out;
}

std::vector<Vec2> ring_of(const Path& path) {
  std::vector<Vec2> out;
  out.reserve(path.size());
  for (const IntPoint& p : path) out.push_back({off_grid(p.X), off_grid(p.Y)});
  return out;
}

FlatRings rings_of(const Paths& paths) {
  FlatRings out;
  for (const Path& path : paths) out.push_back(ring_of(path));
  return out;
}

Paths clipped(ClipperLib::ClipType what, const Paths& shape, const Paths& with) {
  ClipperLib::Clipper clipper;
  clipper.StrictlySimple(true);
  clipper.AddPaths(shape, ClipperLib::ptSubject, true);
  clipper.AddPaths(with, ClipperLib::ptClip, true);
  Paths out;
  clipper.Execute(what, out, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  return out;
}

std::vector<Vec2> fewer_points(const std::vector<Vec2>& ring, double off_mm) {
  const std::size_t n = ring.size();
  if (n < 4) return ring;
  // From the two points that are farthest apart from the first and from each other.
  std::size_t far = 0;
  for (std::size_t k = 1; k < n; ++k)
    if ((ring[k] - ring[0]).squaredNorm() > (ring[far] - ring[0]).squaredNorm()) far = k;
  std::vector<bool> kept(n, false);
  kept[0] = kept[far] = true;
  std::vector<std::pair<std::size_t, std::size_t>> work{{0, far}, {far, n}};
  while (!work.empty()) {
    const auto [from, to] = work.back();
    work.pop_back();
    const Vec2 a = ring[from], way = ring[to % n] - a;
    double most = off_mm;
    std::size_t corner = from;
    for (std::size_t k = from + 1; k < to; ++k) {
      const Vec2 p = ring[k] - a;
      const double t = std::clamp(dot(p, way) / std::max(dot(way, way), 1e-300), 0.0, 1.0);
      if (const double off = norm(Vec2(p - t * way)); off > most) most = off, corner = k;
    }
    if (corner == from) continue;
    kept[corner] = true;
    work.emplace_back(from, corner);
    work.emplace_back(corner, to);
  }
  std::vector<Vec2> out;
  for (std::size_t k = 0; k < n; ++k)
    if (kept[k]) out.push_back(ring[k]);
  return out;
}

void add_piece(const ClipperLib::PolyNode& outline, std::vector<FlatRings>& out) {
  FlatRings piece{ring_of(outline.Contour)};
  for (const ClipperLib::PolyNode* hole : outline.Childs) {
    piece.push_back(ring_of(hole->Contour));
    for (const ClipperLib::PolyNode* inner : hole->Childs) add_piece(*inner, out);
  }
  out.push_back(std::move(piece));
}

/// Puts a corner where sides cross an upright line, so that both halves get the same.
Paths with_corners_at(const Paths& paths, cInt u) {
  Paths out;
  for (const Path& path : paths) {
    Path with;
    for (std::size_t k = 0; k < path.size(); ++k) {
      const IntPoint &a = path[k], &b = path[(k + 1) % path.size()];
      with.push_back(a);
      if ((a.X < u) == (b.X < u) || a.X == u || b.X == u) continue;
      const double t = static_cast<double>(u - a.X) / static_cast<double>(b.X - a.X);
      with.emplace_back(u,
                        a.Y + static_cast<cInt>(std::llround(t * static_cast<double>(b.Y - a.Y))));
    }
    out.push_back(std::move(with));
  }
  return out;
}

void add_faces(const FlatRings& piece, FlatRings& out) {
  if (piece.size() == 1) {
    out.push_back(piece.front());
    return;
  }
  const Paths paths = paths_of(piece);
  const auto by_u = [](const IntPoint& a, const IntPoint& b) { return a.X < b.X; };
  const auto [left, right] = std::minmax_element(paths[1].begin(), paths[1].end(), by_u);
  const cInt u = left->X + (right->X - left->X) / 2;
  const Paths whole = with_corners_at(paths, u);
  cInt low = u, high = u, bottom = whole[0][0].Y, top = bottom;
  for (const IntPoint& p : whole[0]) {
    low = std::min(low, p.X), high = std::max(high, p.X);
    bottom = std::min(bottom, p.Y), top = std::max(top, p.Y);
  }
  for (const auto& [from, to] : {std::pair(low - 1, u), std::pair(u, high + 1)}) {
    const Paths half{{{from, bottom - 1}, {to, bottom - 1}, {to, top + 1}, {from, top + 1}}};
    const FlatRings shape = rings_of(clipped(ClipperLib::ctIntersection, whole, half));
    for (const FlatRings& part : pieces_of(shape)) add_faces(part, out);
  }
}

/// Corners of rings that lie on another ring, or (`also_own`) on a side of their own that does not
/// end there.
std::vector<Vec2> touching_places(const FlatRings& shape, bool also_own) {
  if (shape.size() < 2 && !also_own) return {};
  struct Place {
    std::size_t ring{}, corner{};
  };
  std::vector<Segment> sides;
  std::vector<Place> places;
  for (std::size_t r = 0; r < shape.size(); ++r)
    for (std::size_t k = 0; k < shape[r].size(); ++k) {
      const Vec2 &a = shape[r][k], &b = shape[r][(k + 1) % shape[r].size()];
      sides.push_back({{a.x(), a.y()}, {b.x(), b.y()}});
      places.push_back({r, k});
    }
  SegmentGrid grid(sides, kTouch_mm);
  const auto is_on = [&](const Vec2& p, std::uint32_t side) {
    const Vec2 a{sides[side].a.x, sides[side].a.y}, b{sides[side].b.x, sides[side].b.y};
    const Vec2 way = b - a, to = p - a;
    const double t = std::clamp(dot(to, way) / std::max(dot(way, way), 1e-300), 0.0, 1.0);
    return norm(Vec2(to - t * way)) <= kTouch_mm;
  };
  std::vector<Vec2> out;
  std::vector<std::uint32_t> near;
  for (const Place& own : places) {
    const Vec2& p = shape[own.ring][own.corner];
    near.clear();
    grid.near({{p.x(), p.y()}, {p.x(), p.y()}}, near);
    if (std::any_of(near.begin(), near.end(), [&](std::uint32_t side) {
          const Place& other = places[side];
          if (other.ring == own.ring) {
            const std::size_t n = shape[own.ring].size();
            if (!also_own || other.corner == own.corner || (other.corner + 1) % n == own.corner)
              return false;
          }
          return is_on(p, side);
        }))
      out.push_back(p);
  }
  return out;
}

/// Where a side passes an upright line.
void add_passage(const Vec2& a, const Vec2& b, double u_mm, std::vector<double>& out) {
  if ((a.x() >= u_mm) == (b.x() >= u_mm)) return;
  out.push_back(a.y() + (u_mm - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
}

std::vector<PaperSpan> spans_between(std::vector<double> at) {
  std::sort(at.begin(), at.end());
  std::vector<PaperSpan> out;
  for (std::size_t k = 0; k + 1 < at.size(); k += 2) out.push_back({at[k], at[k + 1]});
  return out;
}

/// Connected paper of what clipping gives.
std::vector<FlatRings> clipped_pieces(ClipperLib::ClipType what, const Paths& shape,
                                      const Paths& with, bool strictly_simple) {
  ClipperLib::Clipper clipper;
  clipper.StrictlySimple(strictly_simple);
  clipper.AddPaths(shape, ClipperLib::ptSubject, true);
  clipper.AddPaths(with, ClipperLib::ptClip, true);
  ClipperLib::PolyTree tree;
  clipper.Execute(what, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  std::vector<FlatRings> out;
  for (const ClipperLib::PolyNode* outline : tree.Childs) add_piece(*outline, out);
  return out;
}

}  // namespace

FlatRings inside_of(const FlatRings& rings) {
  return rings_of(clipped(ClipperLib::ctUnion, paths_of(rings), {}));
}

FlatRings joined(const FlatRings& shape, const FlatRings& with) {
  return rings_of(clipped(ClipperLib::ctUnion, paths_of(shape), paths_of(with)));
}

FlatRings without(const FlatRings& shape, const FlatRings& cut) {
  return rings_of(clipped(ClipperLib::ctDifference, paths_of(shape), paths_of(cut)));
}

FlatRings common(const FlatRings& shape, const FlatRings& with) {
  return rings_of(clipped(ClipperLib::ctIntersection, paths_of(shape), paths_of(with)));
}

double area_of(const FlatRings& shape) {
  double twice = 0.0;
  for (const std::vector<Vec2>& ring : shape)
    for (std::size_t k = 0; k < ring.size(); ++k)
      twice += cross(ring[k], ring[(k + 1) % ring.size()]);
  return 0.5 * twice;
}

std::vector<Vec2> rectangle(Vec2 low, Vec2 high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

FlatRings with_fewer_points(const FlatRings& shape, double off_mm) {
  FlatRings out;
  for (const std::vector<Vec2>& ring : shape) out.push_back(fewer_points(ring, off_mm));
  return inside_of(out);
}

std::vector<FlatRings> pieces_of(const FlatRings& shape) {
  return clipped_pieces(ClipperLib::ctUnion, paths_of(shape), {}, true);
}

std::vector<FlatRings> pieces_without(const FlatRings& shape, const FlatRings& cuts) {
  const Paths paths = paths_of(shape), with = paths_of(cuts);
  // Clipper takes the square of a ring's corners to part rings that touch themselves; few do.
  std::vector<FlatRings> out = clipped_pieces(ClipperLib::ctDifference, paths, with, false);
  FlatRings all;
  for (const FlatRings& piece : out) all.insert(all.end(), piece.begin(), piece.end());
  if (touching_places(all, true).empty()) return out;
  return pieces_of(without_touching(rings_of(clipped(ClipperLib::ctDifference, paths, with))));
}

FlatRings without_touching(const FlatRings& shape) {
  FlatRings out = shape;
  // A square can meet another ring; each round cuts more away, so this ends.
  for (;;) {
    FlatRings squares;
    for (const Vec2& p : touching_places(out, false)) {
      const Vec2 half{kApart_mm, kApart_mm};
      squares.push_back(rectangle(Vec2(p - half), Vec2(p + half)));
    }
    if (squares.empty()) return out;
    out = without(out, squares);
  }
}

std::vector<PaperSpan> paper_at(const FlatRings& shape, double u_mm) {
  std::vector<double> at;
  for (const std::vector<Vec2>& ring : shape)
    for (std::size_t k = 0; k < ring.size(); ++k)
      add_passage(ring[k], ring[(k + 1) % ring.size()], u_mm, at);
  return spans_between(std::move(at));
}

UprightLines::UprightLines(const FlatRings& shape) {
  Eigen::AlignedBox2d box;
  for (const std::vector<Vec2>& ring : shape)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      box.extend(ring[k]);
      sides_.push_back({ring[k], ring[(k + 1) % ring.size()]});
    }
  if (sides_.empty()) return;
  low_ = box.min().x(), high_ = box.max().x();
  std::vector<std::uint32_t> which(sides_.size());
  std::iota(which.begin(), which.end(), 0U);
  bins_ = IntervalBins(low_, high_, sides_.size(), which, [&](std::uint32_t k) {
    return std::pair<double, double>(std::minmax(sides_[k].from.x(), sides_[k].to.x()));
  });
}

std::vector<double> UprightLines::passages_at(double u_mm) const {
  std::vector<double> out;
  if (reaches(u_mm))
    for (const std::uint32_t k : bins_.at(u_mm))
      add_passage(sides_[k].from, sides_[k].to, u_mm, out);
  return out;
}

std::vector<PaperSpan> UprightLines::paper_at(double u_mm) const {
  return spans_between(passages_at(u_mm));
}

Eigen::AlignedBox2d box_of(const std::vector<Vec2>& ring) {
  Eigen::AlignedBox2d out;
  for (const Vec2& p : ring) out.extend(p);
  return out;
}

FlatRings faces_of_piece(const FlatRings& piece) {
  FlatRings out;
  add_faces(piece, out);
  return out;
}

FlatRings swept_from_above(const FlatRings& shape, double height_mm) {
  FlatRings out = shape;
  const Vec2 up{0.0, height_mm};
  for (const std::vector<Vec2>& ring : shape)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if (a.x() == b.x()) continue;
      std::vector<Vec2> side{a, b, Vec2(b + up), Vec2(a + up)};
      // Clipper adds up windings, so all sides run the same way.
      if (b.x() < a.x()) std::reverse(side.begin(), side.end());
      out.push_back(std::move(side));
    }
  return inside_of(out);
}

}  // namespace popcut
