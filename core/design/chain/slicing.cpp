// SPDX-License-Identifier: MIT
#include "core/design/chain/slicing.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/design/chain/augmented_slices.hpp"
#include "core/design/target/strip_cut.hpp"
#include "core/design/target/surface.hpp"

namespace popcut {
namespace {

constexpr double kMostSpan = 1e5;     ///< 100 m: no sheet is larger
constexpr double kLeastWidth = 1e-3;  ///< a micrometre: no knife is finer

/// Widths chosen from the target's curvature along the spine, and what that saved.
struct ChosenWidths {
  std::vector<double> widths_mm;
  int uniform_slices{};  ///< equal slices that the same error and length would take
};

/// Largest distance of the curves between two places from the straight line between the curves
/// there, mm, looked at a quarter, a half and three quarters of the way.
Result<double> bulge(const Surface& surface, double from_mm, double to_mm) {
  const auto a = surface.slice(from_mm), b = surface.slice(to_mm);
  for (const auto* curve : {&a, &b})
    if (!*curve) return tl::unexpected(curve->error());
  constexpr int kSamples = 16;
  double most = 0.0;
  for (const double share : {0.25, 0.5, 0.75}) {
    const auto m = surface.slice(from_mm + share * (to_mm - from_mm));
    if (!m) return tl::unexpected(m.error());
    for (int i = 0; i <= kSamples; ++i) {
      const double t = -1.0 + 2.0 * i / kSamples;
      const CurveJet p = a->at(t), q = m->at(t), r = b->at(t);
      most = std::max(most, std::hypot(q.x - (1.0 - share) * p.x - share * r.x,
                                       q.z - (1.0 - share) * p.z - share * r.z));
    }
  }
  return most;
}

/// One pass from slice 0 outward; `error_mm` may be tighter than what was asked for.
Result<ChosenWidths> walk(const Surface& surface, const AdaptiveWidths& adaptive, double error,
                          int most_slices, double least) {
  // Distance from slice to slice is (w_j + w_(j+1))/2, so a width follows from the pitch to it.
  const auto fits = [&](double s, double pitch) {
    const auto b = bulge(surface, s, s + pitch);
    return b && *b <= error;
  };
  const auto longest = [&](double s, double low, double high) {
    if (fits(s, high)) return high;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (fits(s, middle) ? low : high) = middle;
    }
    return low;
  };
  if (!fits(0.0, least)) {
    const auto b = bulge(surface, 0.0, least);
    if (!b) return tl::unexpected(b.error());
    return fail(
        ErrorKind::Infeasible, "/widths_mm/max_error_mm",
        fmt::format("is {:g} mm; even slices of {:g} mm (4 min_panel_mm) are off by {:.3g} mm",
                    error, least, *b));
  }
  const double size = surface.slice(0.0)->h();
  ChosenWidths out;
  double s = 0.0, narrowest = longest(0.0, least, size);
  out.widths_mm.push_back(narrowest);
  while (static_cast<int>(out.widths_mm.size()) < most_slices) {
    const double w = out.widths_mm.back();
    if (adaptive.length_mm && s + 0.5 * w >= *adaptive.length_mm) break;
    const double low = 0.5 * (w + std::max(least, 0.5 * w)),
                 high = std::max(low, std::min(1.5 * w, size));
    double pitch = longest(s, low, high);
    if (!fits(s, pitch)) {
      // The last width was too bold for what follows: take it back by half, down to the thinnest.
      if (w <= least * 1.0001)
        return fail(
            ErrorKind::Infeasible, "/widths_mm/max_error_mm",
            fmt::format("is {:g} mm; at s = {:.6g} mm even slices of {:g} mm are farther off",
                        error, s, least));
      out.widths_mm.back() = std::max(least, 0.5 * w);
      if (out.widths_mm.size() > 1) s -= 0.5 * (w - out.widths_mm.back());
      continue;
    }
    narrowest = std::min(narrowest, pitch);
    out.widths_mm.push_back(2.0 * pitch - w);
    s += pitch;
  }
  const double length = s + 0.5 * out.widths_mm.back();
  if (adaptive.length_mm && length < *adaptive.length_mm)
    return fail(ErrorKind::Infeasible, "/slices",
                fmt::format("{} slices reach {:.4g} of {:g} mm at that error; more slices, or a "
                            "larger max_error_mm",
                            most_slices, length, *adaptive.length_mm));
  out.uniform_slices = std::max(static_cast<int>(std::ceil(length / narrowest)),
                                static_cast<int>(out.widths_mm.size()));
  return out;
}

/// Whether every pitch keeps to the error: a pitch is made shorter when its neighbour needs it, and
/// a shorter one may bulge more where the target waves.
bool keeps(const Surface& surface, const ChosenWidths& chosen, double error) {
  double s = 0.0;
  for (std::size_t j = 1; j < chosen.widths_mm.size(); ++j) {
    const double pitch = 0.5 * (chosen.widths_mm[j - 1] + chosen.widths_mm[j]);
    const auto b = bulge(surface, s, s + pitch);
    if (!b || *b > error) return false;
    s += pitch;
  }
  return true;
}

/// Chooses widths so that the target between neighbouring slices bulges at most
/// `adaptive.max_error_mm` from the straight line between their curves (its sagitta, |r''| w^2 / 8
/// for a radius r). Each width is the largest that keeps to it, at most twice or half its
/// neighbour.
///
/// @param most_slices  how many slices there are, or may be where a length is asked for
/// @retval Infeasible  the length takes more slices than that, or slices thinner than 4 min_panel
Result<ChosenWidths> choose_widths(const Surface& surface, const AdaptiveWidths& adaptive,
                                   int most_slices, double min_panel_mm) {
  double error = adaptive.max_error_mm;
  Result<ChosenWidths> chosen = fail(ErrorKind::Internal, "", "");
  for (int round = 0; round < 20; ++round, error *= 0.8) {
    chosen = walk(surface, adaptive, error, most_slices, 4.0 * min_panel_mm);
    if (!chosen || keeps(surface, *chosen, adaptive.max_error_mm)) return chosen;
  }
  return fail(
      ErrorKind::Infeasible, "/widths_mm/max_error_mm",
      "the target waves too fast for widths chosen from its curvature; give a list of widths");
}

/// Checks the widths of a sheet: each wide enough to be distinct, all together not too wide.
Result<void> check_widths(const std::vector<double>& widths_mm,
                          const std::vector<RegionSpec>& regions) {
  double sum = 0.0;
  std::size_t r = 0, end = static_cast<std::size_t>(regions.front().slices);
  const std::string field = regions.size() == 1 ? "/widths_mm" : "/regions";
  for (std::size_t j = 0; j < widths_mm.size(); ++j) {
    while (j >= end && r + 1 < regions.size()) end += static_cast<std::size_t>(regions[++r].slices);
    sum += widths_mm[j];
    if (widths_mm[j] < kLeastWidth)
      return fail(ErrorKind::OutOfRange,
                  regions.size() == 1 ? field : fmt::format("/regions/{}", r),
                  fmt::format("slice {} is {:g} mm wide; at least {:g} mm is needed", j,
                              widths_mm[j], kLeastWidth));
  }
  if (sum > kMostSpan)
    return fail(ErrorKind::OutOfRange, field,
                fmt::format("the slices are {:g} mm wide in all; at most {:g} mm is designed", sum,
                            kMostSpan));
  return {};
}

/// A region's stretch of the target. Its own surface takes places from the region's start, the
/// common one from slice 0.
struct RegionCut {
  const Surface* surface{};
  double origin_mm{};
  int first{}, count{}, units{};
};

Result<void> cut_slice(const RegionCut& stretch, double s, double min_panel_mm, int j,
                       Slicing& out) {
  const double least_mm = 2.0 * min_panel_mm;
  auto strip = cut_strip(*stretch.surface, s - stretch.origin_mm,
                         out.width_mm[static_cast<std::size_t>(j)], least_mm);
  if (!strip) return tl::unexpected(strip.error());
  if (strip->s_mm != s - stretch.origin_mm)
    out.moved.emplace_back(j, strip->s_mm + stretch.origin_mm);
  SurfaceSlice* const cut = &strip->slice;
  SliceCurve* const curve = &cut->curve;
  if (curve->h() < least_mm || curve->d() < least_mm)
    return fail(ErrorKind::Infeasible, fmt::format("/surface at slice {} (s = {:.6g} mm)", j, s),
                fmt::format("the target spans only {:.4g} x {:.4g} mm there, no room for panels of "
                            "min_panel_mm = {:g}; use a larger scale_mm or fewer slices",
                            curve->d(), curve->h(), min_panel_mm),
                ErrorReason::Misplaced);
  if (!(curve->h() <= kMostSpan) || !(curve->d() <= kMostSpan))
    return fail(
        ErrorKind::OutOfRange, fmt::format("/surface at slice {} (s = {:.6g} mm)", j, s),
        fmt::format("the target spans {:.4g} x {:.4g} mm there; at most {:g} mm is designed, "
                    "use a smaller scale_mm",
                    curve->d(), curve->h(), kMostSpan));
  out.fits.push_back(cut->fit);
  out.curves.push_back(std::move(*curve));
  out.blank.emplace_back();
  return {};
}

void add_blank(const Error& why, Slicing& out) {
  out.fits.emplace_back();
  out.curves.emplace_back(1.0, 1.0);  // until another one is known
  out.blank.push_back(why.detail.substr(0, why.detail.find("; ")));
  out.units[out.curves.size() - 1] = 0;
}

/// Sets blank slices apart from the others and gives them a curve of the target's size.
///
/// @param first  why the first blank slice is, none where no slice is blank
Result<void> part_blank(const std::optional<Error>& first, bool is_patch, Slicing& out) {
  if (!first) return {};
  const auto made = std::find_if(out.blank.begin(), out.blank.end(),
                                 [](const std::string& why) { return why.empty(); });
  if (made == out.blank.end()) {
    Error error = *first;
    error.kind = ErrorKind::Infeasible;
    if (out.slices() > 1)
      error.detail += fmt::format("; all {} slices are like that", out.slices());
    return tl::unexpected(std::move(error));
  }
  if (is_patch && (out.is_blank(0) || out.is_blank(out.blank.size() - 1)))
    return fail(ErrorKind::Infeasible, "/surface",
                fmt::format("the {} slice would be blank ({}); a patch must have a slice at each "
                            "edge, for its neighbour",
                            out.is_blank(0) ? "first" : "last",
                            out.is_blank(0) ? out.blank.front() : out.blank.back()));
  const SliceCurve some = out.curves[static_cast<std::size_t>(made - out.blank.begin())];
  for (std::size_t j = 0; j < out.blank.size(); ++j) {
    if (!out.is_blank(j)) continue;
    out.curves[j] = some;
    out.cut_after[j] = 1;
    if (j > 0) out.cut_after[j - 1] = 1;
  }
  return {};
}

Result<void> solve_chains(const DesignSpec& spec, Slicing& out, const Progress& progress) {
  out.chain_first.push_back(0);
  for (const int units : out.units)
    out.chain_first.push_back(out.chain_first.back() +
                              (units > 0 ? static_cast<std::size_t>(units) + 1 : 0));
  out.chain_x.resize(out.chain_first.back());
  out.chain_z.resize(out.chain_first.back());
  ChainSolver solver;
  SlsqpBudget budget;
  for (std::size_t j = 0; j < out.curves.size(); ++j) {
    tell(progress, "fitting steps to the slices",
         static_cast<double>(j) / static_cast<double>(out.curves.size()));
    if (out.is_blank(j)) {
      out.figures.emplace_back();
      continue;
    }
    const std::size_t first = out.chain_first[j], points = out.chain_first[j + 1] - first;
    const std::span x(out.chain_x.data() + first, points), z(out.chain_z.data() + first, points);
    auto figures = spec.solver == SolverMethod::Slsqp
                       ? solve_chain_slsqp(out.curves[j], out.units[j], x, z, budget)
                       : solver.solve(out.curves[j], out.units[j], x, z);
    if (!figures) {
      Error error = within(fmt::format("slice {}", j), figures.error());
      if (error.kind == ErrorKind::Timeout)  // no device is late here: the spec asks for too much
        error = {ErrorKind::OutOfRange, fmt::format("/solver at slice {}", j), error.detail};
      return tl::unexpected(std::move(error));
    }
    out.figures.push_back(*figures);
  }
  if (spec.curvature) tell(progress, "fitting the curvature");
  if (spec.curvature) return augment_chains(*spec.curvature, out);
  return {};
}

/// The target itself, stretch by stretch; neighbours on the same surface are one piece.
void add_pieces(const std::vector<RegionCut>& stretches, Slicing& out) {
  for (const RegionCut& here : stretches) {
    const auto first = static_cast<std::size_t>(here.first);
    const bool goes_on = here.first > 0 && (&here - 1)->surface == here.surface;
    if (goes_on) continue;
    TargetPiece piece{*here.surface, here.origin_mm};
    if (here.first > 0) {
      piece.from_mm = out.s_mm[first] - 0.5 * out.width_mm[first];
      out.pieces.back().to_mm = piece.from_mm;
    }
    out.pieces.push_back(std::move(piece));
  }
}

/// The target where a patch ends and its neighbour begins.
void add_edges(const RegionCut& first, const RegionCut& last, Slicing& out) {
  const auto add = [&](const RegionCut& stretch, double s, const SliceCurve& own) {
    const auto curve = stretch.surface->slice(s - stretch.origin_mm);
    out.edges.push_back(curve ? *curve : own);
  };
  add(first, out.s_mm.front() - 0.5 * out.width_mm.front(), out.curves.front());
  add(last, out.s_mm.back() + 0.5 * out.width_mm.back(), out.curves.back());
}

}  // namespace

Result<Slicing> slice_target(const DesignSpec& spec, const SurfaceAssets& assets,
                             const Progress& progress) {
  tell(progress, "reading the shape");
  std::optional<Surface> common;
  if (spec.surface) {
    auto made = Surface::make(*spec.surface, spec.placement, spec.fit, assets);
    if (!made) return tl::unexpected(made.error());
    common = std::move(*made);
  }
  Slicing out;
  out.width_mm = spec.widths_mm;
  if (common) out.notes = common->notes;
  std::vector<RegionSpec> regions = spec.regions;
  if (spec.adaptive) {  // then there is one region, on the common surface
    auto chosen = choose_widths(*common, *spec.adaptive, regions.front().slices, spec.min_panel_mm);
    if (!chosen) return tl::unexpected(chosen.error());
    out.width_mm = std::move(chosen->widths_mm);
    out.uniform_slices = chosen->uniform_slices;
    regions.front().slices = static_cast<int>(out.width_mm.size());
  }
  if (auto valid = check_widths(out.width_mm, regions); !valid)
    return tl::unexpected(valid.error());
  std::vector<Surface> own;
  own.reserve(regions.size());
  std::vector<RegionCut> stretches;
  double s = 0.0;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const RegionSpec& region = regions[r];
    RegionCut stretch{common ? &*common : nullptr, 0.0, out.slices(), region.slices,
                      region.units_per_slice};
    double length = 0.0;
    for (int k = 0; k < region.slices; ++k) {
      const std::size_t j = out.s_mm.size();
      if (j > 0) s += 0.5 * (out.width_mm[j - 1] + out.width_mm[j]);
      if (k == 0) stretch.origin_mm = s - 0.5 * out.width_mm[j];
      length += out.width_mm[j];
      out.s_mm.push_back(s);
      out.units.push_back(region.units_per_slice);
    }
    if (region.radius) {
      auto made = Surface::make(RevolutionSpec{*region.radius, length / spec.placement.scale_mm},
                                spec.placement, spec.fit);
      if (!made) return tl::unexpected(within(fmt::format("/regions/{}", r), made.error()));
      own.push_back(std::move(*made));
      stretch.surface = &own.back();
    } else {
      stretch.origin_mm = 0.0;
    }
    stretches.push_back(stretch);
  }
  std::optional<Error> first_blank;
  for (std::size_t r = 0; r < stretches.size(); ++r) {
    const RegionCut& here = stretches[r];
    for (int j = here.first; j < here.first + here.count; ++j) {
      const auto k = static_cast<std::size_t>(j);
      tell(progress, "cutting the shape into slices",
           static_cast<double>(k) / static_cast<double>(out.s_mm.size()));
      if (auto cut = cut_slice(here, out.s_mm[k], spec.min_panel_mm, j, out); !cut) {
        if (!spec.card || !is_nothing_there(cut.error())) return tl::unexpected(cut.error());
        if (!first_blank) first_blank = cut.error();
        add_blank(cut.error(), out);
      }
      const bool last_here = j + 1 == here.first + here.count;
      if (last_here && r + 1 == stretches.size()) break;
      const double between = out.s_mm[k] + (3.0 * out.width_mm[k] + out.width_mm[k + 1]) / 8.0;
      // A connector across a border belongs to the region that it lies in.
      const bool beyond =
          last_here && stretches[r + 1].origin_mm > 0.0 && between > stretches[r + 1].origin_mm;
      const RegionCut& owner = beyond ? stretches[r + 1] : here;
      const bool cut_here = last_here && stretches[r + 1].units != here.units;
      out.cut_after.push_back(cut_here ? 1 : 0);
      out.between_s_mm.push_back(between);
      Result<SliceCurve> curve = out.curves.back();  // what a bridge aims at
      if (auto strip =
              cut_strip(*owner.surface, between - owner.origin_mm,
                        0.25 * (out.width_mm[k] + out.width_mm[k + 1]), 2.0 * spec.min_panel_mm))
        curve = std::move(strip->slice.curve);
      else if (is_nothing_there(strip.error()))
        out.cut_after.back() = cut_here || spec.card ? 1 : 0;
      else if (!cut_here)
        curve = tl::unexpected(strip.error());
      if (!curve) return tl::unexpected(curve.error());
      out.between.push_back(std::move(*curve));
    }
  }
  out.cut_after.push_back(0);
  if (auto parted = part_blank(first_blank, spec.is_patch, out); !parted)
    return tl::unexpected(parted.error());
  add_pieces(stretches, out);
  if (spec.is_patch) add_edges(stretches.front(), stretches.back(), out);
  if (auto solved = solve_chains(spec, out, progress); !solved)
    return tl::unexpected(solved.error());
  return out;
}

}  // namespace popcut
