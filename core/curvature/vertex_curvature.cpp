// SPDX-License-Identifier: MIT
#include "core/curvature/vertex_curvature.hpp"

#include <vector>

#include "core/curvature/star.hpp"

namespace popcut {
namespace {

using Place = star::Vec<double>;

Place place(const Point3& p) { return {p[0], p[1], p[2]}; }

FundamentalForms forms_of(const Point3& centre, std::span<const Point3, 4> ring,
                          const Place& mixed) {
  const std::array<Place, 4> around{place(ring[0]), place(ring[1]), place(ring[2]), place(ring[3])};
  const auto at_centre = star::curvature<double>(place(centre), around);
  const auto f = star::forms<double>(place(centre), around, at_centre.normal, mixed);
  return {f.a_ss, f.a_st, f.a_tt, f.b_ss, f.b_st, f.b_tt};
}

}  // namespace

VertexCurvature vertex_curvature(const Point3& centre, std::span<const Point3> ring) {
  constexpr std::size_t kUsual = 8;
  std::array<Place, kUsual> few;
  std::vector<Place> many;
  std::span<Place> around = few;
  if (ring.size() > kUsual) {
    many.resize(ring.size());
    around = many;
  }
  for (std::size_t k = 0; k < ring.size(); ++k) around[k] = place(ring[k]);
  const auto c = star::curvature<double>(place(centre), around.first(ring.size()));
  return {c.defect, c.defect / c.area, c.mean, c.area};
}

FundamentalForms star_forms(const Point3& centre, std::span<const Point3, 4> ring) {
  return forms_of(centre, ring, Place{});
}

FundamentalForms grid_forms(const Point3& centre, std::span<const Point3, 4> ring,
                            std::span<const Point3, 4> diagonals) {
  const Place mixed = 0.25 * (place(diagonals[0]) - place(diagonals[1]) + place(diagonals[2]) -
                              place(diagonals[3]));
  return forms_of(centre, ring, mixed);
}

}  // namespace popcut
