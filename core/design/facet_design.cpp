// SPDX-License-Identifier: MIT
#include "core/design/facet_design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "core/design/design_report.hpp"
#include "core/design/facets/facets.hpp"
#include "core/hands/folding.hpp"

namespace popcut {
namespace {

constexpr double kContour_mm = 1.0;      ///< strips of silhouettes
constexpr double kContourShare = 0.006;  ///< of the shape's size, at least
constexpr double kFacetChord = 0.1;      ///< of the pitch: chords of formulas stray no farther

/// The whole of a mesh or a grid; a formula's part in the corner over a stretch. Its sections tell
/// how far it reaches.
Result<TriangleSoup> triangles_in(const Surface& surface, double from_mm, double to_mm,
                                  double finest_mm) {
  constexpr int kPlaces = 16;
  TargetStretch stretch{from_mm, to_mm, 0.0, 0.0, finest_mm};
  std::optional<Error> refused;
  for (int k = 0; k <= kPlaces; ++k) {
    const auto curve = surface.slice(from_mm + (to_mm - from_mm) * k / kPlaces);
    if (!curve) {
      // What does not end somewhere has no triangles that bound it.
      if (curve.error().kind == ErrorKind::Infeasible && curve.error().reason == ErrorReason::None)
        return tl::unexpected(curve.error());
      if (!refused) refused = curve.error();
      continue;
    }
    stretch.reach_x_mm = std::max(stretch.reach_x_mm, curve->d());
    stretch.reach_z_mm = std::max(stretch.reach_z_mm, curve->h());
  }
  if (!(stretch.reach_x_mm > 0.0) || !(stretch.reach_z_mm > 0.0))
    return tl::unexpected(refused.value_or(
        Error{ErrorKind::Infeasible, "/surface", "no part of it stands in the corner", {}}));
  return surface.triangles(stretch);
}

/// Where a soup begins and ends along the spine.
std::pair<double, double> extent_of(const TriangleSoup& soup) {
  double low = soup.corners[1], high = low;
  for (std::size_t k = 1; k < soup.corners.size(); k += 3)
    low = std::min(low, soup.corners[k]), high = std::max(high, soup.corners[k]);
  return {low, high};
}

Result<FacetTarget> target_over(const DesignSpec& spec, const Surface& surface);

}  // namespace

Result<FacetTarget> facet_target(const DesignSpec& spec, const SurfaceAssets& assets) {
  const auto surface = Surface::make(*spec.surface, spec.placement, FitMode::Nearest, assets);
  if (!surface) return tl::unexpected(surface.error());
  return target_over(spec, *surface);
}

namespace {

Result<FacetTarget> target_over(const DesignSpec& spec, const Surface& surface) {
  const FacetSpec& asked = spec.facets;
  FacetTarget out{{}, asked.from_mm, asked.from_mm + asked.length_mm.value_or(0.0)};
  if (!solid_word(*spec.surface)) {
    auto soup = triangles_in(surface, out.from_mm, out.to_mm, kFacetChord * asked.pitch_mm);
    if (!soup) return tl::unexpected(soup.error());
    out.soup = std::move(*soup);
    return out;
  }
  out.soup = surface.triangles({});
  if (out.soup.size() == 0)
    return fail(ErrorKind::Infeasible, "/surface", "all of it lies in wall or ground");
  const auto [low, high] = extent_of(out.soup);
  if (!asked.from_given) out.from_mm = low;
  out.to_mm = asked.length_mm ? out.from_mm + *asked.length_mm : high;
  if (!(out.to_mm > out.from_mm))
    return fail(ErrorKind::OutOfRange, "/facets/from_mm",
                fmt::format("is {:g}; must be less than {:g}, where the {} ends", out.from_mm, high,
                            solid_word(*spec.surface)));
  return out;
}

/// How far the target reaches in the corner, within the stretch that is made.
struct TargetExtent {
  double x_mm{}, z_mm{};
  double shut_mm{};  ///< from the spine when the card is shut: x + z
};
TargetExtent extent_in_corner(const FacetTarget& target) {
  TargetExtent out;
  const std::vector<double>& corners = target.soup.corners;
  for (std::size_t k = 0; k < corners.size(); k += 3) {
    const double x = corners[k], v = corners[k + 1], z = corners[k + 2];
    if (x < 0.0 || z < 0.0 || v < target.from_mm || v > target.to_mm) continue;
    out.x_mm = std::max(out.x_mm, x), out.z_mm = std::max(out.z_mm, z);
    out.shut_mm = std::max(out.shut_mm, x + z);
  }
  return out;
}

FacetOptions options_of(const DesignSpec& spec, const FacetTarget& target) {
  FacetOptions out;
  out.pitch_mm = std::max(spec.facets.pitch_mm, spec.min_panel_mm);
  out.strip_mm = std::max(spec.facets.strip_mm, spec.min_panel_mm);
  out.min_panel_mm = spec.min_panel_mm;
  out.margin_mm = spec.card->margin_mm;
  out.from_mm = target.from_mm, out.to_mm = target.to_mm;
  out.wall_mm = spec.card->wall_mm, out.ground_mm = spec.card->ground_mm;
  out.shut_inside = spec.card->shut == CardShut::Inside;
  out.inward = spec.facets.inward;
  out.kites = spec.facets.sloped == SlopedParts::Kites;
  out.tents = spec.facets.sloped == SlopedParts::Tents;
  out.lattice = spec.facets.curved == CurvedParts::Lattice;
  out.widen_to_mm = spec.facets.widen_to_mm;
  out.in_paper = spec.facets.hold == FacetHold::Paper;
  out.rough = spec.facets.rough;
  if (spec.style == DesignStyle::Silhouette) {
    out.layers = spec.facets.layers, out.min_fold_mm = spec.facets.min_fold_mm;
    const TargetExtent extent = extent_in_corner(target);
    const double most_mm = std::max({target.to_mm - target.from_mm, extent.x_mm, extent.z_mm});
    out.pitch_mm = out.strip_mm =
        std::max({kContour_mm, spec.min_panel_mm, kContourShare * most_mm});
  }
  out.weights = {spec.facets.fold_cost_mm2, spec.facets.jump_cost_mm2, spec.facets.cut_cost_mm2,
                 spec.facets.hinge_cost_mm3};
  return out;
}

/// The strips as the slices of the report.
void add_strips(const FacetCard& card, DesignReport& report) {
  const Strips& strips = card.pattern.strips.strips;
  std::size_t most = 0;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Slice) continue;
    SliceReport slice;
    slice.width_mm = strips.v_begin[s + 1] - strips.v_begin[s];
    slice.v_mm = 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]);
    slice.s_mm = card.grid.v_from_mm + slice.v_mm - card.card.margin_mm;
    const std::size_t first = strips.first_point(s) + 1, last = strips.first_panel[s + 1] + s - 1;
    slice.wall_mm = strips.z[first], slice.ground_mm = strips.x[last];
    slice.blank = first == last;
    report.slices.push_back(slice);
    most = std::max<std::size_t>(most, (strips.first_panel[s + 1] - strips.first_panel[s]) / 2);
  }
  report.units_per_slice.push_back(static_cast<int>(most));
}

/// A wall or ground that was asked for and is too short for the shape.
void warn_of_small_card(const DesignSpec& spec, const FacetTarget& target, DesignReport& report) {
  constexpr double kUnseen_mm = 0.5;
  const CardSpec& card = *spec.card;
  const TargetExtent extent = extent_in_corner(target);
  const bool inside = card.shut == CardShut::Inside;
  const double most_z = inside ? extent.shut_mm : extent.z_mm,
               most_x = inside ? extent.shut_mm : extent.x_mm;
  std::vector<std::string> short_of, enough;
  const auto compare = [&](const char* field, const std::optional<double>& given, double needed) {
    if (!given || *given + kUnseen_mm >= needed) return;
    short_of.push_back(fmt::format("{} = {:g}", field, *given));
    enough.push_back(fmt::format("{} at least {:.0f}", field, std::ceil(needed + card.margin_mm)));
  };
  compare("wall_mm", card.wall_mm, most_z);
  compare("ground_mm", card.ground_mm, most_x);
  if (short_of.empty()) return;
  report.warnings.push_back(
      {.code = "flattened_by_card",
       .message = fmt::format(
           "the card is too small for your shape, which reaches {:.1f} mm up, {:.1f} mm forward{}, "
           "but {}: what does not fit is left out or pressed flat; make {} mm, leave {} out, or "
           "make the shape smaller",
           extent.z_mm, extent.x_mm,
           inside ? fmt::format(" and, shut, {:.1f} mm from the spine", extent.shut_mm) : "",
           fmt::format("{} mm", fmt::join(short_of, " and ")), fmt::join(enough, " and "),
           short_of.size() == 1 ? "it" : "both")});
}

/// Parts that hang in the air on a strip of paper.
void warn_of_hanging_parts(const FacetCard& card, DesignReport& report) {
  const std::size_t count = card.repaired.bridges;
  if (count == 0) return;
  report.warnings.push_back(
      {.code = "hangs_on_one_strip",
       .message = fmt::format(
           "{} of the shape {} neither wall nor ground and {} on one strip of paper {:g} mm wide, "
           "which bends and tears easily; join {} to the rest of the shape, let {} stand on the "
           "ground, or make strip_mm larger",
           count == 1 ? "a part" : fmt::format("{} parts", count), count == 1 ? "touches" : "touch",
           count == 1 ? "hangs" : "hang each", card.grid.strip_mm, count == 1 ? "it" : "them",
           count == 1 ? "it" : "them")});
}

/// Roofs that come out as stairs though sloped panels were asked for.
void warn_of_stepped_roofs(const FacetCard& card, DesignReport& report) {
  for (const RefusedRoof& refused : card.refused)
    report.warnings.push_back(
        {.code = "roof_in_steps", .message = "a roof comes out as stairs: " + refused.reason()});
}

/// A text or a drawing: a flat shape whose front is to look as it was drawn.
bool is_cut_out(const SurfaceSpec& surface) {
  return std::holds_alternative<TextSpec>(surface) || std::holds_alternative<OutlineSpec>(surface);
}

/// Points of the front view, seen along x: which lie on something.
class FrontView {
 public:
  FrontView(double from_mm, double to_mm, double height_mm)
      : from_mm_(from_mm),
        step_mm_(std::max({kFinest_mm, (to_mm - from_mm) / kMostPoints, height_mm / kMostPoints})),
        columns_(count(to_mm - from_mm)),
        rows_(count(height_mm)),
        covered_(columns_ * rows_) {}

  void add(const TriangleSoup& soup) {
    for (std::size_t t = 0; t < soup.size(); ++t) {
      const std::array<Vec3, 3> p{soup.corner(t, 0), soup.corner(t, 1), soup.corner(t, 2)};
      const auto [left, right] = std::minmax({p[0][1], p[1][1], p[2][1]});
      for (std::size_t c = first(left - from_mm_, columns_); c < first(right - from_mm_, columns_);
           ++c) {
        const double v = from_mm_ + place(c);
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3 &a = p[k], &b = p[(k + 1) % 3];
          if ((a[1] <= v) == (b[1] <= v)) continue;
          const double z = a[2] + (v - a[1]) / (b[1] - a[1]) * (b[2] - a[2]);
          low = std::min(low, z), high = std::max(high, z);
        }
        cover(c, low, high);
      }
    }
  }

  /// The upright panels of a card but those of its wall.
  ///
  /// @param shift_mm  from the sheet's places along the spine to those here
  void add(const Strips& strips, double shift_mm) {
    shift_mm -= from_mm_;
    for (std::size_t s = 0; s < strips.size(); ++s) {
      if (strips.kind[s] != StripKind::Slice) continue;
      const std::size_t end = first(strips.v_begin[s + 1] + shift_mm, columns_);
      for (std::size_t c = first(strips.v_begin[s] + shift_mm, columns_); c < end; ++c)
        for (std::size_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
          const std::size_t q = p + s;
          if (!strips.is_cut(p) && strips.plane[p] != kWallPlane && strips.x[q] == strips.x[q + 1])
            cover(c, strips.z[q + 1], strips.z[q]);
        }
    }
  }

  [[nodiscard]] double area_mm2() const {
    return step_mm_ * step_mm_ *
           static_cast<double>(std::count(covered_.begin(), covered_.end(), std::uint8_t{1}));
  }
  /// Of what is covered here and not in `other`, a view of the same places.
  [[nodiscard]] double area_beyond_mm2(const FrontView& other) const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < covered_.size(); ++k)
      count += covered_[k] != 0 && other.covered_[k] == 0 ? 1 : 0;
    return step_mm_ * step_mm_ * static_cast<double>(count);
  }

 private:
  static constexpr double kFinest_mm = 0.25, kMostPoints = 1000.0;

  [[nodiscard]] std::size_t count(double mm) const {
    return static_cast<std::size_t>(std::max(1.0, std::ceil(mm / step_mm_)));
  }
  [[nodiscard]] double place(std::size_t k) const {
    return (static_cast<double>(k) + 0.5) * step_mm_;
  }
  /// The first of `most` points at `mm` or beyond.
  [[nodiscard]] std::size_t first(double mm, std::size_t most) const {
    return static_cast<std::size_t>(
        std::clamp(std::ceil(mm / step_mm_ - 0.5), 0.0, static_cast<double>(most)));
  }
  void cover(std::size_t column, double low_mm, double high_mm) {
    for (std::size_t r = first(low_mm, rows_); r < first(high_mm, rows_); ++r)
      covered_[column * rows_ + r] = 1;
  }

  double from_mm_, step_mm_;
  std::size_t columns_, rows_;
  std::vector<std::uint8_t> covered_;
};

/// Paper in front of the gaps of a text or a drawing: parts one above another are joined by it.
void warn_of_filled_gaps(const Strips& strips, double margin_mm, const FacetTarget& target,
                         const char* what, DesignReport& report) {
  constexpr double kMuch = 0.25;  // contours in strips and letters such as i have a tenth
  FrontView shape(target.from_mm, target.to_mm, extent_in_corner(target).z_mm), paper = shape;
  shape.add(target.soup);
  paper.add(strips, target.from_mm - margin_mm);
  const double share = paper.area_beyond_mm2(shape) / shape.area_mm2();
  if (!(share > kMuch)) return;
  report.warnings.push_back(
      {.code = "gaps_filled",
       .message = fmt::format(
           "paper fills gaps of the {}, as much as {:.0f} % of its parts: a part that stands above "
           "another hangs on the paper between them, and both come out as one; move such parts "
           "side "
           "by side, or draw the bars that are to join them",
           what, 100.0 * share)});
}

std::size_t folds_of(const FacetCard& card) {
  return hands::handwork(card.pattern.built.pattern).folds;
}

/// The card with as little hinge cost as leaves it no more folds than the spec asks for; else the
/// one with the fewest folds.
Result<FacetCard> card_of_few_folds(const TriangleSoup& target, const DesignSpec& spec,
                                    FacetOptions options, const Progress& progress) {
  constexpr double kFirst_mm3 = 50.0, kFactor = 3.0, kLast_mm3 = 5e5;
  auto best = facet_card(target, options, progress);
  if (!best || spec.facets.most_folds == 0) return best;
  const auto most = static_cast<std::size_t>(spec.facets.most_folds);
  std::size_t fewest = folds_of(*best);
  for (double cost = std::max(kFirst_mm3, kFactor * options.weights.hinge_mm3);
       fewest > most && cost < kLast_mm3; cost *= kFactor) {
    tell(progress, fmt::format("has {} folds; looking for at most {}", fewest, most));
    options.weights.hinge_mm3 = cost;
    auto made = facet_card(target, options, progress);
    if (!made || !stands(*made) || folds_of(*made) >= fewest) continue;
    fewest = folds_of(*made), best = std::move(made);
  }
  return best;
}

void warn_of_many_folds(const DesignSpec& spec, DesignReport& report) {
  const auto most = static_cast<std::size_t>(spec.facets.most_folds);
  if (most == 0 || report.handwork.folds <= most) return;
  report.warnings.push_back(
      {.code = "many_folds",
       .message = fmt::format(
           "the card has {} folds, and most_folds is {}; nothing with fewer folds was found that "
           "holds: leave small parts of the shape out, use a larger pitch_mm and strip_mm, or "
           "\"style\": \"silhouette\"",
           report.handwork.folds, most)});
}

}  // namespace

Result<FacetCard> facets_of(const DesignSpec& spec, const FacetTarget& target,
                            double most_roof_play_mm, const Progress& progress) {
  FacetOptions options = options_of(spec, target);
  options.most_roof_play_mm = most_roof_play_mm;
  return card_of_few_folds(target.soup, spec, options, progress);
}

void warn_of_facets(const DesignSpec& spec, const FacetTarget& target, const FacetCard& made,
                    DesignReport& report) {
  warn_of_small_card(spec, target, report);
  warn_of_hanging_parts(made, report);
  warn_of_stepped_roofs(made, report);
  warn_of_many_folds(spec, report);
}

Result<Design> facet_design(const DesignSpec& spec, const SurfaceAssets& assets,
                            const Progress& progress) {
  tell(progress, "reading the shape");
  auto surface = Surface::make(*spec.surface, spec.placement, FitMode::Nearest, assets);
  if (!surface) return tl::unexpected(surface.error());
  const auto target = target_over(spec, *surface);
  if (!target) return tl::unexpected(target.error());
  auto made = card_of_few_folds(target->soup, spec, options_of(spec, *target), progress);
  if (!made) return tl::unexpected(made.error());
  Design out;
  DesignReport& r = out.report;
  add_strips(*made, r);
  if (std::all_of(r.slices.begin(), r.slices.end(), [](const SliceReport& s) { return s.blank; }))
    return spec.style == DesignStyle::Silhouette
               ? fail(ErrorKind::Infeasible, "/silhouette",
                      "nothing stands up: no layer holds; use a smaller min_fold_mm, fewer layers, "
                      "a "
                      "larger scale_mm or a larger card")
               : fail(ErrorKind::Infeasible, "/facets",
                      "nothing stands up: no patch of the target holds; use a smaller strip_mm and "
                      "pitch_mm, a larger scale_mm or a smaller fold_cost_mm2");
  if (spec.style == DesignStyle::Silhouette && !spec.facets.rough &&
      made->pattern.motion.degrees_of_freedom != 1)
    return fail(ErrorKind::Infeasible, "/silhouette",
                "not all of its layers hold; use a smaller min_fold_mm, fewer layers, a larger "
                "scale_mm, or \"style\": \"facets\"");
  out.strips = std::move(made->pattern.strips.strips);
  out.pattern = std::move(made->pattern.built.pattern);
  out.panel_face = std::move(made->pattern.built.panel_face);
  out.pattern.name = r.name = spec.name;
  r.lattice = r.lattice_asked = spec.style == DesignStyle::Facets ? "facets" : "silhouette";
  r.facets = made->figures;
  count_pattern(out.pattern, r);
  r.panels =
      static_cast<std::size_t>(std::count_if(out.strips.plane.begin(), out.strips.plane.end(),
                                             [](PlaneId plane) { return plane != kNoPlane; }));
  r.degrees_of_freedom = made->pattern.motion.degrees_of_freedom;
  r.pieces = made->pattern.motion.pieces;
  r.fit_nearest = true;
  r.notes = surface->notes;
  if (is_model(spec.surface)) {
    const TargetPlacement& p = spec.placement;
    const double shift_mm = made->card.margin_mm - made->grid.v_from_mm;
    out.pattern.model_placement = {p.scale_mm,        p.rotate_deg[0],
                                   p.rotate_deg[1],   p.rotate_deg[2],
                                   p.translate_mm[0], p.translate_mm[1] + shift_mm,
                                   p.translate_mm[2]};
  }
  add_closing(out.pattern, spec.card->shut, r);
  warn_of_facets(spec, *target, *made, r);
  if (is_cut_out(*spec.surface))
    warn_of_filled_gaps(out.strips, made->card.margin_mm, *target, solid_word(*spec.surface), r);
  out.target.push_back({std::move(*surface)});
  return out;
}

}  // namespace popcut
