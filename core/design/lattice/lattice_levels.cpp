// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/design/lattice/lattice.hpp"

namespace popcut {
namespace {

// A plane that would lie behind the wall or under the ground is kEnded; its partner is then kBeyond
// the other axis' reach.
constexpr double kEnded = -1.0;
constexpr double kBeyond = std::numeric_limits<double>::infinity();

/// Parameter at which a coordinate of the curve has a given value; both coordinates are monotone.
double parameter_of(const SliceCurve& curve, double want, bool is_height) {
  double low = -1.0, high = 1.0;
  for (int k = 0; k < 100 && high - low > 1e-16; ++k) {
    const double t = 0.5 * (low + high);
    const CurveJet c = curve.at(t);
    const bool too_early = is_height ? c.z > want : c.x < want;
    (too_early ? low : high) = t;
  }
  return 0.5 * (low + high);
}

/// The offset at height z.
double x_at(const SliceCurve& curve, double z) {
  if (z <= 0.0) return kBeyond;
  if (z >= curve.h()) return kEnded;
  if (curve.is_circle()) return std::sqrt((curve.h() - z) * (curve.h() + z));
  return curve.at(parameter_of(curve, z, true)).x;
}

/// The height at offset x.
double z_at(const SliceCurve& curve, double x) {
  if (x <= 0.0) return kBeyond;
  if (x >= curve.d()) return kEnded;
  if (curve.is_circle()) return std::sqrt((curve.d() - x) * (curve.d() + x));
  return curve.at(parameter_of(curve, x, false)).z;
}

/// Place of level i of n by (x/d)^2 - (z/h)^2, from -1 at the wall to 1 at the ground.
double spread_place(int i, int n, double power) {
  const double q = 2.0 * i / n - 1.0;
  return std::copysign(std::pow(std::abs(q), power), q);
}

/// The curve's parameter where (x/d)^2 - (z/h)^2, which grows along it, has a given value.
double parameter_of_place(const SliceCurve& curve, double place) {
  double low = -1.0, high = 1.0;
  for (int k = 0; k < 60; ++k) {
    const double t = 0.5 * (low + high);
    const CurveJet c = curve.at(t);
    const double x = c.x / curve.d(), z = c.z / curve.h();
    (x * x - z * z < place ? low : high) = t;
  }
  return 0.5 * (low + high);
}

/// Closed form for revolutions: with R_k + R_(k+1) = 2 r^2(v_k) each vertex is exact when
/// X^2 = (R_k + c_i)/2 and Z^2 = (R_(k+1) - c_i)/2.
void fill_revolution(const RunTarget& target, std::optional<double> power, Planes& planes) {
  const int slices = target.slices(), n = target.units;
  std::vector<double> big_r(static_cast<std::size_t>(slices));
  const auto square = [](const SliceCurve& c) { return c.h() * c.h(); };
  big_r[0] = square(target.slice_curves[0]);
  for (std::size_t k = 0; k + 1 < big_r.size(); ++k)
    big_r[k + 1] = 2.0 * square(target.connector_curves[k]) - big_r[k];
  double alternating = 0.0, sign = 1.0;  // the free constant, by least squares against r^2
  for (std::size_t k = 0; k < big_r.size(); ++k, sign = -sign)
    alternating += sign * (square(target.slice_curves[k]) - big_r[k]);
  alternating /= slices;
  sign = 1.0;
  for (double& r : big_r) r += sign * alternating, sign = -sign;
  const double most = *std::max_element(big_r.begin(), big_r.end());
  for (int i = 0; i <= n; ++i) {
    const double place = power ? spread_place(i, n, *power) : -std::cos(std::numbers::pi * i / n);
    const double c = i == 0 ? -most : i == n ? most : most * place;
    for (int j = 0; j < slices; ++j) {
      const double r = big_r[static_cast<std::size_t>(j)];
      const double square_of = 0.5 * (Planes::holds_height(j, i) ? r - c : r + c);
      planes.at(j, i) = square_of > 0.0 ? std::sqrt(square_of) : kEnded;
    }
  }
}

/// Any surface: each level starts at the largest connector, shifted by half a step along the exact
/// lattice (where F_X dX = F_Z dZ), and follows slice by slice from F(known, unknown) = 0.
void fill_followed(const RunTarget& target, std::optional<double> power, Planes& planes) {
  const int slices = target.slices(), n = target.units;
  int seed = 0;
  for (int k = 1; k + 1 < slices; ++k) {
    const auto size = [&](int c) {
      const SliceCurve& curve = target.connector_curves[static_cast<std::size_t>(c)];
      return curve.h() + curve.d();
    };
    if (size(k) > size(seed)) seed = k;
  }
  const auto connector = [&](int k) -> const SliceCurve& {
    return target.connector_curves[static_cast<std::size_t>(k)];
  };
  const auto slice = [&](int j) -> const SliceCurve& {
    return target.slice_curves[static_cast<std::size_t>(j)];
  };
  std::vector<double> arcs = connector(seed).equal_arcs(n);
  for (int i = 1; power && i < n; ++i)
    arcs[static_cast<std::size_t>(i)] =
        parameter_of_place(connector(seed), spread_place(i, n, *power));
  for (int i = 0; i <= n; ++i) {
    const CurveJet point = connector(seed).at(arcs[static_cast<std::size_t>(i)]);
    if (i == 0 || i == n) {  // the wall and the ground themselves: nothing to follow
      for (int j = 0; j < slices; ++j)
        planes.at(j, i) = Planes::holds_height(j, i) == (i == 0) ? kBeyond : kEnded;
      continue;
    }
    {
      // -F_v/F_X = dx/dv at a fixed height; half of it belongs to the offset, half to the height.
      const double drift = x_at(slice(seed + 1), point.z) - x_at(slice(seed), point.z);
      const bool left_holds_x = !Planes::holds_height(seed, i);
      const double x =
          point.x + (left_holds_x ? -0.25 : 0.25) * (std::isfinite(drift) ? drift : 0.0);
      planes.at(left_holds_x ? seed : seed + 1, i) = x;
      planes.at(left_holds_x ? seed + 1 : seed, i) = z_at(connector(seed), x);
    }
    const auto follow = [&](int from, int to, int k) {
      const double known = planes.at(from, i);
      planes.at(to, i) =
          Planes::holds_height(to, i) ? z_at(connector(k), known) : x_at(connector(k), known);
    };
    for (int j = seed + 2; j < slices; ++j) follow(j - 1, j, j - 1);
    for (int j = seed - 1; j >= 0; --j) follow(j + 1, j, j);
  }
}

/// Ends the levels at the wall (`wall` true) or the ground: a plane that has come too near is dead
/// and set to zero, with all below it (beyond it at the ground). Judged on the exact values.
void end_levels(const RunTarget& target, const Planes& exact, Planes& planes, bool wall) {
  const int slices = target.slices(), n = target.units;
  // At the wall X ends and Z is the partner, at the ground the other way round.
  const auto ends_here = [&](int j, int i) { return Planes::holds_height(j, i) != wall; };
  const auto reach = [&](const SliceCurve& c) { return wall ? c.h() : c.d(); };
  for (int j = 0; j < slices; ++j) {
    int last_dead = wall ? -1 : n + 1;
    for (int i = 0; i <= n; ++i) {
      if (!ends_here(j, i)) continue;
      const double own = exact.at(j, i);
      bool dead = !(own >= target.min_panel_mm);
      for (const int k : {j - 1, j}) {  // the connectors on both sides
        if (k < 0 || k + 1 >= slices) continue;
        const double partner = exact.at(k == j ? j + 1 : j - 1, i);
        const double room = reach(target.connector_curves[static_cast<std::size_t>(k)]) - partner;
        dead = dead || !(room >= target.min_panel_mm);
      }
      if (dead) last_dead = wall ? std::max(last_dead, i) : std::min(last_dead, i);
    }
    for (int i = 0; i <= n; ++i)
      if (ends_here(j, i) && (wall ? i <= last_dead : i >= last_dead)) planes.at(j, i) = 0.0;
  }
}

/// A partner none of whose neighbours is alive is the end of its slice at wall or ground.
void set_ends(const RunTarget& target, const Planes& ended, Planes& planes, bool wall) {
  const int slices = target.slices(), n = target.units;
  for (int j = 0; j < slices; ++j)
    for (int i = 0; i <= n; ++i) {
      if (Planes::holds_height(j, i) != wall) continue;  // partners: Z at the wall, X at the ground
      if (ended.at(j, i) == 0.0) continue;               // has ended on the other side
      bool alive = false;
      for (const int other : {j - 1, j + 1})
        alive = alive || (other >= 0 && other < slices && ended.at(other, i) != 0.0);
      const SliceCurve& own = target.slice_curves[static_cast<std::size_t>(j)];
      if (!alive || !std::isfinite(ended.at(j, i))) planes.at(j, i) = wall ? own.h() : own.d();
    }
}

}  // namespace

Planes lattice_levels(const RunTarget& target, std::optional<double> power) {
  if (target.slices() < 2) return lattice_slices(target);
  Planes exact{target.units, std::vector<double>(target.chain_x.size())};
  const auto circles = [](const std::vector<SliceCurve>& curves) {
    return std::all_of(curves.begin(), curves.end(),
                       [](const SliceCurve& c) { return c.is_circle(); });
  };
  if (circles(target.slice_curves) && circles(target.connector_curves))
    fill_revolution(target, power, exact);
  else
    fill_followed(target, power, exact);
  Planes ended = exact;
  end_levels(target, exact, ended, true);
  end_levels(target, exact, ended, false);
  Planes planes = ended;
  set_ends(target, ended, planes, true);
  set_ends(target, ended, planes, false);
  return planes;
}

}  // namespace popcut
