// SPDX-License-Identifier: MIT
#include "core/deploy/sheet_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/deploy/pose_table.hpp"

namespace popcut {
namespace {

/// Appends one face. False when it is no simple polygon.
bool add_face(const Pattern& pattern, std::size_t f, FaceTriangles& out) {
  std::vector<Vec2> points;
  for (const std::uint32_t i : pattern.face(f))
    points.emplace_back(flat_place(pattern, pattern.vertices[i]).head<2>());
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<std::uint32_t> corners = turning_corners(points, all);
  if (corners.size() < 3) return false;
  if (twice_area(points, corners) < 0) std::reverse(corners.begin(), corners.end());
  // The corners that are kept are what the triangles count.
  const auto base = static_cast<std::uint32_t>(out.corner.size());
  std::vector<std::uint32_t> number(points.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    number[corners[k]] = base + static_cast<std::uint32_t>(k);
    out.corner.emplace_back(points[corners[k]][0], points[corners[k]][1], 0.0);
  }
  std::vector<Triangle> triangles;
  if (!triangulate(points, corners, triangles)) return false;
  for (const auto& [a, b, c] : triangles) out.triangle.push_back({number[a], number[b], number[c]});
  return true;
}

/// A rectangle of a face between two neighbouring borders of strips.
struct Piece {
  std::uint32_t face{};
  double u0{}, u1{};  ///< from the spine
};

/// The pieces of all faces: those of the slab `v[s] .. v[s + 1]` are `first[s] .. first[s + 1]`, by
/// growing u.
struct Slabs {
  std::vector<double> v;
  std::vector<std::uint32_t> first;
  std::vector<Piece> pieces;

  [[nodiscard]] std::size_t index(double at) const {
    return static_cast<std::size_t>(std::lower_bound(v.begin(), v.end(), at) - v.begin());
  }
};

/// Calls `visit(face, p, q)` for each side of each face.
template <typename Visit>
void each_side(const Pattern& pattern, Visit visit) {
  for (std::uint32_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    for (std::size_t i = 0; i < face.size(); ++i)
      visit(f, pattern.vertices[face[i]], pattern.vertices[face[(i + 1) % face.size()]]);
  }
}

bool is_rectilinear(const Pattern& pattern) {
  bool all = true;
  each_side(pattern, [&](std::uint32_t, const PatternVertex& p, const PatternVertex& q) {
    all = all && (p.v == q.v || pattern.u(p) == pattern.u(q));
  });
  return all;
}

/// A face's side across one slab.
struct Crossing {
  std::size_t slab{};
  double u{};
  std::uint32_t face{};
};

std::vector<double> borders_of(const Pattern& pattern) {
  std::vector<double> v;
  for (const PatternVertex& p : pattern.vertices) v.push_back(p.v);
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
  return v;
}

Slabs cut_into_slabs(const Pattern& pattern) {
  Slabs slabs;
  slabs.v = borders_of(pattern);
  std::vector<Crossing> crossings;
  each_side(pattern, [&](std::uint32_t f, const PatternVertex& p, const PatternVertex& q) {
    const double u = flat_place(pattern, p)[0];
    const auto [low, high] = std::minmax(p.v, q.v);
    for (std::size_t s = slabs.index(low); s < slabs.index(high); ++s)
      crossings.push_back({s, u, f});
  });
  // Two sides of one face follow each other, since faces do not overlap.
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return std::tuple(a.slab, a.face, a.u) < std::tuple(b.slab, b.face, b.u);
  });
  slabs.first.assign(slabs.v.empty() ? 1 : slabs.v.size(), 0);
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    slabs.pieces.push_back({crossings[i].face, crossings[i].u, crossings[i + 1].u});
    ++slabs.first[crossings[i].slab + 1];
  }
  for (std::size_t s = 1; s < slabs.first.size(); ++s) {
    slabs.first[s] += slabs.first[s - 1];
    const auto begin = slabs.pieces.begin();
    std::sort(begin + slabs.first[s - 1], begin + slabs.first[s],
              [](const Piece& a, const Piece& b) { return a.u0 < b.u0; });
  }
  return slabs;
}

/// Two triangles, in the order that the paper's meshes have.
void add_panel(SheetMesh& mesh, std::uint32_t body, double u0, double u1, double v0, double v1) {
  const auto n = static_cast<std::uint32_t>(mesh.at.size());
  for (const double u : {u0, u1}) {
    mesh.at.insert(mesh.at.end(), {{u, v1, 0}, {u, v0, 0}});
    mesh.body.insert(mesh.body.end(), 2, body);
  }
  mesh.triangles.push_back({n, n + 1, n + 2});
  mesh.triangles.push_back({n + 2, n + 1, n + 3});
}

SheetMesh mesh_of(const FaceTriangles& faces) {
  SheetMesh mesh{faces.corner, {}, faces.triangle};
  for (std::uint32_t f = 0; f < faces.faces(); ++f)
    mesh.body.insert(mesh.body.end(), faces.first_corner[f + 1] - faces.first_corner[f], f);
  return mesh;
}

}  // namespace

Result<FaceTriangles> triangulate_faces(const Pattern& pattern) {
  FaceTriangles out;
  out.first_corner.push_back(0);
  out.first_triangle.push_back(0);
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    if (!add_face(pattern, f, out)) {
      return fail(ErrorKind::OutOfRange, fmt::format("faces/{}", f),
                  "is no simple polygon with an area; faces may not cross themselves");
    }
    out.first_corner.push_back(static_cast<std::uint32_t>(out.corner.size()));
    out.first_triangle.push_back(static_cast<std::uint32_t>(out.triangle.size()));
  }
  return out;
}

std::size_t border_crossings(const Pattern& pattern) {
  const Slabs slabs{borders_of(pattern), {}, {}};
  std::size_t crossings = 0;
  each_side(pattern, [&](std::uint32_t, const PatternVertex& p, const PatternVertex& q) {
    const auto [low, high] = std::minmax(p.v, q.v);
    crossings += slabs.index(high) - slabs.index(low);
  });
  return crossings;
}

Result<SheetMesh> surface_mesh(const Pattern& pattern) {
  if (!is_rectilinear(pattern) || border_crossings(pattern) > kMaxCrossings)
    return triangulate_faces(pattern).map(mesh_of);
  const Slabs slabs = cut_into_slabs(pattern);
  SheetMesh mesh;
  for (std::size_t s = 0; s + 1 < slabs.v.size(); ++s) {
    for (std::uint32_t i = slabs.first[s]; i < slabs.first[s + 1]; ++i) {
      const Piece& piece = slabs.pieces[i];
      add_panel(mesh, piece.face, piece.u0, piece.u1, slabs.v[s], slabs.v[s + 1]);
    }
  }
  return mesh;
}

Result<SheetMesh> surface_mesh(const Pattern& pattern, const Strips& strips) {
  if (!is_rectilinear(pattern)) return triangulate_faces(pattern).map(mesh_of);
  const Slabs slabs = cut_into_slabs(pattern);
  SheetMesh mesh;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const double v0 = strips.v_begin[s], v1 = strips.v_begin[s + 1];
    const std::size_t slab = slabs.index(0.5 * (v0 + v1));
    for (std::size_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
      if (strips.is_cut(p)) continue;
      const std::size_t q = p + s;
      const double u0 = strips.x[q] - strips.z[q], u1 = strips.x[q + 1] - strips.z[q + 1];
      const double middle = 0.5 * (u0 + u1);
      if (slab == 0 || slab >= slabs.v.size())
        return fail(ErrorKind::Internal, fmt::format("strip {}", s), "lies outside the pattern");
      const auto begin = slabs.pieces.begin() + slabs.first[slab - 1];
      const auto end = slabs.pieces.begin() + slabs.first[slab];
      const auto found =
          std::partition_point(begin, end, [&](const Piece& piece) { return piece.u1 < middle; });
      if (found == end || found->u0 > middle)
        return fail(ErrorKind::Internal, fmt::format("panel {}", p), "lies in no face");
      add_panel(mesh, found->face, u0, u1, v0, v1);
    }
  }
  return mesh;
}

SheetMesh rectangle_mesh(const Pattern& pattern) {
  SheetMesh mesh;
  for (std::uint32_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    const Vec3 low = flat_place(pattern, pattern.vertices[face[0]]);
    const Vec3 high = flat_place(pattern, pattern.vertices[face[2]]);
    add_panel(mesh, f, low[0], high[0], low[1], high[1]);
  }
  return mesh;
}

Result<SheetMesh> solid_mesh(const Pattern& pattern, double thickness_mm) {
  if (!(thickness_mm > 0 && std::isfinite(thickness_mm))) {
    return fail(ErrorKind::OutOfRange, "thickness",
                fmt::format("{} mm; a solid needs a positive thickness", thickness_mm));
  }
  const auto faces = triangulate_faces(pattern);
  if (!faces) return tl::unexpected(faces.error());
  const auto count = static_cast<std::uint32_t>(faces->corner.size());
  SheetMesh mesh = mesh_of(*faces);  // the fronts; corner i of the back is count + i
  mesh.at.reserve(2 * faces->corner.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.at.emplace_back(mesh.at[i] - Vec3{0, 0, thickness_mm / 2});
    mesh.at[i][2] += thickness_mm / 2;
    mesh.body.push_back(mesh.body[i]);
  }
  for (const auto& [a, b, c] : faces->triangle)
    mesh.triangles.push_back({count + a, count + c, count + b});
  for (std::size_t f = 0; f < faces->faces(); ++f) {
    const std::uint32_t first = faces->first_corner[f], end = faces->first_corner[f + 1];
    for (std::uint32_t i = first; i < end; ++i) {
      const std::uint32_t next = i + 1 < end ? i + 1 : first;
      mesh.triangles.push_back({i, count + i, count + next});
      mesh.triangles.push_back({i, count + next, next});
    }
  }
  return mesh;
}

}  // namespace popcut
