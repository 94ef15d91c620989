// SPDX-License-Identifier: MIT
#include "core/design/design.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/design/chain/augmented_slices.hpp"
#include "core/design/chain/slicing.hpp"
#include "core/design/design_report.hpp"
#include "core/design/facet_design.hpp"
#include "core/design/lattice/lattice.hpp"
#include "core/design/lattice_choice.hpp"
#include "core/design/run_layout.hpp"
#include "core/design/strips/closing.hpp"
#include "core/design/strips/figures.hpp"
#include "core/design/strips/multi_state.hpp"
#include "core/design/strips/pattern_builder.hpp"
#include "core/design/strips/splay.hpp"
#include "core/design/strips/strip_bridge.hpp"
#include "core/design/strips/strip_builder.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/geometry/angle.hpp"
#include "core/rigid/mobility.hpp"

namespace popcut {
namespace {

/// What is left of a zero after rounding is zero.
double unless_rounding(double value) { return std::abs(value) < 1e-9 ? 0.0 : value; }

/// How the middle of a card with V-folds bends at an opening angle.
std::string bend_in_words(double K_rad, double psi_rad) {
  const double K = unless_rounding(K_rad);
  const char* const form = K > 0   ? "like a dome"
                           : K < 0 ? "like a saddle"
                                   : "neither dome nor saddle";
  return fmt::format("at an opening angle of {:.1f} degrees the middle is {} (K = {:.3g} rad)",
                     degrees(psi_rad), form, K);
}

constexpr double kCardMargin = 15.0;  ///< of wall and ground beyond the highest and farthest end

/// A layout as strips, with its figures.
struct Laid {
  RunLayout layout;
  LaidStrips strips;
  LatticeFigures figures;
  CardFrame frame;
  std::vector<BridgeReport> bridges;
};

class Designer {
 public:
  Designer(const DesignSpec& spec, const SurfaceAssets& assets, const Progress& progress)
      : spec_(spec), assets_(assets), progress_(progress) {}

  Result<Design> run() {
    auto sliced = slice_target(spec_, assets_, progress_);
    if (!sliced) {
      Error error = sliced.error();  // a placement is proposed for triangles only
      if (solid_word(spec_.surface) == nullptr && !spec_.is_card) error.reason = ErrorReason::None;
      return tl::unexpected(std::move(error));
    }
    sliced_ = std::move(*sliced);
    cut_after_ = sliced_.cut_after;
    notes_ = sliced_.notes;
    note_blanks();
    if (sliced_.uniform_slices > 0)
      notes_.push_back(
          fmt::format("{} slices of chosen widths; equal ones would be {} for the same error",
                      sliced_.slices(), sliced_.uniform_slices));
    for (const auto& [slice, s_mm] : sliced_.moved)
      notes_.push_back(fmt::format(
          "slice {}: the target ends there; its curve is the one at s = {:.4g} mm", slice, s_mm));
    // A round that fails makes a plain cut more, or once a larger card, so the rounds end.
    for (int round = 0; round <= sliced_.slices() + 3; ++round) {
      LatticeMethod method = chosen_.value_or(spec_.lattice);
      std::string note;
      auto laid = lay(method, note);
      if (!laid) return tl::unexpected(laid.error());
      if (cut_apart(*laid)) continue;
      auto tight = tighten(*laid);
      if (!tight) return tl::unexpected(tight.error());
      if (spec_.card && tight->second.degrees_of_freedom != 1) {
        if (cut_loose(laid->strips.strips, tight->first, tight->second)) continue;
        if (std::exchange(bridging_, false)) continue;
        return fail(
            ErrorKind::Infeasible, "/units_per_slice",
            fmt::format("the structure would have {} degrees of freedom, and adding cuts does "
                        "not fix it; use fewer units or a smaller min_panel_mm",
                        tight->second.degrees_of_freedom));
      }
      if (tight->second.pieces != 1)
        return fail(ErrorKind::Infeasible, "/card",
                    fmt::format("without a card the sheet falls into {} pieces; keep the card",
                                tight->second.pieces));
      if (!spec_.is_patch && !stands(laid->strips.strips))
        return fail(
            ErrorKind::Infeasible, "/min_panel_mm",
            fmt::format("nothing stands up: no panel of at least {:g} mm is left; use fewer "
                        "units, a larger scale_mm or a smaller min_panel_mm",
                        spec_.min_panel_mm));
      const std::size_t noted = notes_.size();
      if (auto splayed = splay(laid->strips.strips, tight->first.pattern); !splayed)
        return tl::unexpected(splayed.error());
      if (grow_card(tight->first.pattern)) {
        notes_.resize(noted);
        continue;
      }
      return finish(std::move(*laid), std::move(tight->first), tight->second, method,
                    std::move(note));
    }
    return fail(ErrorKind::Internal, "", "plain cuts did not come to an end");
  }

 private:
  /// Whether any panel is not in wall or ground.
  static bool stands(const Strips& strips) {
    return std::any_of(strips.plane.begin(), strips.plane.end(),
                       [](PlaneId plane) { return plane != kWallPlane && plane != kGroundPlane; });
  }

  /// Says which slices are blank and why, each stretch once.
  void note_blanks() {
    const std::vector<std::string>& blank = sliced_.blank;
    for (std::size_t j = 0, end = 0; j < blank.size(); j = end) {
      end = j + 1;
      if (!sliced_.is_blank(j)) continue;
      while (end < blank.size() && sliced_.is_blank(end)) ++end;
      notes_.push_back(end == j + 1
                           ? fmt::format("slice {} is blank, plain card: {}", j, blank[j])
                           : fmt::format("slices {} to {} are blank, plain card: {} (slice {})", j,
                                         end - 1, blank[j], j));
    }
  }

  /// Says that most slices are blank, which hardly anybody wants; empty if they are not.
  [[nodiscard]] std::string mostly_blank() const {
    std::size_t count = 0, first = 0;
    for (std::size_t j = sliced_.blank.size(); j-- > 0;)
      if (sliced_.is_blank(j)) ++count, first = j;
    if (2 * count <= sliced_.blank.size()) return {};
    return fmt::format(
        "{} of {} slices are blank, plain card: {} (slice {}); is that what you mean?", count,
        sliced_.blank.size(), sliced_.blank[first], first);
  }

  /// V-folds as asked for, or solved from their targets.
  Result<void> splay(const Strips& strips, Pattern& pattern) {
    if (!spec_.splay) return {};
    if (spec_.splay->targets.empty()) return add_v_folds(strips, *spec_.splay, pattern);
    auto solved = solve_multi_state(strips, *spec_.splay);
    if (!solved) return tl::unexpected(solved.error());
    for (std::size_t k = 0; k < solved->K_rad.size(); ++k)
      notes_.push_back(bend_in_words(solved->K_rad[k], spec_.splay->targets[k].psi_rad));
    return add_v_folds(strips, solved->splay, pattern);
  }

  /// H, D and the margins: as asked for, or large enough for all wall and ground ends.
  [[nodiscard]] Result<CardFrame> frame(const std::vector<Run>& runs) const {
    const Reach reach = reach_of(runs);
    CardFrame out;
    double wall = reach.wall_mm, ground = reach.ground_mm;
    for (const SliceCurve& c : sliced_.curves)
      wall = std::max(wall, c.h()), ground = std::max(ground, c.d());
    if (!spec_.card) return CardFrame{false, wall, ground, 0.0};
    out.margin_mm = spec_.card->margin_mm;
    const auto side = [&](const std::optional<double>& asked, double end, const char* field,
                          const char* what) -> Result<double> {
      if (!asked) return end + std::max(kCardMargin, spec_.min_panel_mm);
      if (*asked < end + spec_.min_panel_mm)
        return fail(
            ErrorKind::OutOfRange, fmt::format("/card/{}", field),
            fmt::format("is {:g} mm; the {} reaches {:.4f} mm, so at least {:.4f} mm is needed{}",
                        *asked, what, end, std::ceil(1e4 * (end + spec_.min_panel_mm)) / 1e4,
                        whole_card_in_words()));
      return *asked;
    };
    const auto wall_mm = side(spec_.card->wall_mm, wall, "wall_mm", "structure");
    if (!wall_mm) return tl::unexpected(wall_mm.error());
    const auto ground_mm = side(spec_.card->ground_mm, ground, "ground_mm", "structure");
    if (!ground_mm) return tl::unexpected(ground_mm.error());
    out.wall_mm = *wall_mm, out.ground_mm = *ground_mm;
    return out;
  }

  /// The card that holds the shape as it is when shut, to be added to what says the least.
  [[nodiscard]] std::string whole_card_in_words() const {
    if (spec_.card->shut == CardShut::Free) return {};
    const double side_mm = shut_reach_mm(sliced_.curves) + spec_.card->margin_mm;
    return fmt::format(", and {:.1f} mm to hold all of it when shut",
                       std::ceil(10.0 * side_mm) / 10.0);
  }

  /// Makes the measures of the card that are left out large enough for the shut structure.
  void hold_shut(Laid& laid) const {
    if (!spec_.card || spec_.card->shut == CardShut::Free) return;
    CardFrame& frame = laid.frame;
    const double least =
        std::max(shut_reach_mm(laid.strips.strips) + frame.margin_mm, least_side_mm_);
    if (!spec_.card->wall_mm) frame.wall_mm = std::max(frame.wall_mm, least);
    if (!spec_.card->ground_mm) frame.ground_mm = std::max(frame.ground_mm, least);
    set_card(laid.strips.strips, frame.wall_mm, frame.ground_mm);
  }

  /// Whether the card must be laid out once more, larger: tips of V-folds reach beyond the strips.
  bool grow_card(const Pattern& pattern) {
    if (!spec_.card || spec_.card->shut == CardShut::Free || pattern.v_folds.empty()) return false;
    const double least = shut_reach_mm(pattern) + spec_.card->margin_mm;
    const bool fits = (spec_.card->wall_mm || pattern.wall_mm >= least) &&
                      (spec_.card->ground_mm || pattern.ground_mm >= least);
    if (fits || least <= least_side_mm_) return false;
    least_side_mm_ = least;
    return true;
  }

  [[nodiscard]] Result<Laid> lay_strips(RunLayout layout) const {
    Laid out;
    out.layout = std::move(layout);
    auto framed = frame(out.layout.runs);
    if (!framed) return tl::unexpected(framed.error());
    out.frame = *framed;
    StripOptions options{out.frame, spec_.min_panel_mm, {}, {}, out.layout.blanks};
    if (!out.frame.card)
      for (const LaidSlice& slice : out.layout.laid) {
        options.wall_ends.push_back(sliced_.curves[static_cast<std::size_t>(slice.slice)].h());
        options.ground_ends.push_back(sliced_.curves[static_cast<std::size_t>(slice.slice)].d());
      }
    out.strips = build_strips(out.layout.laid, out.layout.runs, options);
    if (bridging_ && out.frame.card && out.strips.apart.empty()) {
      Laid unbridged = out;
      bridge(out);
      if (sticks_out(out) && !sticks_out(unbridged)) out = std::move(unbridged);
    }
    hold_shut(out);
    return out;
  }

  /// Whether it reaches beyond a given card when shut.
  [[nodiscard]] bool sticks_out(const Laid& laid) const {
    constexpr double kRounding = 1e-9;
    const auto side_mm = given_side_mm(spec_);
    return side_mm && shut_reach_mm(laid.strips.strips) > (1.0 + kRounding) * *side_mm;
  }

  /// Bridges between the runs, where they are valid.
  void bridge(Laid& laid) const {
    const RunLayout& layout = laid.layout;
    std::vector<BridgeAim> aims;
    const Strips& strips = laid.strips.strips;
    std::size_t slices = 0, run = 0;
    for (std::size_t s = 0; s < strips.size() && run + 1 < layout.runs.size(); ++s) {
      if (strips.kind[s] != StripKind::Slice && strips.kind[s] != StripKind::Box) continue;
      if (++slices != static_cast<std::size_t>(layout.runs[run + 1].first)) continue;
      if (strips.kind[s + 1] != StripKind::Blank)
        aims.push_back({s, &sliced_.between[static_cast<std::size_t>(strips.slice[s])]});
      ++run;
    }
    BridgedStrips bridged = add_bridges(strips, aims, spec_.min_panel_mm);
    laid.strips.strips = std::move(bridged.strips);
    laid.bridges = std::move(bridged.made);
  }

  /// Measures the strips against the target.
  void add_figures(Laid& laid) const {
    const RunLayout& layout = laid.layout;
    FigureInput input{laid.strips.strips, {}, {}, {}, 0.0, opening()};
    for (const LaidSlice& slice : layout.laid)
      input.slices.push_back({slice.s_mm, &sliced_.curves[static_cast<std::size_t>(slice.slice)]});
    double mean = 0.0, weight = 0.0;
    for (std::size_t r = 0; r < layout.runs.size(); ++r) {
      const RunTarget& target = layout.targets[r];
      for (std::size_t k = 0; k < layout.connector_s[r].size(); ++k) {
        input.connectors.push_back({layout.connector_s[r][k], &target.connector_curves[k]});
        input.left_parity.push_back((k & 1) != 0);
      }
      mean += target.mean_step() * layout.runs[r].count;
      weight += layout.runs[r].count;
    }
    input.mean_step_mm = mean / weight;
    laid.figures = measure(input);
  }

  [[nodiscard]] DesignAngle opening() const {
    return DesignAngle::of_deg(spec_.placement.design_angle_deg);
  }
  [[nodiscard]] double design_psi_rad() const {
    return psi_rad_of(spec_.placement.design_angle_deg);
  }

  /// Strips with their figures; none where a connector is not valid.
  [[nodiscard]] Result<Laid> lay_measured(RunLayout layout) const {
    auto laid = lay_strips(std::move(layout));
    if (laid && laid->strips.apart.empty()) add_figures(*laid);
    return laid;
  }

  /// Whether enough levels are left when some end: at most every second one is too many.
  [[nodiscard]] bool may_end(const RunLayout& layout) const {
    return std::all_of(layout.targets.begin(), layout.targets.end(), [&](const RunTarget& t) {
      return 2.0 * t.mean_step() > spec_.min_panel_mm;
    });
  }

  /// How many units fit, to be added to what says that more do not.
  [[nodiscard]] std::string fits_at_most(const RunLayout& layout) const {
    double most = std::numeric_limits<double>::infinity();
    for (const RunTarget& target : layout.targets) {
      double d = 0.0, h = 0.0;
      for (const SliceCurve& c : target.slice_curves) d += c.d(), h += c.h();
      most = std::min(most, std::min(d, h) / target.slices() / spec_.min_panel_mm);
    }
    return fmt::format("; at most {:.0f} units fit", std::max(1.0, std::ceil(most) - 1.0));
  }

  /// Lays the lattice by `method`. Where the conformal lattice does not come nearer to the target
  /// than the plain one, the plain one is taken; `note` says what was chosen between.
  Result<Laid> lay(LatticeMethod& method, std::string& note) {
    if (method == LatticeMethod::Auto) return lay_nearest(method, note);
    if (chosen_) {  // in a later round: as it was chosen
      RunLayout again = lay_runs(sliced_, cut_after_, spec_);
      if (auto filled = fill_planes(again, method, progress_); !filled)
        return tl::unexpected(filled.error());
      return lay_strips(std::move(again));
    }
    RunLayout chosen = lay_runs(sliced_, cut_after_, spec_);
    if (auto filled = fill_planes(chosen, method, progress_); !filled) {
      if (method != LatticeMethod::Conformal || spec_.max_step_asked || !may_end(chosen)) {
        filled.error().detail += fits_at_most(chosen);
        return tl::unexpected(filled.error());
      }
      // Conformal planes cannot end at wall and ground; those of "levels" can.
      note = "levels taken, since conformal has no room: " + filled.error().detail;
      method = LatticeMethod::Levels;
      chosen = lay_runs(sliced_, cut_after_, spec_);
      if (filled = fill_planes(chosen, method, progress_); !filled)
        return tl::unexpected(filled.error());
    }
    const bool choose = method == LatticeMethod::Conformal &&
                        std::any_of(chosen.targets.begin(), chosen.targets.end(),
                                    [](const RunTarget& t) { return !t.connector_curves.empty(); });
    if (!choose) return lay_strips(std::move(chosen));
    auto laid = lay_measured(std::move(chosen));
    if (!laid) return laid;
    if (auto relaxed = lay_relaxed(laid->figures)) {
      laid = std::move(*relaxed);
      note = fmt::format(
          "steps up to {:.2f} of the mean one, so that every inner vertex is on the target",
          laid->figures.step_over_mean_max);
    }
    RunLayout plain = lay_runs(sliced_, cut_after_, spec_);
    (void)fill_planes(plain, LatticeMethod::Slices);
    auto other = lay_measured(std::move(plain));
    if (!other || !other->strips.apart.empty()) return laid;
    const LatticeFigures &mine = laid->figures, &theirs = other->figures;
    const bool as_good =
        laid->strips.apart.empty() &&
        (!prefer_slices(mine, theirs) || (breaks_step(theirs) && !breaks_step(mine)));
    const std::string compared = fmt::format(
        "conformal: gap {:.4g} mm, inner error {:.3g} mm; slices: gap {:.4g} mm, inner error "
        "{:.3g} mm",
        mine.gap_mm, unless_rounding(mine.inner_error.max_mm), theirs.gap_mm,
        unless_rounding(theirs.inner_error.max_mm));
    note += (note.empty() ? "" : "; ") + compared;
    if (as_good) return laid;
    note = "slices taken, since conformal does not beat them; " + compared;
    method = LatticeMethod::Slices;
    return other;
  }

  /// Lays all lattices and takes the one with the smallest two-sided rms of those that obey the
  /// limits; where none does, the smallest of all.
  Result<Laid> lay_nearest(LatticeMethod& method, std::string& note) {
    const RunLayout empty = lay_runs(sliced_, cut_after_, spec_);
    if (std::none_of(empty.targets.begin(), empty.targets.end(),
                     [](const RunTarget& t) { return !t.connector_curves.empty(); })) {
      method = LatticeMethod::Slices;  // without connectors all are the same
      return lay(method, note);
    }
    std::optional<LatticeRanking> ranking;
    std::optional<Laid> best;
    std::optional<Error> refused;
    bool best_obeys = false;
    double best_rms = 0.0;
    for (const LatticeMethod one : kLatticesToTry) {
      LatticeTrial trial{name_of(one), false, 0.0, 0.0, 0.0, {}};
      if (one == LatticeMethod::Conformal && conformal_work(empty) > kMostConformalWork) {
        trial.reason = "left out, since it would take long; ask for it by its name";
        trials_.push_back(std::move(trial));
        continue;
      }
      auto laid = lay_trial(one);
      if (!laid) {
        trial.reason = laid.error().detail;
        if (!refused) refused = laid.error();
      } else {
        tell(progress_, "measuring the distance from your shape");
        if (!ranking) ranking.emplace(sliced_, laid->strips.strips, design_psi_rad());
        ranking->measure(laid->strips.strips, trial);
        trial.reason = limit_broken(*laid);
        const bool obeys = trial.reason.empty();
        if (!best || (obeys && !best_obeys) ||
            (obeys == best_obeys && trial.two_sided_rms_mm < best_rms)) {
          best = std::move(*laid), best_obeys = obeys, best_rms = trial.two_sided_rms_mm;
          method = one;
        }
      }
      trials_.push_back(std::move(trial));
    }
    if (!best) return tl::unexpected(*refused);
    chosen_ = method;
    return std::move(*best);
  }

  static double conformal_work(const RunLayout& layout) {
    double work = 0.0;
    for (const RunTarget& run : layout.targets)
      work += static_cast<double>(run.slices()) * std::pow(static_cast<double>(run.units), 3.0);
    return work;
  }

  [[nodiscard]] Result<Laid> lay_trial(LatticeMethod one) const {
    RunLayout layout = lay_runs(sliced_, cut_after_, spec_);
    if (auto filled = fill_planes(layout, one, progress_); !filled)
      return tl::unexpected(filled.error());
    return lay_measured(std::move(layout));
  }

  /// Whether a step is longer than the user asked for.
  [[nodiscard]] bool breaks_step(const LatticeFigures& figures) const {
    constexpr double kRounding = 1e-9;
    return spec_.max_step_asked && spec_.max_step_over_mean &&
           figures.step_over_mean_max > (1.0 + kRounding) * *spec_.max_step_over_mean;
  }

  /// Which limit a lattice breaks, in words; empty for none.
  [[nodiscard]] std::string limit_broken(const Laid& laid) const {
    if (!laid.strips.apart.empty()) {
      const int slice = laid.layout.laid[static_cast<std::size_t>(laid.strips.apart.front())].slice;
      return fmt::format("no connector fits between slices {} and {}", slice, slice + 1);
    }
    if (breaks_step(laid.figures))
      return fmt::format("a step is {:.3g} times the mean one, over max_step_over_mean = {:g}",
                         laid.figures.step_over_mean_max, *spec_.max_step_over_mean);
    const auto side_mm = given_side_mm(spec_);
    if (sticks_out(laid))
      return fmt::format("shut, it reaches {:.4g} mm from the spine, out of the card of {:g} mm",
                         shut_reach_mm(laid.strips.strips), *side_mm);
    return {};
  }

  /// The conformal lattice without the default limit of steps, when that makes it exact and its
  /// longest step stays moderate. A limit that the user asked for is kept.
  [[nodiscard]] std::optional<Laid> lay_relaxed(const LatticeFigures& limited) const {
    const double exact_mm = 1e-6 * sliced_.curves.front().h();
    if (spec_.max_step_asked || !spec_.max_step_over_mean || limited.inner_error.max_mm <= exact_mm)
      return std::nullopt;
    RunLayout free = lay_runs(sliced_, cut_after_, spec_);
    (void)fill_planes(free, LatticeMethod::Slices);
    for (std::size_t r = 0; r < free.runs.size(); ++r) {
      if (free.targets[r].units == 1) continue;
      free.targets[r].max_step_over_mean.reset();
      auto planes = lattice_conformal(free.targets[r], kRelaxedStep, nullptr, progress_);
      if (!planes) return std::nullopt;
      free.runs[r].planes = std::move(*planes);
    }
    auto laid = lay_measured(std::move(free));
    if (!laid || !laid->strips.apart.empty() || laid->figures.inner_error.max_mm > exact_mm ||
        laid->figures.step_over_mean_max > kRelaxedStep)
      return std::nullopt;
    return std::move(*laid);
  }

  /// The nearer lattice wins, by the largest distance of a target point from its nearest fold
  /// vertex; a conformal one that is far more exact wins all the same.
  static bool prefer_slices(const LatticeFigures& conformal, const LatticeFigures& slices) {
    return slices.gap_mm <= 1.001 * conformal.gap_mm &&
           conformal.inner_error.rms_mm > 0.5 * slices.inner_error.rms_mm;
  }

  /// Plain cuts where no connector is valid; whether any was made.
  bool cut_apart(const Laid& laid) {
    bool any = false;
    for (const int k : laid.strips.apart) {
      const int slice = laid.layout.laid[static_cast<std::size_t>(k)].slice;
      any = cut(slice, "no connector fits between them") || any;
    }
    return any;
  }

  /// Builds the pattern; panels that nothing holds are left out, and it is laid and built again,
  /// until all hold each other or leaving out no longer helps.
  Result<std::pair<BuiltPattern, rigid::Mobility>> tighten(Laid& laid) const {
    constexpr int kMostRounds = 30;
    for (int round = 0;; ++round) {
      tell(progress_, "building the pattern");
      auto built = build_pattern(laid.strips.strips, laid.frame.wall_mm, laid.frame.ground_mm,
                                 laid.frame.card, spec_.min_panel_mm);
      if (!built) return tl::unexpected(built.error());
      tell(progress_, "counting the movements of the pattern");
      rigid::Mobility motion = rigid::mobility(built->section());
      const bool done = !laid.frame.card || motion.degrees_of_freedom == 1 || round == kMostRounds;
      if (done || !mark_loose(laid.layout, laid.strips.strips, *built, motion))
        return std::pair{std::move(*built), std::move(motion)};
      auto again = lay_strips(laid.layout);
      if (!again) return tl::unexpected(again.error());
      if (!again->strips.apart.empty()) return std::pair{std::move(*built), std::move(motion)};
      laid = std::move(*again);
    }
  }

  static std::string cut_between(std::size_t slice) {
    return fmt::format("plain cut between slices {} and {}: ", slice, slice + 1);
  }
  bool cut(int slice, const std::string& reason) {
    auto& cut = cut_after_[static_cast<std::size_t>(slice)];
    if (cut != 0 || slice + 1 >= sliced_.slices()) return false;
    cut = 1;
    notes_.push_back(cut_between(static_cast<std::size_t>(slice)) + reason);
    return true;
  }

  /// Plain cuts at the connectors that have loose faces; whether any was made.
  bool cut_loose(const Strips& strips, const BuiltPattern& built, const rigid::Mobility& motion) {
    bool any = false;
    for (std::size_t s = 0; s < strips.size(); ++s) {
      if (strips.kind[s] != StripKind::Connector) continue;
      bool loose = false;
      for (std::uint32_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p)
        loose = loose || motion.loose[static_cast<std::size_t>(built.panel_face[p])] != 0;
      if (loose) any = cut(strips.slice[s], "their connector would leave panels loose") || any;
    }
    return any;
  }

  Design finish(Laid laid, BuiltPattern built, const rigid::Mobility& motion, LatticeMethod method,
                std::string note) {
    Design out;
    DesignReport& r = out.report;
    const RunLayout& layout = laid.layout;
    add_figures(laid);
    out.strips = std::move(laid.strips.strips);
    out.pattern = std::move(built.pattern);
    out.panel_face = std::move(built.panel_face);
    out.pattern.name = r.name = spec_.name;
    r.design_angle_deg = spec_.placement.design_angle_deg;
    out.pattern.design_psi_rad = design_psi_rad();
    for (const RegionSpec& region : spec_.regions)
      r.units_per_slice.push_back(region.units_per_slice);
    r.lattice = name_of(method), r.lattice_asked = name_of(spec_.lattice);
    r.lattice_note = std::move(note);
    r.lattices = std::move(trials_);
    add_slices(layout, out.strips, r);
    count_pattern(out.pattern, r);
    r.panels = out.strips.panels();
    r.degrees_of_freedom = motion.degrees_of_freedom, r.pieces = motion.pieces;
    static_cast<LatticeFigures&>(r) = laid.figures;
    r.merged = std::move(laid.strips.merged);
    r.bridges = std::move(laid.bridges);
    note_borders(r.bridges);
    if (spec_.curvature) add_curvature(layout, method, r);
    r.notes = notes_;
    if (std::string said = mostly_blank(); !said.empty())
      r.warnings.push_back({.code = "mostly_blank", .message = std::move(said)});
    add_fit(r, spec_.fit);
    if (spec_.card && !spec_.is_patch) add_closing(out.pattern, spec_.card->shut, r);
    if (breaks_step(r))
      r.warnings.push_back(
          {.code = "long_step", .message = long_step_warning(r, *spec_.max_step_over_mean)});
    if (const auto side_mm = given_side_mm(spec_); side_mm && method == LatticeMethod::Direct)
      if (std::string said = flattened_by_card(sliced_.curves, *side_mm, spec_.card->margin_mm);
          !said.empty() && r.sticks_out_mm == 0.0) {
        if (spec_.is_patch)
          r.notes.push_back(std::move(said));
        else
          r.warnings.push_back({.code = "flattened_by_card", .message = std::move(said)});
      }
    out.pattern.model_placement = model_placement(r);
    out.edges = std::move(sliced_.edges);
    out.target = sliced_.pieces;
    return out;
  }

  /// The spec's own, shifted along the spine as the slices lie on the sheet.
  [[nodiscard]] std::optional<std::array<double, 7>> model_placement(const DesignReport& r) const {
    if (spec_.is_patch || !is_model(spec_.surface) || r.slices.empty()) return std::nullopt;
    double shift_mm = 0.0, slices = 0.0;
    for (const SliceReport& slice : r.slices)
      if (!slice.blank) shift_mm += slice.v_mm - slice.s_mm, ++slices;
    shift_mm /= std::max(slices, 1.0);
    const TargetPlacement& p = spec_.placement;
    const std::array<double, 3> turn =
        p.about_spine_deg == 0.0 ? p.rotate_deg : degrees_of(whole_turn(p));
    const std::array<double, 3> by = whole_shift_mm(p);
    return std::array{p.scale_mm, turn[0], turn[1], turn[2], by[0], by[1] + shift_mm, by[2]};
  }

  /// What became of the places where N changes, and of other plain cuts.
  void note_borders(const std::vector<BridgeReport>& bridges) {
    std::size_t b = 0;
    for (std::size_t j = 0; j < cut_after_.size(); ++j) {
      if (sliced_.is_blank(j) || (j + 1 < cut_after_.size() && sliced_.is_blank(j + 1))) continue;
      const bool bridged = b < bridges.size() && static_cast<std::size_t>(bridges[b].slice) == j;
      const bool changes = sliced_.cut_after[j] != 0;
      const std::string units =
          !changes ? std::string("whose levels do not pair")
          : sliced_.units[j] == sliced_.units[j + 1]
              ? std::string("with a gap of the target between them")
              : fmt::format("{} and {} units a slice", sliced_.units[j], sliced_.units[j + 1]);
      if (bridged && !changes)  // the cut that was noted has been bridged after all
        std::erase_if(notes_,
                      [&](const std::string& note) { return note.rfind(cut_between(j), 0) == 0; });
      if (bridged)
        notes_.push_back(fmt::format(
            "connector between slices {} and {}, {}: {} planes of the one "
            "and {} of the other, {:.3g} mm off the target at most",
            j, j + 1, units, bridges[b].left_planes, bridges[b].right_planes, bridges[b].off_mm));
      else if (changes)
        notes_.push_back(
            fmt::format("plain cut between slices {} and {}, {}: no valid connector exists there",
                        j, j + 1, units));
      if (bridged) ++b;
    }
  }

  /// What the augmented loss reached, on the chains and in the lattice.
  void add_curvature(const RunLayout& layout, LatticeMethod method, DesignReport& r) {
    std::vector<PlacedPlanes> placed;
    for (std::size_t k = 0; k < layout.runs.size(); ++k) {
      const Run& run = layout.runs[k];
      placed.push_back({&run.planes, {}, layout.connector_s[k]});
      for (int j = run.first; j < run.first + run.count; ++j)
        placed.back().slice.push_back(layout.laid[static_cast<std::size_t>(j)].slice);
    }
    r.curvature = std::move(sliced_.curvature);
    measure_lattice(*spec_.curvature, placed, *r.curvature);
    for (std::string& note : curvature_notes(*r.curvature, method))
      notes_.push_back(std::move(note));
  }

  void add_slices(const RunLayout& layout, const Strips& strips, DesignReport& r) {
    const std::vector<double> v_mm = slice_places(strips, sliced_.s_mm.size());
    for (std::size_t j = 0; j < sliced_.s_mm.size(); ++j) {
      const bool blank = sliced_.is_blank(j);
      const SliceCurve& curve = sliced_.curves[j];
      r.slices.push_back({sliced_.figures[j], sliced_.s_mm[j], v_mm[j], sliced_.width_mm[j],
                          sliced_.fits[j], blank, blank ? 0.0 : curve.h(),
                          blank ? 0.0 : curve.d()});
    }
    for (const Run& run : layout.runs)
      if (run.count == 2 && layout.laid[static_cast<std::size_t>(run.first)].slice ==
                                layout.laid[static_cast<std::size_t>(run.first) + 1].slice)
        notes_.push_back(fmt::format("slice {} stands alone and is laid as two halves",
                                     layout.laid[static_cast<std::size_t>(run.first)].slice));
    r.notes = notes_;
  }

  const DesignSpec& spec_;
  const SurfaceAssets& assets_;
  const Progress& progress_;
  Slicing sliced_;
  std::vector<std::uint8_t> cut_after_;
  std::vector<std::string> notes_;
  bool bridging_{true};                  ///< connectors between runs
  double least_side_mm_{};               ///< of wall and ground where they are left out
  std::optional<LatticeMethod> chosen_;  ///< of "auto"
  std::vector<LatticeTrial> trials_;
};

}  // namespace

Result<Design> design(const DesignSpec& spec, const SurfaceAssets& assets,
                      const Progress& progress) {
  if (is_of_parts(spec))
    return fail(
        ErrorKind::Infeasible, "/style",
        fmt::format("is {}, a card of several parts; 'popcut design' and 'popcut plan' make "
                    "it",
                    parts_word(spec)));
  if (is_of_facets(spec.style)) return facet_design(spec, assets, progress);
  return Designer(spec, assets, progress).run();
}

}  // namespace popcut
