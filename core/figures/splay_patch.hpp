// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "core/curvature/vertex_curvature.hpp"
#include "core/result.hpp"

namespace popcut {

/// Angle theta of a V-fold's centre OA with its crease at the opening angle `psi_rad`, from 0 to
/// pi: `2 atan2(alpha cos(psi/2), 1)` (docs/geometry.md, section 7). That is the main text's
/// `atan(2 a / (1 - a^2))`, a = alpha cos(psi/2), on the branch that stays continuous where a > 1.
[[nodiscard]] double splay_angle_rad(double alpha, double psi_rad);

/// Five splayed units, the middle one and its neighbours along and across the creases. Each tip A
/// lies `w cos theta` along its crease and `w sin theta` above it.
struct SplayPatch {
  double w{1.0};             ///< length of OA, mm
  double pitch_along{1.0};   ///< from apex to apex along a crease, mm
  double pitch_across{1.0};  ///< between creases, mm; or the panel's length a, see `on_lattice`
  bool on_lattice{false};    ///< creases of a lattice with lx = lz = a: 2 a sin(psi/2) apart
  double alpha{};            ///< of the middle unit
  double alpha_along{};      ///< of its neighbours on the same crease
  double alpha_across{};     ///< of those on the creases beside it

  [[nodiscard]] Point3 centre(double psi_rad) const;
  /// Neighbours along, across, along, across.
  [[nodiscard]] std::array<Point3, 4> ring(double psi_rad) const;
};

[[nodiscard]] VertexCurvature curvature_of(const SplayPatch& patch, double psi_rad);

/// The `alpha_across` for which K of the middle passes from below zero to above it at `psi_rad`,
/// the first one beyond both `alpha` (with which K is zero at every psi, which is no answer) and `1
/// / cos(psi/2)` (where those neighbours stand highest). For smaller psi they are then lower than
/// the middle, for larger psi higher, so that a middle above its neighbours along the crease goes
/// from K > 0 to K < 0 as the card opens.
///
/// @retval Infeasible  there is none up to 100
[[nodiscard]] Result<double> alpha_across_for_zero(SplayPatch patch, double psi_rad);

}  // namespace popcut
