// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>

namespace popcut {

/// A point in space as (x, v, z), mm.
using Point3 = std::array<double, 3>;

/// Curvature of a surface of triangles at one vertex (docs/geometry.md, section 6; S1).
struct VertexCurvature {
  double K{};       ///< angle defect 2 pi - sum of the angles at the vertex, rad (Gauss-Bonnet)
  double K_area{};  ///< K / A, 1/mm^2: the Gaussian curvature that compares with a smooth surface's
  double H{};       ///< mean curvature by the cotangent formula, 1/mm; > 0 where convex
  double A{};       ///< a third of the areas of the triangles at the vertex, mm^2
};

/// K, K_area, H and A of `centre` amid `ring`, its neighbours in order round it, three or more.
///
///     K = 2 pi - sum angle_k
///     H = 1/2 n . (1 / (2 A)) sum (cot gamma_k + cot epsilon_k) (centre - ring_k)
///
/// with `n` the area-weighted normal. Counter-clockwise as seen from outside, n points outward and
/// H > 0 means convex, as on a sphere; the other way round H changes sign. The 1/2 is that of S1
/// and of Meyer et al. (2003), which the main text's formula lacks.
///
/// Where all triangles vanish, K_area and H are not finite; where a single one does, H is not.
[[nodiscard]] VertexCurvature vertex_curvature(const Point3& centre, std::span<const Point3> ring);

/// First and second fundamental forms of a surface r(s, t) at a vertex, in the parameters that
/// count vertices: neighbours are one apart. (S4 asks for "discrete versions" and gives none; these
/// are popcut's.)
///
///     a_ss = r_s . r_s     averaged over the four triangles of the star, each with its own edges;
///     b_ss = -n . r_ss     second differences along s, along t, and across the diagonals.
///
/// n is the area-weighted outward normal, so that b is positive on a sphere and
/// `det b / det a` and `1/2 tr(a^-1 b)` have the signs of K and H. Both tend to the smooth
/// surface's as the spacing shrinks.
struct FundamentalForms {
  double a_ss{}, a_st{}, a_tt{};  ///< mm^2
  double b_ss{}, b_st{}, b_tt{};  ///< mm

  [[nodiscard]] double det_a() const { return a_ss * a_tt - a_st * a_st; }
  /// det b / det a, 1/mm^2: compares with K_area, not with the angle defect.
  [[nodiscard]] double gaussian() const { return (b_ss * b_tt - b_st * b_st) / det_a(); }
  /// 1/2 tr(a^-1 b), 1/mm.
  [[nodiscard]] double mean() const {
    return 0.5 * (a_tt * b_ss + a_ss * b_tt - 2.0 * a_st * b_st) / det_a();
  }
};

/// Forms of a star of five vertices, `ring` in the order (s + 1, t + 1, s - 1, t - 1). Five points
/// do not determine the mixed difference r_st: it is taken as zero.
[[nodiscard]] FundamentalForms star_forms(const Point3& centre, std::span<const Point3, 4> ring);

/// Forms with the mixed difference of the diagonal neighbours, `diagonals` in the order
/// (s + 1, t + 1) (s - 1, t + 1) (s - 1, t - 1) (s + 1, t - 1).
[[nodiscard]] FundamentalForms grid_forms(const Point3& centre, std::span<const Point3, 4> ring,
                                          std::span<const Point3, 4> diagonals);

}  // namespace popcut
