// SPDX-License-Identifier: MIT
#include "core/design/shape_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/design_angle.hpp"

namespace popcut {
namespace {

/// Of the middle panel's length: chords of formulas stray no farther, a hundredth of what the
/// panels themselves are off.
constexpr double kChord = 0.003;

/// Whether a panel is part of the card itself, or a cut.
bool is_card(PlaneId plane) {
  return plane == kWallPlane || plane == kGroundPlane || plane == kNoPlane;
}

/// Triangles of a soup whose middles lie in a stretch of the spine.
void keep_between(double from_mm, double to_mm, TriangleSoup& soup) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < soup.size(); ++t) {
    const auto begin = soup.corners.begin() + 9 * static_cast<std::ptrdiff_t>(t);
    const double middle = (begin[1] + begin[4] + begin[7]) / 3.0;
    if (!(middle >= from_mm && middle <= to_mm)) continue;
    std::copy(begin, begin + 9, soup.corners.begin() + 9 * static_cast<std::ptrdiff_t>(kept++));
  }
  soup.corners.resize(9 * kept);
}

/// The triangle that a V-fold takes from a panel: from the apex on its crease at `begin_mm` to
/// `share` of the panel's length at `end_mm`, along the sheet.
struct Notch {
  double begin_mm{}, end_mm{}, share{};
  bool at_end{};  ///< the crease is where the panel ends, away from the wall
};

/// By panel: the one before a V-fold's crease and the one after it.
std::unordered_map<std::uint32_t, Notch> notches_of(const Strips& strips, const Pattern& pattern) {
  std::unordered_map<std::uint32_t, Notch> out;
  for (const VFold& fold : pattern.v_folds) {
    const PatternVertex &apex = pattern.vertices[fold.apex], &tip = pattern.vertices[fold.tip];
    const auto after = std::upper_bound(strips.v_begin.begin(), strips.v_begin.end(), apex.v);
    const auto k = static_cast<std::size_t>(after - strips.v_begin.begin()) - 1;
    for (std::uint32_t p = strips.first_panel[k]; p + 1 < strips.first_panel[k + 1]; ++p) {
      const std::size_t q = p + k + 1;  // between the panels p and p + 1
      if (strips.x[q] != apex.x || strips.z[q] != apex.z) continue;
      const double side = fold.length_mm * fold.alpha;
      out[p] = {apex.v, tip.v, side / (strips.z[q - 1] - strips.z[q]), true};
      out[p + 1] = {apex.v, tip.v, side / (strips.x[q + 1] - strips.x[q]), false};
      break;
    }
  }
  return out;
}

/// The triangles of V-folds as they stand when they have popped.
void add_v_folds(const Pattern& pattern, const SpineMap& along, TriangleSoup& out) {
  const auto places = posed_vertices(pattern, pattern.design_psi_rad);
  const auto at = [&](std::uint32_t vertex) {
    return Vec3(places[vertex][0], along(places[vertex][1]), places[vertex][2]);
  };
  for (const VFold& fold : pattern.v_folds)
    for (const std::uint32_t side : {fold.edge_b, fold.edge_c})
      out.add(at(fold.apex), at(fold.tip), at(pattern.edges[side].to));
}

/// The kite on which a place of a strip lies, or none.
const KiteSection* kite_at(const Pattern& pattern, double v_mm, double x_mm, double z_mm) {
  for (const Kite& kite : pattern.kites)
    if (v_mm > kite.v0_mm && v_mm < kite.v1_mm && kite.section.has(x_mm, z_mm))
      return &kite.section;
  return nullptr;
}

/// Piecewise linear through the points (from, to), and on with slope 1 beyond them.
double mapped(const std::vector<double>& from, const std::vector<double>& to, double at) {
  if (from.empty()) return at;
  const auto after =
      static_cast<std::size_t>(std::upper_bound(from.begin(), from.end(), at) - from.begin());
  if (after == 0) return to.front() + (at - from.front());
  if (after == from.size()) return to.back() + (at - from.back());
  const double share = (at - from[after - 1]) / (from[after] - from[after - 1]);
  return to[after - 1] + share * (to[after] - to[after - 1]);
}

/// Two digits, never in powers of ten.
std::string mm_in_words(double mm) {
  return mm >= 10.0 ? fmt::format("{:.0f} mm", mm) : fmt::format("{:.2g} mm", mm);
}

std::string share_in_words(double share) {
  const double percent = 100.0 * share;
  if (percent > 99.5 && percent < 100.0) return fmt::format("{:.1f} %", std::min(percent, 99.9));
  return fmt::format("{:.0f} %", percent);
}

}  // namespace

SpineMap::SpineMap(const Strips& strips, std::span<const double> s_mm) {
  std::vector<double> place(s_mm.size()), count(s_mm.size());
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Slice && strips.kind[s] != StripKind::Box) continue;
    const auto j = static_cast<std::size_t>(strips.slice[s]);
    place[j] += 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]), ++count[j];
  }
  for (std::size_t j = 0; j < s_mm.size(); ++j)
    if (count[j] > 0.0) v_.push_back(place[j] / count[j]), s_.push_back(s_mm[j]);
}

double SpineMap::operator()(double v_mm) const { return mapped(v_, s_, v_mm); }

double SpineMap::place_on_sheet(double s_mm) const { return mapped(s_, v_, s_mm); }

TriangleSoup structure_triangles(const Strips& strips, const Pattern& pattern,
                                 const SpineMap& along) {
  TriangleSoup out;
  out.corners.reserve(18 * strips.panels());
  const auto [c, s] = DesignAngle::of_rad(pattern.design_psi_rad);
  const std::unordered_map<std::uint32_t, Notch> notches = notches_of(strips, pattern);
  for (std::size_t k = 0; k < strips.size(); ++k) {
    if (strips.kind[k] == StripKind::Margin) continue;
    const double from = along(strips.v_begin[k]), to = along(strips.v_begin[k + 1]);
    for (std::uint32_t p = strips.first_panel[k]; p < strips.first_panel[k + 1]; ++p) {
      if (is_card(strips.plane[p])) continue;
      const std::size_t q = p + k;
      double x0 = strips.x[q] + strips.z[q] * c, z0 = strips.z[q] * s;
      double x1 = strips.x[q + 1] + strips.z[q + 1] * c, z1 = strips.z[q + 1] * s;
      if (const KiteSection* kite = kite_at(
              pattern, 0.5 * (strips.v_begin[k] + strips.v_begin[k + 1]),
              0.5 * (strips.x[q] + strips.x[q + 1]), 0.5 * (strips.z[q] + strips.z[q + 1]))) {
        const KitePoint a = kite->posed(strips.x[q], strips.z[q], pattern.design_psi_rad),
                        b = kite->posed(strips.x[q + 1], strips.z[q + 1], pattern.design_psi_rad);
        x0 = a.x, z0 = a.z, x1 = b.x, z1 = b.z;
      }
      const auto found = notches.find(p);
      if (found == notches.end()) {
        out.add({x0, from, z0}, {x1, from, z1}, {x1, to, z1}, {x0, to, z0});
        continue;
      }
      // Before the V-fold, beside it, and after it.
      const Notch& notch = found->second;
      const double apex = along(notch.begin_mm), end = along(notch.end_mm);
      const double near = notch.at_end ? 1.0 : 0.0,
                   side = notch.at_end ? 1.0 - notch.share : notch.share;
      const auto at = [&](double share, double v) {
        return Vec3(x0 + share * (x1 - x0), v, z0 + share * (z1 - z0));
      };
      out.add(at(0, from), at(1, from), at(1, apex), at(0, apex));
      out.add(at(near, apex), at(side, end), at(1.0 - near, end), at(1.0 - near, apex));
      out.add(at(0, end), at(1, end), at(1, to), at(0, to));
    }
  }
  if (!pattern.v_folds.empty()) add_v_folds(pattern, along, out);
  return out;
}

TriangleSoup target_triangles(const Strips& strips, const SpineMap& along,
                              const DesignReport& report, std::span<const TargetPiece> target,
                              double least_chord) {
  double from = std::numeric_limits<double>::infinity(), to = -from;
  double reach_x = 0.0, reach_z = 0.0;
  for (std::size_t k = 0; k < strips.size(); ++k) {
    if (strips.kind[k] == StripKind::Margin) continue;
    from = std::min(from, along(strips.v_begin[k]));
    to = std::max(to, along(strips.v_begin[k + 1]));
    for (std::uint32_t p = strips.first_panel[k]; p < strips.first_panel[k + 1]; ++p) {
      if (is_card(strips.plane[p])) continue;
      for (const std::size_t q : {p + k, p + k + 1}) {
        reach_x = std::max(reach_x, strips.x[q]);
        reach_z = std::max(reach_z, strips.z[q]);
      }
    }
  }
  if (!(to > from) || !(reach_x > 0.0) || !(reach_z > 0.0)) return {};
  const int units = *std::max_element(report.units_per_slice.begin(), report.units_per_slice.end());
  const double finest = std::max(kChord * 0.5 * (reach_x + reach_z) / std::max(units, 1),
                                 least_chord * 0.5 * (reach_x + reach_z));
  TriangleSoup out;
  for (const TargetPiece& piece : target) {
    const double begin = std::max(from, piece.from_mm), end = std::min(to, piece.to_mm);
    if (!(end > begin)) continue;
    const TargetStretch stretch{begin - piece.origin_mm, end - piece.origin_mm, reach_x, reach_z,
                                finest};
    TriangleSoup own = piece.surface.triangles(stretch);
    for (std::size_t k = 1; k < own.corners.size(); k += 3) own.corners[k] += piece.origin_mm;
    if (target.size() == 1) return own;
    keep_between(begin, end, own);
    out.corners.insert(out.corners.end(), own.corners.begin(), own.corners.end());
  }
  return out;
}

std::optional<FitFigures> surface_fit(const Design& design) {
  std::vector<double> s_mm;
  for (const SliceReport& slice : design.report.slices) s_mm.push_back(slice.s_mm);
  const SpineMap along(design.strips, s_mm);
  const FitTarget aim(target_triangles(design.strips, along, design.report, design.target), {},
                      DesignAngle::of_rad(design.pattern.design_psi_rad));
  FitFigures figures = aim.measure(structure_triangles(design.strips, design.pattern, along));
  if (figures.to_target.samples == 0) return std::nullopt;
  return figures;
}

std::string fit_in_words(const FitFigures& fit) {
  std::string words =
      fmt::format("{} off on average (95 %: {}); {} of the target is within 2 % of its size",
                  mm_in_words(fit.to_target.mean_mm), mm_in_words(fit.to_target.p95_mm),
                  share_in_words(fit.share_within[1]));
  const OutOfReach& out = fit.out_of_reach;
  if (out.share() < 0.005) return words;
  words += fmt::format("; {} is out of reach (", share_in_words(out.share()));
  const char* separator = "";
  for (const auto& [share, what] : {std::pair{out.outside_of_the_corner, "outside of the corner"},
                                    std::pair{out.overhang, "overhang"},
                                    std::pair{out.beyond_the_slices, "beyond the slices"}}) {
    if (share < 0.005) continue;
    words += fmt::format("{}{} {}", separator, share_in_words(share), what);
    separator = ", ";
  }
  return words + ")";
}

}  // namespace popcut
