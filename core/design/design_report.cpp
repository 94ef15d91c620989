// SPDX-License-Identifier: MIT
#include "core/design/design_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/design/strips/closing.hpp"

namespace popcut {
namespace {

void add_errors(ErrorFigures& total, const ErrorFigures& more) {
  const auto squares = [](const ErrorFigures& e) {
    return e.rms_mm * e.rms_mm * static_cast<double>(e.count);
  };
  const double sum = squares(total) + squares(more);
  total.count += more.count;
  total.max_mm = std::max(total.max_mm, more.max_mm);
  total.rms_mm = total.count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(total.count));
}

/// One word where all agree, else all of them.
void add_word(std::string& words, const std::string& word) {
  if (words.empty()) words = word;
  if (words.find(word) == std::string::npos) words += " and " + word;
}

void add_patch(const DesignReport& patch, std::int32_t first_slice, bool alone, DesignReport& r) {
  r.units_per_slice.insert(r.units_per_slice.end(), patch.units_per_slice.begin(),
                           patch.units_per_slice.end());
  double s_mm = 0.0;
  if (!r.slices.empty())
    s_mm = r.slices.back().s_mm + 0.5 * (r.slices.back().width_mm + patch.slices.front().width_mm);
  for (SliceReport slice : patch.slices) {
    slice.s_mm += s_mm;
    accumulate(r.fit, slice.fit);
    r.slices.push_back(slice);
  }
  add_word(r.lattice, patch.lattice);
  add_word(r.lattice_asked, patch.lattice_asked);
  const std::string about = alone ? "" : patch.name + ": ";
  if (!patch.lattice_note.empty())
    r.lattice_note += (r.lattice_note.empty() ? "" : "; ") + about + patch.lattice_note;
  for (const std::string& note : patch.notes) r.notes.push_back(about + note);
  for (MergedPlace place : patch.merged) {
    place.slice += first_slice;
    r.merged.push_back(std::move(place));
  }
  for (BridgeReport bridge : patch.bridges) {
    bridge.slice += first_slice;
    r.bridges.push_back(bridge);
  }
  add_errors(r.inner_error, patch.inner_error);
  add_errors(r.end_error, patch.end_error);
  r.step_over_mean_max = std::max(r.step_over_mean_max, patch.step_over_mean_max);
  r.gap_mm = std::max(r.gap_mm, patch.gap_mm);
  r.fit_nearest = r.fit_nearest || patch.fit_nearest;
}

constexpr double kFloppyShare = 0.25;  ///< of what stands: more that moves makes a useless card

/// A panel that moves, and its middle on the sheet.
struct LoosePanel {
  double moves_mm{}, u_mm{}, v_mm{};
};

/// The panels that move most, above `hands::kFirm_mm`, at most three.
std::vector<LoosePanel> loosest(const Pattern& pattern, const hands::Wobble& wobble) {
  constexpr std::size_t kNamed = 3;
  std::vector<LoosePanel> out;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    if (!(wobble.face_mm[f] > hands::kFirm_mm)) continue;
    LoosePanel panel{wobble.face_mm[f], 0.0, 0.0};
    const auto corners = pattern.face(f);
    for (const std::uint32_t corner : corners) {
      panel.u_mm += pattern.u(pattern.vertices[corner]) / static_cast<double>(corners.size());
      panel.v_mm += pattern.vertices[corner].v / static_cast<double>(corners.size());
    }
    out.push_back(panel);
  }
  std::stable_sort(out.begin(), out.end(), [](const LoosePanel& a, const LoosePanel& b) {
    return a.moves_mm > b.moves_mm;
  });
  out.resize(std::min(out.size(), kNamed));
  return out;
}

}  // namespace

void count_pattern(const Pattern& pattern, DesignReport& report) {
  report.faces = pattern.faces();
  double u_least = pattern.wall_mm, u_most = 0.0;
  for (const SheetLine& line : pattern.lines) {
    const double length = std::hypot(line.u1 - line.u0, line.v1 - line.v0);
    u_least = std::min({u_least, line.u0, line.u1});
    u_most = std::max({u_most, line.u0, line.u1});
    if (line.role == EdgeRole::Slit) ++report.cuts, report.cut_length_mm += length;
    if (line.role == EdgeRole::Outline) report.outline_length_mm += length;
    if (line.role == EdgeRole::Mountain || line.role == EdgeRole::Valley)
      ++report.folds, report.fold_length_mm += length;
  }
  report.sheet_u_mm = u_most - u_least;
  report.sheet_v_mm = pattern.width_mm;
}

void add_hands_of_draft(const Pattern& pattern, DesignReport& report) {
  report.handwork = hands::handwork(pattern);
}

void add_hands(const Pattern& pattern, DesignReport& report) {
  add_hands_of_draft(pattern, report);
  const auto wobble = hands::wobble_of(pattern);
  if (!wobble) return;
  report.wobble = *wobble;
  if (wobble->loose == 0) return;
  const std::vector<LoosePanel> worst = loosest(pattern, *wobble);
  std::string where;
  for (const LoosePanel& panel : worst)
    where += fmt::format("{}{:.1f} mm at u = {:.1f}, v = {:.1f}", where.empty() ? "" : "; ",
                         panel.moves_mm, panel.u_mm, panel.v_mm);
  report.warnings.push_back(
      {.code = "moves_in_paper",
       .message = fmt::format(
           "{} panel{} ({:.0f} % of what stands) move{} by more than {:.0f} mm when folds lie {:g} "
           "mm "
           "off their lines ({}{}): {} folds lie too near to each other to hold {}; make panels "
           "hold at places farther apart",
           wobble->loose, wobble->loose == 1 ? "" : "s", 100.0 * wobble->loose_share,
           wobble->loose == 1 ? "s" : "", hands::kFirm_mm, hands::Play{}.line_mm, where,
           wobble->loose > worst.size() ? "; ..." : "", wobble->loose == 1 ? "its" : "their",
           wobble->loose == 1 ? "it" : "them"),
       .place = {.u_mm = worst.front().u_mm, .v_mm = worst.front().v_mm},
       .spoils = wobble->loose_share > kFloppyShare});
}

void add_closing(const Pattern& pattern, CardShut asked, DesignReport& report) {
  constexpr double kNothing_mm = 1e-6;
  if (!pattern.card) return;
  const double reach = shut_reach_mm(pattern);
  const double out = reach - std::min(pattern.wall_mm, pattern.ground_mm);
  report.sticks_out_mm = out > kNothing_mm ? out : 0.0;
  if (!(out > kNothing_mm)) return;
  const std::string said = fmt::format(
      "shut, the structure reaches {:.1f} mm from the spine and sticks out of the card by {:.1f} "
      "mm",
      reach, out);
  if (asked == CardShut::Free)
    report.notes.push_back(said);
  else
    report.warnings.push_back(
        {.code = "sticks_out",
         .message =
             fmt::format("{}; make wall_mm and ground_mm at least {:.1f} mm, leave them out{}",
                         said, std::ceil(10.0 * reach) / 10.0,
                         report.lattice.find("direct") == std::string::npos
                             ? ", or use \"lattice\": \"direct\", which keeps inside a given card"
                             : ", or use fewer units")});
}

std::string long_step_warning(const DesignReport& report, double most_over_mean) {
  return fmt::format(
      "max_step_over_mean is {:g}, but the longest step, at s = {:.4g} mm, is {:.4g} times the "
      "mean "
      "one; make it at least {:.4g}, {}",
      most_over_mean, report.longest_step_s_mm, report.step_over_mean_max,
      std::ceil(1000.0 * report.step_over_mean_max) / 1000.0,
      report.lattice == "conformal" ? "or use fewer units"
                                    : "or use \"lattice\": \"conformal\", which keeps to it");
}

double shut_reach_mm(std::span<const SliceCurve> target) {
  constexpr int kSamples = 64;
  double reach = 0.0;
  for (const SliceCurve& curve : target)
    for (int k = 0; k <= kSamples; ++k) {
      const CurveJet c = curve.at(-1.0 + 2.0 * k / kSamples);
      reach = std::max(reach, c.x + c.z);
    }
  return reach;
}

std::string flattened_by_card(std::span<const SliceCurve> target, double side_mm,
                              double margin_mm) {
  const double reach = shut_reach_mm(target);
  if (reach <= side_mm - margin_mm) return {};
  return fmt::format(
      "the card flattens the structure: shut, your shape reaches {:.1f} mm from the spine, but "
      "wall_mm and ground_mm less margin_mm leave {:.1f} mm; at least {:.1f} mm of wall and ground "
      "would hold the shape",
      reach, side_mm - margin_mm, std::ceil(10.0 * (reach + margin_mm)) / 10.0);
}

std::vector<double> slice_places(const Strips& strips, std::size_t slices) {
  std::vector<double> place(slices), count(slices);
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Slice && strips.kind[s] != StripKind::Box &&
        strips.kind[s] != StripKind::Blank)
      continue;
    const auto j = static_cast<std::size_t>(strips.slice[s]);
    place[j] += 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]), ++count[j];
  }
  for (std::size_t j = 0; j < slices; ++j) place[j] /= count[j];
  return place;
}

void add_fit(DesignReport& report, FitMode mode) {
  report.fit_nearest = mode == FitMode::Nearest;
  report.fit = {};
  double spread = 0.0;
  std::size_t worst = 0, several = 0, widest = 0;
  for (std::size_t j = 0; j < report.slices.size(); ++j) {
    const SliceReport& slice = report.slices[j];
    accumulate(report.fit, slice.fit);
    if (slice.fit.max_mm > report.slices[worst].fit.max_mm) worst = j;
    several += slice.minima > 1 ? 1 : 0;
    if (slice.spread > spread) spread = slice.spread, widest = j;
  }
  if (report.fit.unreachable_mm > 0.0)
    report.notes.push_back(fmt::format(
        "{:.3g} % of the target's outline is out of reach of falling curves; the seen part is "
        "followed to {:.3g} mm rms, {:.3g} mm at most (slice {})",
        100.0 * unreachable_share(report.fit), report.fit.rms_mm, report.fit.max_mm, worst));
  if (several > 0)
    report.notes.push_back(fmt::format(
        "in {} the steps can settle in more than one place; popcut tried {} starts and "
        "took the one nearest to your shape. The worst would be {:.3g} % farther off "
        "(slice {})",
        several == 1 ? "1 slice" : fmt::format("{} slices", several), 25, 100.0 * spread, widest));
}

DesignReport joined_report(std::span<const Design> patches, const JoinedStrips& joined,
                           const std::vector<BridgeReport>& bridges, const Pattern& pattern) {
  DesignReport r;
  r.step_over_mean_min = patches.front().report.step_over_mean_min;
  r.design_angle_deg = patches.front().report.design_angle_deg;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    add_patch(patches[k].report, joined.first_slice[k], patches.size() == 1, r);
    r.step_over_mean_min = std::min(r.step_over_mean_min, patches[k].report.step_over_mean_min);
  }
  r.bridges.insert(r.bridges.end(), bridges.begin(), bridges.end());
  std::sort(r.bridges.begin(), r.bridges.end(),
            [](const BridgeReport& a, const BridgeReport& b) { return a.slice < b.slice; });
  const std::vector<double> v_mm = slice_places(joined.strips, r.slices.size());
  for (std::size_t j = 0; j < r.slices.size(); ++j) r.slices[j].v_mm = v_mm[j];
  count_pattern(pattern, r);
  r.panels = joined.strips.panels();
  return r;
}

}  // namespace popcut
