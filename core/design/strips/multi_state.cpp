// SPDX-License-Identifier: MIT
#include "core/design/strips/multi_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlopt.h>

#include "core/curvature/vertex_curvature.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {
namespace {

/// The valley of one level on one connector, and where a V-fold on it begins.
struct Crease {
  double x{}, z{}, apex_v_mm{}, length_mm{};
  double room_mm{};  ///< the shorter of the two panels beside it
};

Crease crease_of(const Strips& strips, const SplaySpec& splay, int level, int connector) {
  int seen = 0;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Connector || seen++ != connector) continue;
    const double width = strips.v_begin[s + 1] - strips.v_begin[s];
    const double length = splay.length_mm.value_or(width - 2.0 * splay.ligament_mm);
    for (std::uint32_t p = strips.first_panel[s]; p + 1 < strips.first_panel[s + 1]; ++p) {
      if (strips.level[p] != level || strips.level[p + 1] != level) continue;
      const std::size_t q = p + s;
      return {strips.x[q + 1], strips.z[q + 1], strips.v_begin[s] + 0.5 * (width - length), length,
              std::min(strips.z[q] - strips.z[q + 1], strips.x[q + 2] - strips.x[q + 1])};
    }
  }
  return {};
}

/// The tip of a V-fold of splay `alpha` at `psi_rad` (docs/geometry.md, section 7).
Point3 tip_of(const Crease& crease, double alpha, double psi_rad) {
  const auto o = posed({crease.x, crease.z, crease.apex_v_mm}, psi_rad);
  const double theta = splay_rad(alpha, psi_rad), up = crease.length_mm * std::sin(theta);
  return {o[0] + up * std::cos(0.5 * psi_rad), o[1] + crease.length_mm * std::cos(theta),
          o[2] + up * std::sin(0.5 * psi_rad)};
}

/// A vertex with its ring in the order (level + 1), (connector + 1), (level - 1), (connector - 1).
struct Star {
  std::array<Crease, 5> crease;  ///< the centre first

  [[nodiscard]] double K(const std::array<double, 5>& alpha, double psi_rad) const {
    std::array<Point3, 4> ring;
    for (std::size_t k = 0; k < 4; ++k) ring[k] = tip_of(crease[k + 1], alpha[k + 1], psi_rad);
    return vertex_curvature(tip_of(crease[0], alpha[0], psi_rad), ring).K;
  }
};

Star star_at(const Strips& strips, const SplaySpec& splay, int level, int connector) {
  return {{crease_of(strips, splay, level, connector),
           crease_of(strips, splay, level + 1, connector),
           crease_of(strips, splay, level, connector + 1),
           crease_of(strips, splay, level - 1, connector),
           crease_of(strips, splay, level, connector - 1)}};
}

/// Unknowns: splay of the centre, of the neighbours along the crease, of those across it.
std::array<double, 5> spread(const double* a) { return {a[0], a[2], a[1], a[2], a[1]}; }

struct Problem {
  const Star& star;
  const std::vector<CurvatureTarget>& targets;

  /// How far target k is missed: 0 when met. Values are equations, signs ask for a margin.
  [[nodiscard]] double miss(std::size_t k, const double* a) const {
    const double K = star.K(spread(a), targets[k].psi_rad);
    return targets[k].K_rad ? K - *targets[k].K_rad : targets[k].margin_rad - targets[k].sign * K;
  }
};

/// One target as NLopt sees it: equal to zero, or at most zero.
struct Constraint {
  const Problem* problem{};
  std::size_t target{};
};

double central(const auto& f, const double* a, double* gradient) {
  std::array<double, 3> p{a[0], a[1], a[2]};
  for (std::size_t i = 0; gradient && i < 3; ++i) {
    constexpr double kStep = 1e-6;
    p[i] = a[i] + kStep;
    const double above = f(p.data());
    p[i] = a[i] - kStep;
    gradient[i] = (above - f(p.data())) / (2.0 * kStep);
    p[i] = a[i];
  }
  return f(a);
}

double constraint_of(unsigned, const double* a, double* gradient, void* data) {
  const auto* c = static_cast<const Constraint*>(data);
  return central([c](const double* p) { return c->problem->miss(c->target, p); }, a, gradient);
}

double objective_of(unsigned, const double* a, double* gradient, void*) {
  for (std::size_t i = 0; gradient && i < 3; ++i) gradient[i] = 2.0 * a[i];
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

double worst_miss(const Problem& problem, const double* a) {
  double worst = 0.0;
  for (std::size_t k = 0; k < problem.targets.size(); ++k) {
    const double m = problem.miss(k, a);
    worst = std::max(worst, problem.targets[k].K_rad ? std::abs(m) : m);
  }
  return worst;
}

/// Best alphas from one start, in place; what they still miss.
double improve(const Problem& problem, const std::array<double, 3>& most,
               std::array<double, 3>& a) {
  nlopt_opt opt = nlopt_create(NLOPT_LD_SLSQP, 3);
  const std::array<double, 3> least{};
  nlopt_set_lower_bounds(opt, least.data());
  nlopt_set_upper_bounds(opt, most.data());
  nlopt_set_min_objective(opt, objective_of, nullptr);
  std::vector<Constraint> constraints;
  for (std::size_t k = 0; k < problem.targets.size(); ++k) constraints.push_back({&problem, k});
  for (Constraint& c : constraints)
    (problem.targets[c.target].K_rad
         ? nlopt_add_equality_constraint
         : nlopt_add_inequality_constraint)(opt, constraint_of, &c, 1e-13);
  nlopt_set_xtol_rel(opt, 1e-14);
  nlopt_set_maxeval(opt, 400);
  double value = 0.0;
  (void)nlopt_optimize(opt, a.data(), &value);  // the constraints decide, not its code
  nlopt_destroy(opt);
  return worst_miss(problem, a.data());
}

}  // namespace

double splayed_curvature(const Strips& strips, const SplaySpec& splay, int level, int connector,
                         double psi_rad) {
  const auto alpha = [&](int i, int k) {
    return splay.uniform
               ? *splay.uniform
               : splay.alpha.at(static_cast<std::size_t>(i - 1)).at(static_cast<std::size_t>(k));
  };
  return star_at(strips, splay, level, connector)
      .K({alpha(level, connector), alpha(level + 1, connector), alpha(level, connector + 1),
          alpha(level - 1, connector), alpha(level, connector - 1)},
         psi_rad);
}

Result<MultiState> solve_multi_state(const Strips& strips, const SplaySpec& splay) {
  int levels = 0, connectors = 0;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Connector) continue;
    ++connectors;
    for (std::uint32_t p = strips.first_panel[s]; p + 1 < strips.first_panel[s + 1]; ++p)
      if (strips.level[p] == strips.level[p + 1]) levels = std::max(levels, strips.level[p]);
  }
  if (levels < 3 || connectors < 3)
    return fail(ErrorKind::OutOfRange, "/splay/targets",
                fmt::format("need a vertex with four neighbours: {} inner levels and {} connectors "
                            "are here, three of "
                            "each are the least (4 units, 4 slices)",
                            levels, connectors));
  const int level = (levels + 1) / 2, connector = connectors / 2;
  const Star star = star_at(strips, splay, level, connector);
  const auto fits = [&](const Crease& c) {
    return std::max(0.0, (c.room_mm - splay.ligament_mm) / c.length_mm);
  };
  const std::array<double, 3> most{fits(star.crease[0]),
                                   std::min(fits(star.crease[2]), fits(star.crease[4])),
                                   std::min(fits(star.crease[1]), fits(star.crease[3]))};
  const Problem problem{star, splay.targets};
  constexpr double kMet = 1e-10;
  std::array<double, 3> best{};
  double least_miss = std::numeric_limits<double>::infinity(), least_sum = least_miss;
  for (const double centre : {0.2, 0.5, 0.8})
    for (const double along : {0.0, 0.3, 0.7})
      for (const double across : {0.2, 0.6, 0.95}) {
        std::array<double, 3> a{centre * most[0], along * most[1], across * most[2]};
        const double miss = improve(problem, most, a);
        const double sum = objective_of(3, a.data(), nullptr, nullptr);
        const bool better = miss <= kMet ? least_miss > kMet || sum < least_sum : miss < least_miss;
        if (better) best = a, least_miss = miss, least_sum = sum;
      }
  if (least_miss > kMet)
    return fail(
        ErrorKind::Infeasible, "/splay/targets",
        fmt::format(
            "are not reached by any alphas that fit (at most {:.4g} at the centre, {:.4g} along, "
            "{:.4g} across); "
            "the nearest miss by {:.3g} rad; larger panels, longer V-folds, or other targets",
            most[0], most[1], most[2], least_miss));
  // Splays below this do nothing that a knife could cut.
  constexpr double kNoFold = 1e-6;
  MultiState out{splay, {}};
  out.splay.targets.clear();
  out.splay.alpha.assign(static_cast<std::size_t>(levels),
                         std::vector<double>(static_cast<std::size_t>(connectors)));
  const auto set = [&](int i, int k, double alpha) {
    out.splay.alpha[static_cast<std::size_t>(i - 1)][static_cast<std::size_t>(k)] =
        alpha < kNoFold ? 0.0 : alpha;
  };
  set(level, connector, best[0]);
  set(level, connector - 1, best[1]), set(level, connector + 1, best[1]);
  set(level - 1, connector, best[2]), set(level + 1, connector, best[2]);
  for (const CurvatureTarget& t : splay.targets)
    out.K_rad.push_back(splayed_curvature(strips, out.splay, level, connector, t.psi_rad));
  return out;
}

}  // namespace popcut
