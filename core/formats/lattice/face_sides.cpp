// SPDX-License-Identifier: MIT
#include "core/formats/lattice/face_sides.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include <fmt/format.h>

namespace popcut {
namespace {

/// Edges by the lesser of their vertices.
class EdgesAt {
 public:
  explicit EdgesAt(const Pattern& pattern) : edges_(pattern.edges) {
    first_.assign(pattern.vertices.size() + 1, 0);
    for (const PatternEdge& e : edges_) ++first_[std::min(e.from, e.to) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    list_.resize(edges_.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t e = 0; e < edges_.size(); ++e)
      list_[next[std::min(edges_[e].from, edges_[e].to)]++] = e;
  }

  [[nodiscard]] SideRole between(std::uint32_t a, std::uint32_t b) const {
    const auto [low, high] = std::minmax(a, b);
    for (std::uint32_t k = first_[low]; k < first_[low + 1]; ++k) {
      const PatternEdge& e = edges_[list_[k]];
      if (std::max(e.from, e.to) == high) return side_role(e);
    }
    return SideRole::Inside;
  }

 private:
  const std::vector<PatternEdge>& edges_;
  std::vector<std::uint32_t> first_, list_;
};

/// A corner of a piece of a face: its place in the ring of the face's vertices.
using RingPlace = std::uint32_t;

/// Cuts one face after another; keeps its memory between them.
class FaceCutter {
 public:
  FaceCutter(const Pattern& pattern, const std::vector<SideRole>& roles, SidedTriangles& out)
      : pattern_(pattern), roles_(roles), out_(out) {}

  bool cut(std::uint32_t f) {
    face_ = f;
    const auto face = pattern_.face(f);
    const auto own = std::span(roles_).subspan(pattern_.face_first[f], face.size());
    ring_.assign(face.begin(), face.end());
    own_.assign(own.begin(), own.end());
    lay_points();
    if (twice_area(points_, all_) < 0) {  // files from elsewhere have such faces
      std::reverse(ring_.begin(), ring_.end());
      std::reverse(own_.begin(), own_.end() - 1);  // the last side still closes the ring
      lay_points();
    }
    if (is_plain_rectangle()) {
      put({0, 1, 2}, {own_[0], own_[1], SideRole::Inside});
      put({0, 2, 3}, {SideRole::Inside, own_[2], own_[3]});
      return true;
    }
    return cut_polygon();
  }

 private:
  struct Piece {
    std::array<RingPlace, 3> at{};
    std::array<bool, 3> on_border{};  ///< the side from corner k to k + 1 is part of the face's
  };

  void lay_points() {
    points_.clear();
    for (const std::uint32_t i : ring_)
      points_.emplace_back(pattern_.u(pattern_.vertices[i]), pattern_.vertices[i].v);
    all_.resize(ring_.size());
    std::iota(all_.begin(), all_.end(), 0U);
  }

  [[nodiscard]] bool is_plain_rectangle() const {
    if (ring_.size() != 4) return false;
    for (int k = 0; k < 4; ++k) {
      const Vec2& a = points_[static_cast<std::size_t>(k)];
      const Vec2& b = points_[static_cast<std::size_t>((k + 1) % 4)];
      const Vec2& c = points_[static_cast<std::size_t>((k + 2) % 4)];
      if (!(dot(b - a, c - b) == 0 && cross(b - a, c - b) > 0)) return false;
    }
    return true;
  }

  bool cut_polygon() {
    kept_ = turning_corners(points_, all_);
    if (kept_.size() < 3) return false;
    triangles_.clear();
    if (!triangulate(points_, all_, triangles_)) return false;
    next_kept_.assign(ring_.size(), 0);
    for (std::size_t k = 0; k < kept_.size(); ++k)
      next_kept_[kept_[k]] = kept_[(k + 1) % kept_.size()];
    for (const Triangle& t : triangles_) {
      Piece piece{{t[0], t[1], t[2]}, {}};
      for (std::size_t k = 0; k < 3; ++k) piece.on_border[k] = next_kept_[t[k]] == t[(k + 1) % 3];
      cut_piece(piece);
    }
    return true;
  }

  [[nodiscard]] RingPlace after(RingPlace p) const { return p + 1 == ring_.size() ? 0 : p + 1; }

  /// The first place on the straight way from `a` to `b` where the role changes; `b` for none. What
  /// leaves the way and comes back to it is passed over.
  [[nodiscard]] RingPlace role_change(RingPlace a, RingPlace b) const {
    const Vec2 way = points_[b] - points_[a];
    double reached = 0;
    for (RingPlace p = after(a); p != b; p = after(p)) {
      const Vec2 from_a = points_[p] - points_[a];
      const double along = dot(from_a, way);
      const bool is_on_way = along > reached && along < dot(way, way) &&
                             std::abs(cross(way, from_a)) <= 1e-9 * dot(way, way);
      if (is_on_way) reached = along;
      if (is_on_way && own_[p] != own_[a]) return p;
    }
    return b;
  }

  void cut_piece(const Piece& whole) {
    stack_.assign(1, whole);
    while (!stack_.empty()) {
      const Piece piece = stack_.back();
      stack_.pop_back();
      std::size_t k = 0;
      RingPlace change = 0;
      for (; k < 3; ++k) {
        const RingPlace a = piece.at[k], b = piece.at[(k + 1) % 3];
        if (piece.on_border[k] && (change = role_change(a, b)) != b) break;
      }
      if (k == 3) {
        std::array<SideRole, 3> roles{};
        for (std::size_t s = 0; s < 3; ++s)
          roles[s] = piece.on_border[s] ? own_[piece.at[s]] : SideRole::Inside;
        put(piece.at, roles);
        continue;
      }
      const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
      stack_.push_back({{change, piece.at[l], piece.at[m]}, {true, piece.on_border[l], false}});
      stack_.push_back({{piece.at[k], change, piece.at[m]}, {true, false, piece.on_border[m]}});
    }
  }

  void put(const std::array<RingPlace, 3>& at, const std::array<SideRole, 3>& roles) {
    out_.corners.push_back({ring_[at[0]], ring_[at[1]], ring_[at[2]]});
    out_.face.push_back(face_);
    out_.sides.push_back(roles);
  }

  const Pattern& pattern_;
  const std::vector<SideRole>& roles_;
  SidedTriangles& out_;
  std::uint32_t face_{};
  std::vector<std::uint32_t> ring_;
  std::vector<SideRole> own_;
  std::vector<Vec2> points_;
  std::vector<std::uint32_t> all_, kept_, next_kept_;
  std::vector<Triangle> triangles_;
  std::vector<Piece> stack_;
};

}  // namespace

SideRole side_role(const PatternEdge& edge) {
  switch (edge.role) {
    case EdgeRole::Mountain:
      return SideRole::Mountain;
    case EdgeRole::Valley:
      return SideRole::Valley;
    case EdgeRole::Slit:
      return SideRole::Slit;
    case EdgeRole::Outline:
      return edge.left >= 0 && edge.right >= 0 ? SideRole::Inside : SideRole::Outline;
  }
  return SideRole::Inside;
}

std::vector<SideRole> roles_of_sides(const Pattern& pattern) {
  const EdgesAt edges(pattern);
  std::vector<SideRole> roles;
  roles.reserve(pattern.face_vertices.size());
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    for (std::size_t k = 0; k < face.size(); ++k)
      roles.push_back(edges.between(face[k], face[k + 1 == face.size() ? 0 : k + 1]));
  }
  return roles;
}

std::size_t most_triangles(const Pattern& pattern) {
  return pattern.face_vertices.size();  // each face makes two fewer than it has corners
}

Result<SidedTriangles> sided_triangles(const Pattern& pattern) {
  const std::vector<SideRole> roles = roles_of_sides(pattern);
  SidedTriangles out;
  const std::size_t most = most_triangles(pattern);
  out.corners.reserve(most), out.face.reserve(most), out.sides.reserve(most);
  FaceCutter cutter(pattern, roles, out);
  for (std::uint32_t f = 0; f < pattern.faces(); ++f)
    if (!cutter.cut(f))
      return fail(ErrorKind::OutOfRange, fmt::format("faces/{}", f),
                  "is no simple polygon with an area; faces may not cross themselves");
  return out;
}

}  // namespace popcut
