// SPDX-License-Identifier: MIT
#include "core/fit/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/fit/distances.hpp"

namespace popcut {
namespace {

constexpr double kOutside = 1e-6;  ///< of the size: what counts as on the wall or ground
constexpr double kBehind = 0.01;   ///< of the size: what counts as behind an outer part

/// The largest distance near the farthest samples: uphill along the surface `own` that they lie on,
/// in steps that begin at the samples' spacing.
double farthest(const std::vector<Vec3>& points, const std::vector<double>& far,
                const TriangleTree& own, const TriangleTree& to, double spacing_mm) {
  constexpr std::size_t kStarts = 12;
  constexpr int kHalvings = 6, kSteps = 4;
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  const std::size_t starts = std::min(kStarts, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(starts), order.end(),
                    [&](std::uint32_t a, std::uint32_t b) { return far[a] > far[b]; });
  double most = 0.0;
  for (std::size_t s = 0; s < starts; ++s) {
    Vec3 at = points[order[s]];
    double here = far[order[s]], step = spacing_mm;
    std::uint32_t own_hint = TriangleTree::kNone, hint = TriangleTree::kNone;
    for (int k = 0; k < kHalvings; ++k, step *= 0.5)
      for (int n = 0; n < kSteps; ++n) {
        Vec3 better = at;
        double most_here = here;
        for (int i = 0; i < 6; ++i) {
          Vec3 aside = at;
          aside[i / 2] += (i & 1) != 0 ? step : -step;
          const TriangleTree::Nearest on = own.nearest(aside, own_hint);
          const TriangleTree::Nearest there = to.nearest(on.point, hint);
          own_hint = on.place, hint = there.place;
          const double off = std::sqrt(there.squared);
          if (off > most_here) most_here = off, better = on.point;
        }
        if (!(most_here > here)) break;
        here = most_here, at = better;
      }
    most = std::max(most, here);
  }
  return most;
}

DistanceFigures figures_of(std::vector<double> far, double max_mm) {
  DistanceFigures out;
  out.samples = far.size();
  if (far.empty()) return out;
  double sum = 0.0, squares = 0.0;
  for (const double d : far) sum += d, squares += d * d;
  const auto count = static_cast<double>(far.size());
  out.mean_mm = sum / count;
  out.rms_mm = std::sqrt(squares / count);
  const std::size_t at = std::min(far.size() - 1, far.size() * 19 / 20);
  std::nth_element(far.begin(), far.begin() + static_cast<std::ptrdiff_t>(at), far.end());
  out.p95_mm = far[at];
  out.max_mm = max_mm;
  return out;
}

double spacing_of(double area_mm2, std::size_t samples) {
  return std::sqrt(area_mm2 / static_cast<double>(samples));
}

}  // namespace

double FitFigures::two_sided_rms_mm() const {
  return std::sqrt(
      0.5 * (to_target.rms_mm * to_target.rms_mm + to_structure.rms_mm * to_structure.rms_mm));
}

FitTarget::FitTarget(TriangleSoup target, const SampleDensity& density, const DesignAngle& opening)
    : tree_(target),
      opening_(opening),
      density_(density),
      area_mm2_(area_of(target)),
      size_mm_(diagonal_of(target)),
      samples_(area_samples(target, samples_of(area_mm2_, density))) {
  if (opening.is_right()) return;
  for (std::size_t k = 0; k < target.corners.size(); k += 3)
    opening.to_oblique(target.corners[k], target.corners[k + 2]);
  section_tree_.emplace(target);
}

/// A structure, with the distances between it and the target.
struct FitTarget::Sampled {
  TriangleTree tree;
  double area_mm2{};
  std::vector<Vec3> points;
  std::vector<double> to_target;     ///< of `points`
  std::vector<double> to_structure;  ///< of the target's samples
};

FitTarget::Sampled FitTarget::sample(const TriangleSoup& structure) const {
  Sampled out{TriangleTree(structure), area_of(structure), {}, {}, {}};
  out.points = area_samples(structure, samples_of(out.area_mm2, density_));
  if (is_empty() || out.points.empty()) return out;
  out.to_target = distances(out.points, tree_);
  out.to_structure = distances(samples_, out.tree);
  return out;
}

FitFigures FitTarget::measure_roughly(const TriangleSoup& structure) const {
  Sampled sampled = sample(structure);
  FitFigures out;
  out.size_mm = size_mm_, out.target_mm2 = area_mm2_, out.structure_mm2 = sampled.area_mm2;
  if (sampled.to_target.empty()) return out;
  const auto most = [](const std::vector<double>& far) {
    return *std::max_element(far.begin(), far.end());
  };
  const double to_target = most(sampled.to_target), to_structure = most(sampled.to_structure);
  out.to_target = figures_of(std::move(sampled.to_target), to_target);
  out.to_structure = figures_of(std::move(sampled.to_structure), to_structure);
  return out;
}

FitFigures FitTarget::measure(const TriangleSoup& structure) const {
  Sampled sampled = sample(structure);
  FitFigures out;
  out.size_mm = size_mm_, out.target_mm2 = area_mm2_, out.structure_mm2 = sampled.area_mm2;
  if (sampled.to_target.empty()) return out;
  for (std::size_t w = 0; w < FitFigures::kWithin.size(); ++w) {
    const double near = FitFigures::kWithin[w] * size_mm_;
    const auto share = [&](const std::vector<double>& far) {
      const auto within =
          std::count_if(far.begin(), far.end(), [&](double d) { return d <= near; });
      return static_cast<double>(within) / static_cast<double>(far.size());
    };
    out.share_within[w] = share(sampled.to_structure);
    out.structure_within[w] = share(sampled.to_target);
  }
  const double spacing = spacing_of(sampled.area_mm2, sampled.points.size());
  const double to_target =
      farthest(sampled.points, sampled.to_target, sampled.tree, tree_, spacing);
  const double to_structure = farthest(samples_, sampled.to_structure, tree_, sampled.tree,
                                       spacing_of(area_mm2_, samples_.size()));
  out.to_target = figures_of(std::move(sampled.to_target), to_target);
  out.to_structure = figures_of(std::move(sampled.to_structure), to_structure);
  add_out_of_reach(structure, out.out_of_reach);
  return out;
}

void FitTarget::add_out_of_reach(const TriangleSoup& structure, OutOfReach& out) const {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 1; k < structure.corners.size(); k += 3) {
    low = std::min(low, structure.corners[k]);
    high = std::max(high, structure.corners[k]);
  }
  const double touch = kOutside * size_mm_, behind = kBehind * size_mm_;
  const double each = 1.0 / static_cast<double>(samples_.size());
  const TriangleTree& section = section_tree_ ? *section_tree_ : tree_;
  for (const Vec3& sample : samples_) {
    Vec3 p = sample;
    if (section_tree_) opening_.to_oblique(p[0], p[2]);
    if (p[0] < -touch || p[2] < -touch)
      out.outside_of_the_corner += each;
    else if (p[1] < low - touch || p[1] > high + touch)
      out.beyond_the_slices += each;
    else if (section.any_beyond(Vec3(p[0] + behind, p[1], p[2] + behind)))
      out.overhang += each;
  }
}

}  // namespace popcut
