// SPDX-License-Identifier: MIT
#include "core/design/chain/augmented_slices.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/curvature/vertex_curvature.hpp"
#include "core/design/chain/augmented_chain.hpp"

namespace popcut {
namespace {

/// Slices `begin .. end` between two plain cuts.
struct UnitRun {
  std::size_t begin{}, end{};
  int units{};
  [[nodiscard]] std::size_t inner() const {
    const std::size_t slices = end - begin;
    return slices < 3 || units < 2 ? 0 : (slices - 2) * (static_cast<std::size_t>(units) - 1);
  }
};

std::vector<UnitRun> stretches_of(const Slicing& slicing) {
  std::vector<UnitRun> out;
  for (std::size_t j = 0; j < slicing.curves.size(); ++j) {
    if (j == 0 || slicing.cut_after[j - 1] != 0) out.push_back({j, j, slicing.units[j]});
    out.back().end = j + 1;
  }
  return out;
}

Result<void> check_lengths(const AugmentedSpec& spec, std::size_t inner) {
  const auto fits = [&](std::size_t count, const char* name) -> Result<void> {
    if (count <= 1 || count == inner) return {};
    return fail(ErrorKind::OutOfRange, fmt::format("/curvature/{}", name),
                fmt::format("has {} values; must have one for all, or {}: one for each inner "
                            "vertex, on levels 1 to units - 1 of each slice between two others",
                            count, inner));
  };
  for (const auto& [count, name] :
       {std::pair{spec.K_area.size(), "K_area"}, std::pair{spec.H.size(), "H"},
        std::pair{spec.first.size(), "first"}, std::pair{spec.second.size(), "second"}})
    if (auto ok = fits(count, name); !ok) return ok;
  return {};
}

/// Collects values and how far they are from what was asked.
class Tally {
 public:
  void add(double value, double miss) {
    if (!std::isfinite(value) || !std::isfinite(miss)) return;
    least_ = std::min(least_, value), largest_ = std::max(largest_, value);
    squares_ += miss * miss, most_ = std::max(most_, std::abs(miss));
    ++count_;
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double least() const { return count_ > 0 ? least_ : 0.0; }
  [[nodiscard]] double largest() const { return count_ > 0 ? largest_ : 0.0; }
  [[nodiscard]] MissFigures miss() const {
    return {count_ > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) : 0.0, most_};
  }

 private:
  double least_{std::numeric_limits<double>::infinity()}, largest_{-least_};
  double squares_{}, most_{};
  std::size_t count_{};
};

constexpr std::size_t kMeasures = 4;
constexpr std::array<const char*, kMeasures> kNames{"K_area", "H", "first", "second"};
constexpr std::array<const char*, kMeasures> kUnits{"1/mm^2", "1/mm", "mm^2", "mm"};
using Tallies = std::array<Tally, kMeasures>;

double norm(double ss, double st, double tt) {
  return std::sqrt(ss * ss + 2.0 * st * st + tt * tt);
}

/// K, H and the forms at all inner vertices of a run's points, against their targets.
void measure_points(const UnitRun& run, const Slicing& slicing, const AugmentedSpec& spec,
                    std::size_t target, Tallies& tallies) {
  const auto at = [&](std::size_t j, std::size_t i) {
    const std::size_t k = slicing.chain_first[j] + i;
    return Point3{slicing.chain_x[k], slicing.s_mm[j], slicing.chain_z[k]};
  };
  const auto levels = static_cast<std::size_t>(run.units);
  for (std::size_t j = run.begin + 1; j + 1 < run.end; ++j)
    for (std::size_t i = 1; i < levels; ++i, ++target) {
      const std::array ring{at(j, i + 1), at(j + 1, i), at(j, i - 1), at(j - 1, i)};
      const std::array corners{at(j + 1, i + 1), at(j + 1, i - 1), at(j - 1, i - 1),
                               at(j - 1, i + 1)};
      const VertexCurvature c = vertex_curvature(at(j, i), ring);
      const FundamentalForms f = grid_forms(at(j, i), ring, corners);
      tallies[0].add(c.K_area,
                     spec.K_area.empty() ? 0.0 : c.K_area - target_of(spec.K_area, target));
      tallies[1].add(c.H, spec.H.empty() ? 0.0 : c.H - target_of(spec.H, target));
      if (!spec.first.empty()) {
        const auto a = target_of(spec.first, target);
        tallies[2].add(f.det_a(), norm(f.a_ss - a[0], f.a_st - a[1], f.a_tt - a[2]));
      }
      if (!spec.second.empty()) {
        const auto b = target_of(spec.second, target);
        tallies[3].add(f.gaussian(), norm(f.b_ss - b[0], f.b_st - b[1], f.b_tt - b[2]));
      }
    }
}

Result<void> solve_run(const UnitRun& run, const AugmentedSpec& spec, std::size_t target,
                       Slicing& slicing, CurvatureReport& report) {
  const std::size_t count = run.end - run.begin;
  const SliceStack stack{std::span(slicing.curves).subspan(run.begin, count),
                         std::span(slicing.s_mm).subspan(run.begin, count), run.units};
  auto solved = solve_chain_augmented(stack, spec, target);
  if (!solved) return tl::unexpected(within("/curvature", solved.error()));
  const auto first = static_cast<std::ptrdiff_t>(slicing.chain_first[run.begin]);
  std::copy(solved->points.x.begin(), solved->points.x.end(), slicing.chain_x.begin() + first);
  std::copy(solved->points.z.begin(), solved->points.z.end(), slicing.chain_z.begin() + first);
  for (std::size_t j = run.begin; j < run.end; ++j) {
    const std::size_t from = slicing.chain_first[j], points = slicing.chain_first[j + 1] - from;
    slicing.figures[j].loss = chain_loss(std::span(slicing.chain_x).subspan(from, points),
                                         std::span(slicing.chain_z).subspan(from, points));
  }
  report.start_mm2 += solved->start.total(), report.end_mm2 += solved->loss.total();
  report.evaluations += solved->evaluations;
  report.out_of_time = report.out_of_time || solved->out_of_time;
  return {};
}

/// The mean of the targets beside a connector, where both slices have some.
std::optional<double> between(const std::vector<double>& list, std::ptrdiff_t left,
                              std::ptrdiff_t right, std::size_t level) {
  if (list.empty() || left < 0 || right < 0) return std::nullopt;
  const auto at = [&](std::ptrdiff_t first) {
    return target_of(list, static_cast<std::size_t>(first) + level - 1);
  };
  return 0.5 * (at(left) + at(right));
}

}  // namespace

Result<void> augment_chains(const AugmentedSpec& spec, Slicing& slicing) {
  CurvatureReport report;
  report.first_target.assign(slicing.curves.size(), -1);
  const std::vector<UnitRun> runs = stretches_of(slicing);
  for (const UnitRun& run : runs) {
    if (run.inner() == 0) report.slices_left_out += static_cast<int>(run.end - run.begin);
    for (std::size_t j = run.begin + 1; run.inner() > 0 && j + 1 < run.end; ++j) {
      report.first_target[j] = static_cast<std::ptrdiff_t>(report.vertices);
      report.vertices += static_cast<std::size_t>(run.units) - 1;
    }
  }
  if (report.vertices == 0)
    return fail(ErrorKind::Infeasible, "/curvature",
                "needs 3 slices or more of 2 units or more without a plain cut between them; use "
                "more slices or units, or leave curvature out");
  if (report.vertices > kMostAugmented)
    return fail(
        ErrorKind::OutOfRange, "/curvature",
        fmt::format("would be solved for {} vertices together; at most {} are, so use fewer "
                    "slices or units",
                    report.vertices, kMostAugmented));
  if (auto ok = check_lengths(spec, report.vertices); !ok) return ok;
  Tallies plain, reached;
  for (const UnitRun& run : runs) {
    if (run.inner() == 0) continue;
    const auto target = static_cast<std::size_t>(report.first_target[run.begin + 1]);
    measure_points(run, slicing, spec, target, plain);
    if (auto done = solve_run(run, spec, target, slicing, report); !done) return done;
    measure_points(run, slicing, spec, target, reached);
  }
  const std::array asked{!spec.K_area.empty(), !spec.H.empty(), !spec.first.empty(),
                         !spec.second.empty()};
  for (std::size_t k = 0; k < kMeasures; ++k) {
    if (k >= 2 && !asked[k]) continue;
    CurvatureFigures figures;
    figures.name = kNames[k], figures.unit = kUnits[k], figures.asked = asked[k];
    figures.least = reached[k].least(), figures.largest = reached[k].largest();
    figures.plain_miss = plain[k].miss(), figures.miss = reached[k].miss();
    report.figures.push_back(std::move(figures));
  }
  slicing.curvature = std::move(report);
  return {};
}

void measure_lattice(const AugmentedSpec& spec, const std::vector<PlacedPlanes>& runs,
                     CurvatureReport& report) {
  Tally K, H;
  for (const PlacedPlanes& run : runs) {
    const std::size_t connectors = run.connector_s.size();
    const auto at = [&](std::size_t k, int i) {
      const SectionPoint p = run.planes->vertex(static_cast<int>(k), i);
      return Point3{p.x, run.connector_s[k], p.z};
    };
    for (std::size_t k = 1; k + 1 < connectors; ++k)
      for (int i = 1; i < run.planes->units; ++i) {
        const std::array ring{at(k, i + 1), at(k + 1, i), at(k, i - 1), at(k - 1, i)};
        if (!(run.connector_s[k + 1] > run.connector_s[k - 1])) continue;
        const std::ptrdiff_t left = report.first_target[static_cast<std::size_t>(run.slice[k])];
        const std::ptrdiff_t right =
            report.first_target[static_cast<std::size_t>(run.slice[k + 1])];
        if (left < 0 || right < 0) continue;
        const VertexCurvature c = vertex_curvature(at(k, i), ring);
        const auto level = static_cast<std::size_t>(i);
        K.add(c.K_area, c.K_area - between(spec.K_area, left, right, level).value_or(c.K_area));
        H.add(c.H, c.H - between(spec.H, left, right, level).value_or(c.H));
      }
  }
  for (CurvatureFigures& figures : report.figures) {
    if (figures.name != "K_area" && figures.name != "H") continue;
    const Tally& found = figures.name == "H" ? H : K;
    figures.lattice_vertices = found.count();
    figures.lattice_least = found.least(), figures.lattice_largest = found.largest();
    figures.lattice_miss = found.miss();
  }
}

std::vector<std::string> curvature_notes(const CurvatureReport& report, LatticeMethod method) {
  std::vector<std::string> notes;
  for (const CurvatureFigures& f : report.figures) {
    if (!f.asked) continue;
    std::string note = fmt::format(
        "curvature: the nearest {} that chains on this target reach misses what is asked by {:.3g} "
        "{} rms, {:.3g} at most; the plain chains by {:.3g} and {:.3g}",
        f.name, f.miss.rms, f.unit, f.miss.max, f.plain_miss.rms, f.plain_miss.max);
    if (f.unit.front() == '1')
      note += fmt::format("; it runs from {:.4g} to {:.4g}", f.least, f.largest);
    if (f.lattice_vertices > 0)
      note += fmt::format(
          "; the lattice's own fold vertices, which mix two slices each, miss it by {:.3g} rms",
          f.lattice_miss.rms);
    notes.push_back(std::move(note));
  }
  if (method == LatticeMethod::Conformal || method == LatticeMethod::Direct)
    notes.push_back(fmt::format(
        "curvature: the {} lattice only starts from the chains and then moves its planes; "
        "\"slices\" and \"branching\" keep them",
        name_of(method)));
  if (method == LatticeMethod::Levels)
    notes.emplace_back(
        "curvature: the levels lattice takes no chains, so the curvature shapes nothing; "
        "\"slices\" and \"branching\" keep them");
  if (report.slices_left_out > 0)
    notes.push_back(
        fmt::format("curvature: {} slices stand in runs of fewer than 3 slices or 2 units and keep "
                    "plain chains",
                    report.slices_left_out));
  if (report.out_of_time)
    notes.emplace_back("curvature: the search was ended after its time; the best found is taken");
  return notes;
}

}  // namespace popcut
