// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "core/curvature/assembly.hpp"
#include "core/curvature/star.hpp"

namespace popcut {
namespace {

constexpr double kLargest = 1e4;  // of r and lambda, when looking for solutions
constexpr double kCentreR = 3.0 / std::numbers::sqrt2;
constexpr double kCentreLambda = 1.0;

/// A point of the (r, lambda) plane.
struct Spot {
  double r{}, lambda{};
};

double distance(Spot p) { return std::hypot(p.r - kCentreR, p.lambda - kCentreLambda); }

bool is_valid(Spot p) { return p.r > 0 && p.lambda > 0 && p.r <= kLargest && p.lambda <= kLargest; }

/// K and H with their slopes by r and lambda.
struct Jet {
  double K{}, K_r{}, K_lambda{};
  double H{}, H_r{}, H_lambda{};
};

Jet jet_at(Spot p, double phi_rad) {
  using Number = star::Dual<2>;
  Number r = p.r, lambda = p.lambda;
  r.by[0] = 1.0;
  lambda.by[1] = 1.0;
  const Number one = 1.0;
  const star::Vec<Number> centre{Number(std::cos(phi_rad)) * r, 0.0, Number(std::sin(phi_rad)) * r};
  const std::array<star::Vec<Number>, 4> ring{{{lambda, one, one + lambda},
                                               {one, -one, 2.0},
                                               {one + lambda, -one, lambda},
                                               {2.0, one, one}}};
  const auto c = star::curvature<Number>(centre, ring);
  return {c.defect.value, c.defect.by[0], c.defect.by[1], c.mean.value, c.mean.by[0], c.mean.by[1]};
}

double K_at(Spot p, double phi_rad) { return curvature_of({p.r, p.lambda, phi_rad}).K; }

// 1. K alone: the nearest point of a curve.

Spot on_ray(double angle, double reach) {
  return {kCentreR + reach * std::cos(angle), kCentreLambda + reach * std::sin(angle)};
}

/// Where K passes the target for the first time along a ray from the centre, between two reaches.
double first_reach(double angle, double low, double high, const AssemblyTarget& target) {
  const bool below = K_at(on_ray(angle, low), target.phi_rad) < target.K;
  constexpr int kHalvings = 80;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    const bool same = (K_at(on_ray(angle, middle), target.phi_rad) < target.K) == below;
    (same ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Newton on `K = K~` and `(p - centre) parallel to grad K`, the slopes of the second by
/// differences.
Spot polished(Spot p, const AssemblyTarget& target) {
  const auto across = [&](Spot q) {
    const Jet j = jet_at(q, target.phi_rad);
    return (q.r - kCentreR) * j.K_lambda - (q.lambda - kCentreLambda) * j.K_r;
  };
  constexpr int kSteps = 12;
  for (int k = 0; k < kSteps; ++k) {
    const Jet j = jet_at(p, target.phi_rad);
    const double h = 1e-6 * std::min(p.r, p.lambda);
    const double side_r = (across({p.r + h, p.lambda}) - across({p.r - h, p.lambda})) / (2 * h);
    const double side_l = (across({p.r, p.lambda + h}) - across({p.r, p.lambda - h})) / (2 * h);
    const double f = j.K - target.K, g = across(p);
    const double det = j.K_r * side_l - j.K_lambda * side_r;
    const Spot next{p.r - (f * side_l - g * j.K_lambda) / det,
                    p.lambda - (g * j.K_r - f * side_r) / det};
    if (!is_valid(next) || !(std::abs(distance(next) - distance(p)) < 0.1 * distance(p))) return p;
    p = next;
  }
  return p;
}

/// Rings about the centre, wider and wider, until one has a point on the other side of the target.
/// Every ray keeps the reach up to which it was on the centre's side.
Result<Spot> nearest_with_K(const AssemblyTarget& target) {
  const double at_centre = K_at({kCentreR, kCentreLambda}, target.phi_rad);
  const bool below = at_centre < target.K;
  constexpr int kRays = 720;
  constexpr double kFirst = 1e-3, kGrowth = 1.02;
  Spot closest{kCentreR, kCentreLambda};
  double closest_K = at_centre;
  for (double last = 0.0, reach = kFirst; reach < kLargest; last = reach, reach *= kGrowth) {
    double best = std::numeric_limits<double>::infinity();
    Spot found;
    for (int ray = 0; ray < kRays; ++ray) {
      const double angle = 2 * std::numbers::pi * ray / kRays;
      const Spot p = on_ray(angle, reach);
      if (!is_valid(p)) continue;
      const double K = K_at(p, target.phi_rad);
      if (std::abs(K - target.K) < std::abs(closest_K - target.K)) closest = p, closest_K = K;
      if ((K < target.K) == below) continue;
      const double first = first_reach(angle, last, reach, target);
      if (first < best) best = first, found = on_ray(angle, first);
    }
    if (std::isfinite(best)) return polished(found, target);
  }
  return fail(ErrorKind::Infeasible, "",
              fmt::format("no r, lambda up to {:g} has K = {:g}; the nearest is K = {:.6g}, at r = "
                          "{:.6g}, lambda = {:.6g}",
                          kLargest, target.K, closest_K, closest.r, closest.lambda));
}

// 2. K and H: two equations, from many starts.

double miss(const Jet& j, const AssemblyTarget& target) {
  return std::hypot(j.K - target.K, j.H - *target.H);
}

/// Damped Newton in the logarithms of r and lambda, which keeps both positive.
Spot newton(Spot p, const AssemblyTarget& target) {
  constexpr int kSteps = 60;
  constexpr double kDone = 1e-15, kLongest = 0.7;
  Jet j = jet_at(p, target.phi_rad);
  for (int k = 0; k < kSteps && miss(j, target) > kDone; ++k) {
    const double f = j.K - target.K, g = j.H - *target.H;
    const double f_r = j.K_r * p.r, f_l = j.K_lambda * p.lambda;
    const double g_r = j.H_r * p.r, g_l = j.H_lambda * p.lambda;
    const double det = f_r * g_l - f_l * g_r;
    double step_r = -(f * g_l - g * f_l) / det, step_l = -(g * f_r - f * g_r) / det;
    if (!std::isfinite(step_r) || !std::isfinite(step_l)) return p;
    const double long_by = std::max(std::abs(step_r), std::abs(step_l)) / kLongest;
    if (long_by > 1) step_r /= long_by, step_l /= long_by;
    bool better = false;
    for (double part = 1.0; part > 1e-6 && !better; part *= 0.5) {
      const Spot next{p.r * std::exp(part * step_r), p.lambda * std::exp(part * step_l)};
      if (!is_valid(next)) continue;
      const Jet there = jet_at(next, target.phi_rad);
      if (!(miss(there, target) < miss(j, target))) continue;
      p = next, j = there, better = true;
    }
    if (!better) return p;
  }
  return p;
}

Result<Spot> nearest_with_K_and_H(const AssemblyTarget& target) {
  constexpr int kStarts = 24;  // a side, from 1e-3 to 1e3 for both
  constexpr double kReached = 1e-11;
  std::optional<Spot> best;
  Spot closest;
  double least = std::numeric_limits<double>::infinity();
  for (int a = 0; a < kStarts; ++a) {
    for (int b = 0; b < kStarts; ++b) {
      const Spot p = newton({std::pow(10.0, -3.0 + 6.0 * a / (kStarts - 1)),
                             std::pow(10.0, -3.0 + 6.0 * b / (kStarts - 1))},
                            target);
      const double off = miss(jet_at(p, target.phi_rad), target);
      if (off < least) least = off, closest = p;
      if (off > kReached) continue;
      constexpr double kTie = 1e-9;  // of equally near ones the larger r
      const double gain = best ? distance(*best) - distance(p) : kTie * 2;
      if (gain > kTie || (std::abs(gain) <= kTie && p.r > best->r + kTie)) best = p;
    }
  }
  if (best) return *best;
  const Jet j = jet_at(closest, target.phi_rad);
  return fail(
      ErrorKind::Infeasible, "",
      fmt::format("no r, lambda up to {:g} has K = {:g} with H = {:g}; the nearest found is "
                  "K = {:.6g}, H = {:.6g}, at r = {:.6g}, lambda = {:.6g}",
                  kLargest, target.K, *target.H, j.K, j.H, closest.r, closest.lambda));
}

}  // namespace

Result<AssemblySolution> solve_assembly(const AssemblyTarget& target) {
  if (!std::isfinite(target.phi_rad) || (target.H && !std::isfinite(*target.H)))
    return fail(ErrorKind::OutOfRange, "", "phi and H must be finite numbers");
  if (!(std::abs(target.K) < 2 * std::numbers::pi)) {
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("K = {:g} is out of reach; an angle defect of four triangles lies "
                            "between -2 pi and 2 pi",
                            target.K));
  }
  const Spot centre{kCentreR, kCentreLambda};
  const Jet there = jet_at(centre, target.phi_rad);
  constexpr double kSame = 1e-14;
  const bool at_centre = std::abs(there.K - target.K) <= kSame &&
                         (!target.H || std::abs(there.H - *target.H) <= kSame);
  const Result<Spot> spot = at_centre  ? Result<Spot>(centre)
                            : target.H ? nearest_with_K_and_H(target)
                                       : nearest_with_K(target);
  if (!spot) return tl::unexpected(spot.error());
  AssemblySolution out;
  out.assembly = {spot->r, spot->lambda, target.phi_rad};
  const bool half_turn = std::abs(target.phi_rad - std::numbers::pi / 4) < 1e-12;
  const Assembly turned{2 * kCentreR - spot->r, 2 * kCentreLambda - spot->lambda, target.phi_rad};
  const bool turned_reaches = !target.H || std::abs(*target.H) < 1e-12;
  constexpr double kItself = 1e-9;
  if (half_turn && turned_reaches && turned.r > 0 && turned.lambda > 0 &&
      distance(*spot) > kItself) {
    out.mirror = turned;
    if (turned.r > out.assembly.r) std::swap(*out.mirror, out.assembly);
  }
  out.reached = curvature_of(out.assembly);
  return out;
}

double assembly_lambda_for(double K) {
  double low = 1.0, high = 2.0;
  const auto least_K = [](double lambda) {
    return curvature_of({(2.0 + lambda) / std::numbers::sqrt2, lambda, std::numbers::pi / 4}).K;
  };
  while (least_K(high) > K && high < 1e12) high *= 2.0;
  constexpr int kHalvings = 200;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (least_K(middle) > K ? low : high) = middle;
  }
  return high;
}

}  // namespace popcut
