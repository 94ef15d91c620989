// SPDX-License-Identifier: MIT
#include "core/design/facets/facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/design/facets/contour.hpp"
#include "core/design/facets/patch_moves.hpp"
#include "core/design/facets/silhouette.hpp"
#include "core/design/facets/windows.hpp"
#include "core/hands/wobble.hpp"

namespace popcut {
namespace {

constexpr double kFinestStep_mm = 0.5;
constexpr double kCardMargin_mm = 15.0;             ///< of wall and ground beyond the last fold
constexpr int kPointsAcross = 2, kPointsAlong = 4;  ///< of the picture in a cell
constexpr double kMostPoints = 64e6;
constexpr int kSweeps = 12, kRoughSweeps = 4;
constexpr std::array kStrengths{1.0, 1.6};  ///< of holding, until a card holds in paper
constexpr double kLeastLayer_mm2 = 40.0;    ///< smaller pieces of a layer are left out
constexpr double kLeastDeeper_mm = 2.0;     ///< of what a window shows

int steps_up(double mm, double step_mm) { return static_cast<int>(std::ceil(mm / step_mm - 1e-9)); }

/// What of the target can be seen: its reach from the spine on the sheet, and its highest offsets.
struct TargetReach {
  double x_mm{}, z_mm{};
  bool any{};
};

TargetReach reach_of(const TriangleSoup& target, double from_mm, double to_mm) {
  TargetReach out;
  for (std::size_t t = 0; t < target.size(); ++t) {
    double low = target.corner(t, 0)[1], high = low;
    for (std::size_t k = 1; k < 3; ++k) {
      low = std::min(low, target.corner(t, k)[1]);
      high = std::max(high, target.corner(t, k)[1]);
    }
    if (high < from_mm || low > to_mm) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = target.corner(t, k);
      if (!(p[0] > 0.0) && !(p[2] > 0.0)) continue;
      out.x_mm = std::max(out.x_mm, p[0]), out.z_mm = std::max(out.z_mm, p[2]);
      out.any = true;
    }
  }
  return out;
}

class FacetMaker {
 public:
  FacetMaker(const TriangleSoup& target, const FacetOptions& options, const Progress& progress)
      : target_(target), options_(options), progress_(progress) {}

  /// Looks at the target and labels it, as nothing need hold yet. Before all else.
  Result<void> look() {
    if (auto done = set_grid(); !done) return done;
    tell(progress_, "looking at the shape along the diagonal");
    image_ = seen_target(target_, raster(), options_.inward);
    if (std::all_of(image_.facing.begin(), image_.facing.end(),
                    [](Facing facing) { return facing == Facing::Card; }))
      return nothing_there();
    const int most_x = most_offset(options_.ground_mm, reach_.x_mm),
              most_z = most_offset(options_.wall_mm, reach_.z_mm);
    if (options_.layers > 0) {
      planes_.emplace(silhouette_planes(image_, grid_, options_.layers, most_x, most_z));
    } else {
      const int pitch = std::max(1, static_cast<int>(std::llround(options_.pitch_mm / step_mm_)));
      if (options_.kites || options_.tents)
        if (auto done = lay_roofs(image_, most_x, most_z); !done) return done;
      std::vector<FacetPlane> of_tents;
      for (const TentRun& run : tents_.runs)
        of_tents.insert(of_tents.end(), {run.level, run.front});
      planes_.emplace(planes_for(image_, grid_, pitch, most_x, most_z, options_.inward,
                                 roofs_.kites, of_tents));
    }
    uncut_.emplace(image_, *planes_, grid_, options_.weights, limits());
    fix_roofs(*uncut_);
    if (options_.layers > 0 && options_.rough) return {};
    least_ = uncut_->least_distance();
    if (options_.layers > 0) return {};
    tell(progress_, "giving each point of the sheet a plane");
    if (!options_.rough) cut_.emplace(*uncut_).sweep(kSweeps, true);
    uncut_->sweep(options_.rough ? kRoughSweeps : kSweeps, false);
    return {};
  }

  /// The card. More than once with other rules of what holds.
  ///
  /// @param strength  of the rule of what holds in paper
  Result<FacetCard> run(double strength) {
    strength_ = strength;
    if (options_.layers > 0) return cut_out();
    const SeenTarget& image = image_;
    const FacetPlanes& planes = *planes_;
    // Strips that are cut across come nearer, but are looser; some shapes are better off without.
    const FacetCardSize card = whole_card();
    Labelling uncut = *uncut_;
    auto repaired = repaired_card(uncut, card, false);
    if (!repaired) return tl::unexpected(repaired.error());
    Labelling labelling = cut_ ? *cut_ : *uncut_;
    std::optional<FacetRepair> cut;
    if (cut_) {
      auto repaired_cut = repaired_card(labelling, card, true);
      if (!repaired_cut) return tl::unexpected(repaired_cut.error());
      if (!repaired_cut->unfinished &&
          seen_cost(image, planes, labelling) <= seen_cost(image, planes, uncut))
        cut = std::move(*repaired_cut);
    }
    if (cut)
      repaired = std::move(*cut);
    else
      labelling = std::move(uncut);
    const bool is_for_hands = options_.weights.hinge_mm3 > 0.0 || options_.widen_to_mm > 0.0;
    const bool is_moved = is_for_hands || (options_.lattice && !options_.rough);
    const FacetPlanes fine = is_moved && !options_.rough ? every_step(planes) : planes;
    std::optional<Labelling> moved_on;
    std::size_t moves = 0;
    double least = least_;
    if (is_moved) {
      tell(progress_, "moving panels nearer to the shape");
      moved_on.emplace(image, fine, grid_, options_.weights, limits());
      fix_roofs(*moved_on);
      take_over(labelling, *repaired, *moved_on);
      moves = move_patches(*moved_on, hold_rule(), options_.widen_to_mm, kMostRepairWork);
      least = moved_on->least_distance();
    }
    const Labelling& last = moved_on ? *moved_on : labelling;
    if (!options_.rough && !repaired->unfinished)
      keep_real_struts(last.image(), last.planes(), card, options_.min_panel_mm, *repaired);
    return finished(image, last, least, card, std::move(*repaired), moves);
  }

 private:
  /// Which strips are kites or have a glued roof.
  Result<void> lay_roofs(const SeenTarget& image, int most_x, int most_z) {
    KiteLimits within;
    within.least_run = least_run(), within.most_x = most_x, within.most_z = most_z;
    within.dormer_mm = options_.widen_to_mm;
    const double reach = limits().most_reach_mm / step_mm_;
    if (reach < within.most_reach) within.most_reach = static_cast<int>(reach);
    if (options_.tents)
      tents_ = plan_tents(target_, image, grid_, within, options_.most_roof_play_mm);
    else
      roofs_ = plan_kites(target_, image, grid_, within);
    if (!roofs_.runs.empty() || !tents_.runs.empty()) return {};
    const std::vector<RefusedRoof>& refused = options_.tents ? tents_.refused : roofs_.refused;
    return fail(
        ErrorKind::Infeasible, "/facets/sloped",
        refused.empty()
            ? std::string("no roof is seen: no plane of the shape falls away from the wall, "
                          "with its ridge along the spine, at 8 to 82 degrees, and 12 mm of "
                          "it free; turn the shape with rotate_deg, or leave sloped out")
            : refused.front().reason());
  }
  void fix_roofs(Labelling& labelling) const {
    for (const TentRun& run : tents_.runs)
      for (int s = run.first; s < run.end; ++s)
        labelling.fix(s, tent_labels(labelling.planes(), grid_, run));
    for (const KiteRun& run : roofs_.runs)
      for (int s = run.first; s < run.end; ++s)
        labelling.fix(s, kite_labels(labelling.planes(), grid_, run, s));
  }

  /// As large as it can be, until it is known what it needs.
  [[nodiscard]] FacetCardSize whole_card() const {
    return {grid_.wall * step_mm_, (grid_.columns - grid_.wall) * step_mm_, options_.margin_mm};
  }

  /// A silhouette.
  Result<FacetCard> cut_out() {
    tell(progress_, "cutting out layers");
    Labelling labelling = *uncut_;
    const SilhouetteOptions how{options_.layers, options_.min_fold_mm, kLeastLayer_mm2,
                                !options_.rough};
    const Silhouette made = make_silhouette(labelling, image_, how, hold_rule(), progress_);
    FacetRepair repaired;
    repaired.inner = made.struts, repaired.dropped = static_cast<int>(made.dropped);
    return finished(image_, labelling, least_, whole_card(), std::move(repaired), 0);
  }

  /// The card of labels: as large as they need, with windows and contours.
  [[nodiscard]] Result<FacetCard> finished(const SeenTarget& image, const Labelling& labelling,
                                           double least, FacetCardSize card, FacetRepair repaired,
                                           std::size_t moves) const {
    const FacetPlanes& planes = labelling.planes();
    LabelImage labels = fit_card(labelling.image(), planes, card);
    for (FacetStrut& strut : repaired.struts) strut.without = moved(strut.without, labels.grid);
    auto pattern = pattern_of(labels, planes, card, options_.min_panel_mm);
    if (!pattern) return tl::unexpected(pattern.error());
    FacetCard out{labels.grid,
                  planes,
                  std::move(labels),
                  card,
                  std::move(*pattern),
                  std::move(repaired),
                  moves,
                  {},
                  options_.tents ? tents_.refused : roofs_.refused,
                  tents_.runs,
                  0};
    measure(image, labelling, least, out);
    if (options_.layers == 0) open_windows(image, out);
    if (options_.layers > 0)
      smooth_contours(out.pattern.built.pattern);
    else
      follow_contours(out.pattern, out.labels, out.planes, image, options_.min_panel_mm);
    mark_kites(out.pattern, out.planes, step_mm_);
    return out;
  }

  [[nodiscard]] Result<FacetRepair> repaired_card(Labelling& labelling, const FacetCardSize& card,
                                                  bool jumps) const {
    RepairOptions how;
    how.jumps = jumps, how.rough = options_.rough;
    how.shifts = options_.lattice && !options_.rough;
    if (!jumps) how.most_work = std::numeric_limits<std::size_t>::max();
    return repair(labelling, card, hold_rule(), how, progress_);
  }

  /// The labels, and those of the struts, as labels of other planes, of which each is one.
  static void take_over(const Labelling& from, FacetRepair& repaired, Labelling& to) {
    const auto in_new = [&](std::vector<Label> labels) {
      for (Label& label : labels) label = to.planes().find(from.planes()[label]);
      return labels;
    };
    for (int s = 0; s < from.image().grid.strips; ++s) {
      const auto strip = from.image().strip(s);
      to.set(s, in_new({strip.begin(), strip.end()}));
    }
    for (FacetStrut& strut : repaired.struts) strut.without = in_new(std::move(strut.without));
  }

  [[nodiscard]] HoldRule hold_rule() const {
    return options_.in_paper ? paper_rule(options_.min_panel_mm, strength_)
                             : HoldRule{options_.min_panel_mm};
  }

  Result<void> set_grid() {
    reach_ = reach_of(target_, options_.from_mm, options_.to_mm);
    if (!reach_.any) return nothing_there();
    const int parts = std::max(1, steps_up(options_.pitch_mm, kFinestStep_mm));
    step_mm_ = options_.pitch_mm / parts;
    const double pad = std::max(kCardMargin_mm, options_.min_panel_mm);
    const double wall = options_.wall_mm.value_or(reach_.z_mm + pad),
                 ground = options_.ground_mm.value_or(reach_.x_mm + pad);
    const double columns = wall / step_mm_ + ground / step_mm_,
                 strips = (options_.to_mm - options_.from_mm) / options_.strip_mm;
    if (!(columns * strips * kPointsAcross * kPointsAlong <= kMostPoints))
      return fail(ErrorKind::OutOfRange, "/facets/strip_mm",
                  fmt::format("makes {:.3g} cells with pitch_mm = {:g}; must make at most {:.3g}: "
                              "use wider strips or a larger pitch_mm",
                              columns * strips, options_.pitch_mm,
                              kMostPoints / kPointsAcross / kPointsAlong));
    grid_.step_mm = step_mm_;
    grid_.wall = steps_down(wall);
    grid_.columns = grid_.wall + steps_down(ground);
    grid_.strip_mm = options_.strip_mm;
    grid_.strips = std::max(1, steps_up(options_.to_mm - options_.from_mm, options_.strip_mm));
    grid_.v_from_mm = options_.from_mm;
    for (const auto& [asked, steps, field] :
         {std::tuple{options_.wall_mm, grid_.wall, "wall_mm"},
          std::tuple{options_.ground_mm, grid_.columns - grid_.wall, "ground_mm"}})
      if (steps < 2 * least_run())
        return fail(ErrorKind::OutOfRange, fmt::format("/card/{}", field),
                    fmt::format("is {:g} mm; at least {:g} mm is needed", asked.value_or(0.0),
                                2 * least_run() * step_mm_));
    return {};
  }
  [[nodiscard]] int steps_down(double mm) const {
    return static_cast<int>(std::floor(mm / step_mm_ + 1e-9));
  }
  [[nodiscard]] int least_run() const {
    return std::max(1, steps_up(options_.min_panel_mm, step_mm_));
  }

  [[nodiscard]] tl::unexpected<Error> nothing_there() const {
    return fail(ErrorKind::Infeasible, "/surface",
                fmt::format("nothing of it stands in the corner x > 0, z > 0 between {:g} and {:g} "
                            "mm along the spine; move it with translate_mm, or set "
                            "/facets/from_mm and length_mm",
                            options_.from_mm, options_.to_mm));
  }

  [[nodiscard]] SheetRaster raster() const {
    return {-grid_.wall * step_mm_,
            step_mm_ / kPointsAcross,
            grid_.v_from_mm,
            grid_.strip_mm / kPointsAlong,
            static_cast<std::size_t>(grid_.columns * kPointsAcross),
            static_cast<std::size_t>(grid_.strips * kPointsAlong)};
  }

  /// The largest offset that leaves the least panel of a wall or ground that was asked for.
  [[nodiscard]] int most_offset(const std::optional<double>& asked, double reach_mm) const {
    return asked ? steps_down(*asked) - least_run() : steps_up(reach_mm, step_mm_);
  }

  [[nodiscard]] FacetLimits limits() const {
    FacetLimits out;
    out.least_run = least_run();
    out.inward = options_.inward;
    const double side = std::min(options_.wall_mm.value_or(out.most_reach_mm),
                                 options_.ground_mm.value_or(out.most_reach_mm));
    if (options_.shut_inside) out.most_reach_mm = side;
    return out;
  }

  /// Wall and ground as large as the labels need; the same labels in the new columns.
  [[nodiscard]] LabelImage fit_card(const LabelImage& image, const FacetPlanes& planes,
                                    FacetCardSize& card) const {
    int up = 0, far = 0, shut = 0;
    for (int s = 0; s < grid_.strips; ++s) {
      const std::vector<LabelRun> runs = runs_of(image.strip(s), planes, grid_);
      up = std::max(up, grid_.wall - runs.front().end);
      far = std::max(far, runs.back().begin - grid_.wall);
      for (const LabelRun& run : runs) {
        const FacetPlane& p = planes[run.label];
        if (p.offset == 0) continue;
        const int across = p.upright ? -grid_.across(run.begin) : grid_.across(run.end);
        shut = std::max(shut, 2 * p.offset + across);
      }
    }
    for (const TentRun& run : tents_.runs)
      shut = std::max(
          shut, run.level.offset + run.front.offset + steps_up(run.section.roof_mm, step_mm_));
    const double pad = std::max(kCardMargin_mm, options_.min_panel_mm);
    const double least_shut = options_.shut_inside ? shut * step_mm_ + options_.margin_mm : 0.0;
    card.wall_mm = options_.wall_mm.value_or(std::max(up * step_mm_ + pad, least_shut));
    card.ground_mm = options_.ground_mm.value_or(std::max(far * step_mm_ + pad, least_shut));
    if (!tents_.runs.empty() && !options_.wall_mm && !options_.ground_mm)
      card.wall_mm = card.ground_mm = std::max(card.wall_mm, card.ground_mm);
    FacetGrid grid = image.grid;
    grid.wall = steps_down(card.wall_mm);
    grid.columns = grid.wall + steps_down(card.ground_mm);
    LabelImage out{grid, {}};
    for (int s = 0; s < grid.strips; ++s) {
      const std::vector<Label> strip = moved(image.strip(s), grid);
      out.label.insert(out.label.end(), strip.begin(), strip.end());
    }
    return out;
  }

  /// The labels of a strip in the columns of another card.
  [[nodiscard]] std::vector<Label> moved(std::span<const Label> strip,
                                         const FacetGrid& grid) const {
    std::vector<Label> out(static_cast<std::size_t>(grid.columns));
    for (int i = 0; i < grid.columns; ++i) {
      const int from = i - grid.wall + grid_.wall;
      out[static_cast<std::size_t>(i)] = from < 0 ? kWallLabel
                                         : from >= grid_.columns
                                             ? kGroundLabel
                                             : strip[static_cast<std::size_t>(from)];
    }
    return out;
  }

  /// How far behind a plane the target must be for a window in it.
  [[nodiscard]] double window_depth_mm() const {
    return std::max(options_.pitch_mm, kLeastDeeper_mm);
  }

  /// What labels cost without what windows will take away.
  [[nodiscard]] double seen_cost(const SeenTarget& image, const FacetPlanes& planes,
                                 const Labelling& labelling) const {
    LabelImage open = labelling.image();
    double gone = 0.0;
    if (cut_windows(open, planes, image, window_depth_mm(), options_.min_panel_mm,
                    options_.widen_to_mm) > 0)
      for (std::size_t row = 0; row < image.raster.rows; ++row)
        for (std::size_t c = 0; c < image.raster.columns; ++c) {
          const int s = static_cast<int>(row) / kPointsAlong;
          const std::size_t column = c / kPointsAcross;
          if (open.strip(s)[column] != kNoLabel) continue;
          const FacetPlane& plane = planes[labelling.image().strip(s)[column]];
          gone += std::abs(plane.offset * step_mm_ -
                           (plane.upright ? image.x_mm(row, c) : image.z_mm(row, c)));
        }
    return labelling.whole_cost() - gone * image.raster.column_mm * image.raster.row_mm;
  }

  /// Windows, where the card with them is as sound as without.
  void open_windows(const SeenTarget& image, FacetCard& out) const {
    LabelImage labels = out.labels;
    out.windows = cut_windows(labels, out.planes, image, window_depth_mm(), options_.min_panel_mm,
                              options_.widen_to_mm);
    if (out.windows == 0) return;
    auto pattern = pattern_of(labels, out.planes, out.card, options_.min_panel_mm);
    if (pattern && pattern->motion.degrees_of_freedom == 1 && pattern->motion.pieces == 1) {
      out.labels = std::move(labels);
      out.pattern = std::move(*pattern);
    } else {
      out.windows = 0;
    }
  }

  void measure(const SeenTarget& image, const Labelling& labelling, double least,
               FacetCard& out) const {
    std::vector<double> off;
    std::vector<KiteSection> kites;
    for (const LabelKite& kite : out.planes.kites()) kites.push_back(kite.section(step_mm_));
    double sum = 0.0, whole = 0.0;
    const double root = std::sqrt(2.0);
    for (int s = 0; s < grid_.strips; ++s) {
      const auto strip = labelling.image().strip(s);
      whole += labelling.distance(s, strip);
      for (int k = 0; k < kPointsAlong; ++k)
        for (std::size_t c = 0; c < image.raster.columns; ++c) {
          const auto row = static_cast<std::size_t>(s * kPointsAlong + k);
          const Label label = strip[c / kPointsAcross];
          const bool is_card =
              label == (c / kPointsAcross < static_cast<std::size_t>(grid_.wall) ? kWallLabel
                                                                                 : kGroundLabel);
          if (is_card && image.facing[row * image.raster.columns + c] == Facing::Card) continue;
          const FacetPlane& plane = out.planes[label];
          const auto depth = static_cast<double>(image.depth_mm[row * image.raster.columns + c]);
          const double far =
              plane.kite >= 0
                  ? std::abs(kites[static_cast<std::size_t>(plane.kite)].depth_mm(
                                 image.raster.across_mm(c)) -
                             depth) /
                        root
                  : root * std::abs(plane.offset * step_mm_ -
                                    (plane.upright ? image.x_mm(row, c) : image.z_mm(row, c)));
          off.push_back(far), sum += far;
        }
    }
    FacetFigures& f = out.figures;
    if (!off.empty()) {
      f.depth_mean_mm = sum / static_cast<double>(off.size());
      const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(off.size() - 1));
      std::nth_element(off.begin(), off.begin() + at, off.end());
      f.depth_p95_mm = off[static_cast<std::size_t>(at)];
    }
    f.patches = patches_of(out.labels, out.planes, options_.min_panel_mm).count;
    constexpr double kRounding = 1e-9;
    f.over_least = least > kRounding   ? whole / least
                   : whole > kRounding ? std::numeric_limits<double>::infinity()
                                       : 1.0;
    f.planes = static_cast<int>(out.planes.size());
    f.loose_before = out.repaired.loose_before;
    f.shifted = out.repaired.shifted;
    f.moves = out.moves;
    f.dropped = out.repaired.dropped;
    f.struts = out.repaired.struts.size() + out.repaired.bridges + out.repaired.inner;
  }

  const TriangleSoup& target_;
  const FacetOptions& options_;
  const Progress& progress_;
  double strength_{};
  TargetReach reach_;
  KitePlan roofs_;
  TentPlan tents_;
  FacetGrid grid_;
  double step_mm_{};
  // What does not depend on the strength:
  SeenTarget image_;
  std::optional<FacetPlanes> planes_;
  std::optional<Labelling> uncut_, cut_;  ///< without and with strips that are cut across
  double least_{};                        ///< distance that no labels go below, mm^3
};

Result<FacetCard> firm_card(const TriangleSoup& target, const FacetOptions& options,
                            const Progress& progress) {
  std::optional<FacetCard> firmest;
  double least_mm = std::numeric_limits<double>::infinity();
  FacetMaker maker(target, options, progress);
  if (auto done = maker.look(); !done) return tl::unexpected(done.error());
  for (const double strength : kStrengths) {
    auto made = maker.run(strength);
    if (!made) {
      if (firmest) break;
      return made;
    }
    if (!options.in_paper || options.rough) return made;
    const auto wobble = hands::wobble_of(made->pattern.built.pattern);
    if (!wobble || wobble->loose == 0) return made;
    if (wobble->largest_mm < least_mm) least_mm = wobble->largest_mm, firmest = std::move(*made);
  }
  return std::move(*firmest);
}

}  // namespace

bool stands(const FacetCard& card) {
  return std::any_of(card.labels.label.begin(), card.labels.label.end(),
                     [](Label label) { return label != kWallLabel && label != kGroundLabel; });
}

Result<FacetCard> facet_card(const TriangleSoup& target, const FacetOptions& options,
                             const Progress& progress) {
  auto made = firm_card(target, options, progress);
  if (!made || !options.in_paper || stands(*made)) return made;
  FacetOptions exact = options;
  exact.in_paper = false;
  return firm_card(target, exact, progress);
}

}  // namespace popcut
