// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <iosfwd>
#include <optional>
#include <vector>

#include "core/curvature/samples.hpp"
#include "core/curvature/vertex_curvature.hpp"
#include "core/result.hpp"

namespace popcut {

/// The five-unit assembly of the main text, Fig. 1B, in unit widths (docs/geometry.md, section 6):
/// the middle unit's fold vertex v0 = (r cos phi, 0, r sin phi) with the ring v1 = (lambda, 1, 1 +
/// lambda), v2 = (1, -1, 2), v3 = (1 + lambda, -1, lambda), v4 = (2, 1, 1), as (x, v, z).
///
/// The paper prints no coordinates. With these all three of its statements hold at phi = pi/4: v0
/// is the midpoint of v1 v3 on r = (1 + 2 lambda)/sqrt 2 and of v2 v4 on r = 3/sqrt 2, so that K =
/// 0, and the centroid of the ring on r = (2 + lambda)/sqrt 2, so that H = 0. The half turn about
/// the point (3/sqrt 2, 1) of the (r, lambda) plane keeps K and turns the sign of H.
struct Assembly {
  double r{};
  double lambda{};
  double phi_rad{};

  [[nodiscard]] Point3 centre() const;
  [[nodiscard]] std::array<Point3, 4> ring() const;
};

/// K and H at the assembly's middle; outward normal (away from the origin).
[[nodiscard]] VertexCurvature curvature_of(const Assembly& assembly);

/// a and b there, in the parameters s from v3 to v1 and t from v4 to v2. The mixed difference is
/// not determined by five points and taken as zero; so the signs of `gaussian()` and `mean()` are
/// those of K and H, with the same zero loci at phi = pi/4.
[[nodiscard]] FundamentalForms forms_of(const Assembly& assembly);

/// Values of K and H over a grid: row by row from the smallest lambda, r running fastest.
struct AssemblyMaps {
  Samples r, lambda;
  std::vector<double> K, H;
};
[[nodiscard]] AssemblyMaps assembly_maps(double phi_rad, const Samples& r, const Samples& lambda);

/// Writes the columns r, lambda, K, H, with a heading, in the order of `AssemblyMaps`; takes no
/// memory for the grid. A value that is not finite (a triangle that vanishes) is left empty.
void write_assembly_csv(double phi_rad, const Samples& r, const Samples& lambda, std::ostream& out);

/// What an assembly is to have: K in rad (angle defect), and H in 1/width if given.
struct AssemblyTarget {
  double K{};
  std::optional<double> H;
  double phi_rad{};
};

struct AssemblySolution {
  Assembly assembly;
  VertexCurvature reached;
  std::optional<Assembly> mirror;  ///< the other one, equally near, at phi = pi/4
};

/// The minimiser of `(K - K~)^2`, or of `(K - K~)^2 + (H - H~)^2`, with r, lambda > 0.
///
/// K alone is reached on whole curves; the point nearest to (3/sqrt 2, 1) is taken, and of two
/// equally near ones that with the larger r.
///
/// @retval OutOfRange  K is not within -2 pi .. 2 pi, or something is not finite
/// @retval Infeasible  no r, lambda up to 1e4 has it; `detail` names the nearest that was found
[[nodiscard]] Result<AssemblySolution> solve_assembly(const AssemblyTarget& target);

/// The least lambda > 1 from which on K is reached at phi = pi/4, for -2 pi < K < 0. By the half
/// turn it is also reached for lambda <= 2 - this, where that is positive. (For lambda > 1 the
/// least K lies on the H = 0 locus and falls as lambda grows.)
[[nodiscard]] double assembly_lambda_for(double K);

}  // namespace popcut
