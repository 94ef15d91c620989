// SPDX-License-Identifier: MIT
#include "core/design/patches.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/design/book.hpp"
#include "core/design/design_report.hpp"
#include "core/design/strips/multi_state.hpp"
#include "core/design/strips/pattern_builder.hpp"
#include "core/design/strips/pattern_join.hpp"
#include "core/design/strips/splay.hpp"
#include "core/design/strips/strip_bridge.hpp"
#include "core/design/strips/strip_builder.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/rigid/mobility.hpp"

namespace popcut {
namespace {

/// The error of patch k, with its place in the whole spec.
Error in_patch(std::size_t k, Error error) {
  const std::string place = fmt::format("/patches/{}", k);
  const bool is_pointer = !error.place.empty() && error.place.front() == '/';
  if (!is_pointer) return within(place, std::move(error));
  error.place = place + error.place;
  return error;
}

struct Misfit {
  double most_mm{};
  SectionPoint at;
};

/// The largest distance of either profile from the other.
Misfit misfit_of(const SliceCurve& a, const SliceCurve& b) {
  constexpr int kSamples = 400;
  Misfit out;
  const auto look = [&](const SliceCurve& from, const SliceCurve& to) {
    for (int i = 0; i <= kSamples; ++i) {
      const CurveJet c = from.at(-1.0 + 2.0 * i / kSamples);
      const double off = to.nearest_distance({c.x, c.z});
      if (!(off <= out.most_mm)) out = {off, {c.x, c.z}};
    }
  };
  look(a, b);
  look(b, a);
  return out;
}

/// Wall or ground of all patches: what they ask for, else what suits all that ask for nothing.
struct CardSide {
  std::vector<double> asked_mm;  ///< 0: nothing
  std::vector<double> own_mm;    ///< as the patch was designed
  std::vector<double> least_mm;  ///< that clears its structure

  [[nodiscard]] std::vector<double> chosen() const {
    double asked = 0.0, own = 0.0, least = 0.0;
    for (std::size_t k = 0; k < own_mm.size(); ++k) {
      asked = std::max(asked, asked_mm[k]);
      if (asked_mm[k] > 0.0) continue;
      own = std::max(own, own_mm[k]);
      least = std::max(least, least_mm[k]);
    }
    const double common = asked >= least && asked > 0.0 ? asked : std::max(own, asked);
    std::vector<double> out(own_mm.size(), common);
    for (std::size_t k = 0; k < out.size(); ++k)
      if (asked_mm[k] > 0.0) out[k] = asked_mm[k];
    return out;
  }
};

class Assembler {
 public:
  Assembler(const DesignSpec& spec, const SurfaceAssets& assets, const Progress& progress)
      : spec_(spec), assets_(assets), progress_(progress) {}

  Result<PatchAssembly> run() {
    out_.name = spec_.name;
    for (std::size_t k = 0; k < spec_.patches.size(); ++k) {
      auto made = design(spec_.patches[k], assets_, progress_);
      if (!made) return tl::unexpected(in_patch(k, made.error()));
      made_.push_back(std::move(*made));
    }
    choose_cards();
    for (std::size_t k = 0; k + 1 < made_.size(); ++k)
      if (auto joined = join(k); !joined) return tl::unexpected(joined.error());
    for (std::size_t k = 0; k < made_.size();) {
      std::size_t end = k + 1;
      while (end < made_.size() && !out_.joins[end - 1].is_seam) ++end;
      if (auto added = add_part(k, end); !added) return tl::unexpected(added.error());
      k = end;
    }
    place_parts();
    return std::move(out_);
  }

 private:
  void choose_cards() {
    CardSide walls, grounds;
    for (std::size_t k = 0; k < made_.size(); ++k) {
      const DesignSpec& patch = spec_.patches[k];
      const Reach reach = reach_of_strips(made_[k].strips);
      walls.asked_mm.push_back(patch.card->wall_mm.value_or(0.0));
      walls.own_mm.push_back(made_[k].pattern.wall_mm);
      walls.least_mm.push_back(reach.wall_mm + patch.min_panel_mm);
      grounds.asked_mm.push_back(patch.card->ground_mm.value_or(0.0));
      grounds.own_mm.push_back(made_[k].pattern.ground_mm);
      grounds.least_mm.push_back(reach.ground_mm + patch.min_panel_mm);
    }
    wall_mm_ = walls.chosen();
    ground_mm_ = grounds.chosen();
  }

  /// The highest and the farthest point of the strips beside wall and ground.
  static Reach reach_of_strips(const Strips& strips) {
    Reach reach;
    for (std::size_t s = 0; s < strips.size(); ++s)
      for (std::size_t q = strips.first_point(s) + 1; q < strips.first_panel[s + 1] + s; ++q) {
        reach.wall_mm = std::max(reach.wall_mm, strips.z[q]);
        reach.ground_mm = std::max(reach.ground_mm, strips.x[q]);
      }
    return reach;
  }

  /// Decides how patch k is joined to the next one, and checks that they fit.
  Result<void> join(std::size_t k) {
    JoinReport report;
    report.left = k;
    const Misfit misfit = misfit_of(made_[k].edges.back(), made_[k + 1].edges.front());
    report.misfit_mm = misfit.most_mm, report.misfit_at = misfit.at;
    if (!(misfit.most_mm <= spec_.join_tolerance_mm))
      return fail(ErrorKind::Infeasible, fmt::format("/patches/{}", k + 1),
                  fmt::format("its edge misses that of the patch before by {:.4g} mm, most at x = "
                              "{:.4g}, z = {:.4g} mm; move or scale one of them, or allow more "
                              "than join_tolerance_mm = {:g}",
                              misfit.most_mm, misfit.at.x, misfit.at.z, spec_.join_tolerance_mm));
    std::string apart;
    if (wall_mm_[k] != wall_mm_[k + 1])
      apart =
          fmt::format("their walls are {:.4f} and {:.4f} mm high", wall_mm_[k], wall_mm_[k + 1]);
    else if (ground_mm_[k] != ground_mm_[k + 1])
      apart = fmt::format("their grounds are {:.4f} and {:.4f} mm deep", ground_mm_[k],
                          ground_mm_[k + 1]);
    const PatchJoin asked = spec_.joins[k];
    if (asked == PatchJoin::Sheet && !apart.empty())
      return fail(ErrorKind::Infeasible, fmt::format("/patches/{}/card", k + 1),
                  fmt::format("patches {} and {} cannot be one sheet, {}; give both the same, or "
                              "join them by a seam",
                              k, k + 1, apart));
    report.is_seam = asked == PatchJoin::Seam || !apart.empty();
    report.reason = asked == PatchJoin::Seam ? "asked for" : apart;
    out_.joins.push_back(std::move(report));
    return {};
  }

  /// Strips of a part, its pattern and its freedoms, with bridges at the borders or without.
  struct Laid {
    JoinedStrips joined;
    std::vector<BridgeReport> bridges;
    BuiltPattern built;
    rigid::Mobility motion;
  };
  [[nodiscard]] Result<Laid> lay(std::size_t begin, std::size_t end, bool bridging) const {
    std::vector<const Strips*> strips;
    for (std::size_t k = begin; k < end; ++k) strips.push_back(&made_[k].strips);
    Laid out;
    out.joined = join_strips(strips, wall_mm_[begin], ground_mm_[begin]);
    double min_panel = 0.0, narrowest = spec_.patches[begin].min_panel_mm;
    std::vector<BridgeAim> aims;
    for (std::size_t k = begin; k < end; ++k) {
      min_panel = std::max(min_panel, spec_.patches[k].min_panel_mm);
      narrowest = std::min(narrowest, spec_.patches[k].min_panel_mm);
      if (bridging && k + 1 < end)
        aims.push_back({out.joined.border[k - begin], &made_[k].edges.back()});
    }
    BridgedStrips bridged = add_bridges(out.joined.strips, aims, min_panel);
    out.joined.strips = std::move(bridged.strips);
    out.bridges = std::move(bridged.made);
    auto built =
        build_pattern(out.joined.strips, wall_mm_[begin], ground_mm_[begin], true, narrowest);
    if (!built) return tl::unexpected(built.error());
    out.built = std::move(*built);
    out.motion = rigid::mobility(out.built.section());
    return out;
  }

  Result<void> add_part(std::size_t begin, std::size_t end) {
    auto laid = lay(begin, end, true);
    if (laid && laid->motion.degrees_of_freedom != 1) laid = lay(begin, end, false);
    if (!laid) return tl::unexpected(laid.error());
    if (laid->motion.degrees_of_freedom != 1 || laid->motion.pieces != 1)
      return fail(ErrorKind::Internal, fmt::format("/patches/{}", begin),
                  fmt::format("joined with its neighbours it would have {} degrees of freedom; "
                              "join it by a seam",
                              laid->motion.degrees_of_freedom));
    for (std::size_t k = begin; k < end; ++k)
      if (auto done = add_splay(k, laid->joined, k - begin, laid->built.pattern); !done)
        return tl::unexpected(in_patch(k, done.error()));
    for (std::size_t k = begin; k < end; ++k) {
      const int first = laid->joined.first_slice[k - begin];
      out_.patches.push_back({spec_.patches[k].name, out_.parts.size(), first,
                              static_cast<int>(made_[k].report.slices.size()), 0.0, 0.0});
      if (k + 1 < end) note_border(k, laid->joined.first_slice[k + 1 - begin] - 1, laid->bridges);
    }
    Design part;
    part.report = joined_report(std::span(made_).subspan(begin, end - begin), laid->joined,
                                laid->bridges, laid->built.pattern);
    part.report.degrees_of_freedom = laid->motion.degrees_of_freedom;
    part.report.pieces = laid->motion.pieces;
    const bool all_free =
        std::all_of(spec_.patches.begin() + static_cast<std::ptrdiff_t>(begin),
                    spec_.patches.begin() + static_cast<std::ptrdiff_t>(end),
                    [](const DesignSpec& patch) { return patch.card->shut == CardShut::Free; });
    add_closing(laid->built.pattern, all_free ? CardShut::Free : CardShut::Inside, part.report);
    part.target = targets_of(begin, end, part.report, laid->joined);
    laid->built.pattern.design_psi_rad = made_[begin].pattern.design_psi_rad;
    part.strips = std::move(laid->joined.strips);
    part.pattern = std::move(laid->built.pattern);
    part.panel_face = std::move(laid->built.panel_face);
    out_.parts.push_back(std::move(part));
    return {};
  }

  /// The targets of the patches of a part, each at its place along the part.
  [[nodiscard]] std::vector<TargetPiece> targets_of(std::size_t begin, std::size_t end,
                                                    const DesignReport& report,
                                                    const JoinedStrips& joined) const {
    std::vector<TargetPiece> out;
    for (std::size_t k = begin; k < end; ++k) {
      const std::vector<SliceReport>& own = made_[k].report.slices;
      const auto first = static_cast<std::size_t>(joined.first_slice[k - begin]);
      const double shift = report.slices[first].s_mm - own.front().s_mm;
      for (TargetPiece piece : made_[k].target) {
        piece.origin_mm += shift, piece.from_mm += shift, piece.to_mm += shift;
        if (k > begin)
          piece.from_mm =
              std::max(piece.from_mm, own.front().s_mm - 0.5 * own.front().width_mm + shift);
        if (k + 1 < end)
          piece.to_mm = std::min(piece.to_mm, own.back().s_mm + 0.5 * own.back().width_mm + shift);
        out.push_back(std::move(piece));
      }
    }
    return out;
  }

  /// V-folds of patch k on its own part of a sheet.
  [[nodiscard]] Result<void> add_splay(std::size_t k, const JoinedStrips& joined,
                                       std::size_t in_part, Pattern& pattern) const {
    const auto& splay = spec_.patches[k].splay;
    if (!splay) return {};
    const std::int32_t first = joined.first_slice[in_part];
    const Strips own = only_connectors_of(
        joined.strips, first, first + static_cast<std::int32_t>(made_[k].report.slices.size()));
    if (splay->targets.empty()) return add_v_folds(own, *splay, pattern);
    auto solved = solve_multi_state(made_[k].strips, *splay);
    if (!solved) return tl::unexpected(solved.error());
    return add_v_folds(own, solved->splay, pattern);
  }

  void note_border(std::size_t k, int last_slice, const std::vector<BridgeReport>& bridges) {
    const auto bridge = std::find_if(bridges.begin(), bridges.end(),
                                     [&](const BridgeReport& b) { return b.slice == last_slice; });
    out_.joins[k].reason = bridge == bridges.end()
                               ? "a plain cut between slices"
                               : fmt::format(
                                     "a connector of {} and {} planes, {:.3g} mm off the "
                                     "target at most",
                                     bridge->left_planes, bridge->right_planes, bridge->off_mm);
  }

  /// Puts the parts side by side with their spines in line, and declares the seams.
  void place_parts() {
    double wall = 0.0, ground = 0.0;
    for (const Design& part : out_.parts) {
      wall = std::max(wall, part.pattern.wall_mm);
      ground = std::max(ground, part.pattern.ground_mm);
    }
    double v = 0.0;
    for (std::size_t p = 0; p < out_.parts.size(); ++p) {
      Pattern& pattern = out_.parts[p].pattern;
      pattern.name =
          out_.parts.size() == 1 ? spec_.name : fmt::format("{}, part {}", spec_.name, p + 1);
      out_.parts[p].report.name = pattern.name;
      pattern.place = {wall - pattern.wall_mm, v};
      v += pattern.width_mm;
    }
    out_.u_mm = wall + ground, out_.v_mm = v;
    place_patches();
    std::int32_t id = 0;
    for (JoinReport& join : out_.joins)
      if (join.is_seam) declare_seam(join, ++id);
  }

  void place_patches() {
    for (std::size_t k = 0; k < out_.patches.size(); ++k) {
      PatchReport& patch = out_.patches[k];
      const Design& part = out_.parts[patch.part];
      const Strips& strips = part.strips;
      const bool first = k == 0 || out_.patches[k - 1].part != patch.part;
      const bool last = k + 1 == out_.patches.size() || out_.patches[k + 1].part != patch.part;
      double begin = first ? 0.0 : part.pattern.width_mm, end = last ? part.pattern.width_mm : 0.0;
      for (std::size_t s = 0; s < strips.size(); ++s) {
        if (strips.slice[s] < patch.first_slice ||
            strips.slice[s] >= patch.first_slice + patch.slices)
          continue;
        begin = std::min(begin, strips.v_begin[s]);
        // A bridge to the next patch is halved between them.
        const bool to_next = strips.kind[s] == StripKind::Bridge &&
                             strips.slice[s] + 1 == patch.first_slice + patch.slices;
        const double v =
            to_next ? 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]) : strips.v_begin[s + 1];
        end = std::max(end, v);
      }
      patch.v_begin_mm = part.pattern.place.v_mm + begin;
      patch.v_end_mm = part.pattern.place.v_mm + end;
      if (!first) patch.v_begin_mm = out_.patches[k - 1].v_end_mm;
      if (k > 0) out_.joins[k - 1].v_mm = patch.v_begin_mm;
    }
  }

  /// Both margins along the stretch of the border that the two parts share.
  void declare_seam(JoinReport& join, std::int32_t id) {
    const std::size_t a = out_.patches[join.left].part, b = a + 1;
    Pattern &left = out_.parts[a].pattern, &right = out_.parts[b].pattern;
    const auto end = [](const Pattern& p) { return p.place.u_mm + p.wall_mm + p.ground_mm; };
    const double from = std::max(left.place.u_mm, right.place.u_mm);
    const double to = std::min(end(left), end(right));
    left.seams.push_back({id, static_cast<std::int32_t>(b), left.width_mm, from - left.place.u_mm,
                          to - left.place.u_mm});
    right.seams.push_back(
        {id, static_cast<std::int32_t>(a), 0.0, from - right.place.u_mm, to - right.place.u_mm});
    join.seam_mm = to - from;
  }

  const DesignSpec& spec_;
  const SurfaceAssets& assets_;
  const Progress& progress_;
  std::vector<Design> made_;
  std::vector<double> wall_mm_, ground_mm_;
  PatchAssembly out_;
};

Result<PatchAssembly> assembly_of(const DesignSpec& spec, const SurfaceAssets& assets,
                                  const Progress& progress) {
  if (spec.book) return design_book(spec, assets, progress);
  if (!spec.patches.empty()) return Assembler(spec, assets, progress).run();
  auto made = design(spec, assets, progress);
  if (!made) return tl::unexpected(made.error());
  PatchAssembly out;
  out.name = spec.name;
  out.u_mm = made->report.sheet_u_mm, out.v_mm = made->report.sheet_v_mm;
  out.parts.push_back(std::move(*made));
  return out;
}

}  // namespace

Result<PatchAssembly> design_assembly(const DesignSpec& spec, const SurfaceAssets& assets,
                                      const Progress& progress) {
  auto made = assembly_of(spec, assets, progress);
  if (!made || made->parts.empty()) return made;
  for (Design& part : made->parts)
    (spec.is_draft ? add_hands_of_draft : add_hands)(part.pattern, part.report);
  std::vector<Warning>& warnings = made->parts.front().report.warnings;
  const auto add = [&](const std::optional<SurfaceSpec>& surface) {
    if (!surface) return;
    for (Warning& one : target_warnings(*surface, assets)) warnings.push_back(std::move(one));
  };
  add(spec.surface);
  for (const DesignSpec& patch : spec.patches) add(patch.surface);
  return made;
}

}  // namespace popcut
