// SPDX-License-Identifier: MIT
#include "core/design/book.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/design/design_report.hpp"
#include "core/design/shape_fit.hpp"
#include "core/design/strips/closing.hpp"
#include "core/design/strips/pattern_builder.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/design/target/strip_cut.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/geometry/angle.hpp"
#include "core/rigid/mobility.hpp"

namespace popcut {
namespace {

constexpr double kApart_mm = 10.0;  ///< between the cards where they are drawn side by side

std::string card_name(const DesignSpec& spec, std::size_t card) {
  return fmt::format("{}, card {}", spec.name, card + 1);
}

/// Whether every card shows the same: a surface of revolution about the spine, or one that is not
/// turned.
bool are_alike(const DesignSpec& spec) {
  const bool is_round = !spec.surface || std::holds_alternative<RevolutionSpec>(*spec.surface);
  if (is_round) return stays_on_spine(spec.placement);
  return !turns_with_cards(*spec.surface);
}

/// What the pages of all cards have in common, mm.
struct Page {
  double length{};  ///< from the spine outward
  double width{};   ///< along the spine
  double shift{};   ///< of the places along the target: v = s + shift
};

/// A slice that is laid: its strips, and how far they lie on the sheet from their place along the
/// target.
struct LaidPlace {
  std::size_t first{}, last{};
  double shift_mm{};
};

/// The laid slices of a card, along the spine. At a plain cut there is no connector, and blank
/// outer slices take more of the sheet than others: so shifts differ.
std::vector<LaidPlace> laid_places(const Design& card) {
  const Strips& strips = card.strips;
  std::vector<LaidPlace> out;
  std::int32_t slice = -1;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Slice && strips.kind[s] != StripKind::Box) continue;
    if (strips.slice[s] != slice) out.push_back({s, s, 0.0});
    slice = strips.slice[s];
    LaidPlace& at = out.back();
    at.last = s;
    at.shift_mm = 0.5 * (strips.v_begin[at.first] + strips.v_begin[s + 1]) -
                  card.report.slices[static_cast<std::size_t>(slice)].s_mm;
  }
  return out;
}

/// Moves the strips along the spine so that each slice is at its place along the target, and the
/// page has its width. What lies before a slice that moves is widened: a margin, a blank, a
/// connector, or the two slices at a plain cut by half of it each.
void straighten(Design& card, const Page& page) {
  Strips& strips = card.strips;
  std::vector<double> add(strips.v_begin.size());
  const std::vector<LaidPlace> places = laid_places(card);
  double before = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const LaidPlace& at = places[k];
    const double here = std::max(before, page.shift - at.shift_mm);
    const bool is_beside = k > 0 && places[k - 1].last + 1 == at.first;
    add[at.first] = is_beside ? 0.5 * (before + here) : here;
    std::fill(add.begin() + static_cast<std::ptrdiff_t>(at.first) + 1, add.end(), here);
    before = here;
  }
  for (std::size_t s = 1; s + 1 < add.size(); ++s) strips.v_begin[s] += add[s];
  strips.v_begin.back() = page.width;
  const std::vector<double> v_mm = slice_places(strips, card.report.slices.size());
  for (std::size_t k = 0; k < v_mm.size(); ++k) card.report.slices[k].v_mm = v_mm[k];
}

/// A card with another page. The strips' planes stay what they are.
Result<Design> with_page(Design made, const DesignSpec& spec, const SurfaceAssets& assets,
                         const Page& page) {
  const double page_mm = page.length;
  const std::vector<LaidPlace> places = laid_places(made);
  const bool is_as_wide = made.pattern.width_mm == page.width &&
                          std::all_of(places.begin(), places.end(), [&](const LaidPlace& at) {
                            return at.shift_mm == page.shift;
                          });
  if (made.pattern.model_placement)
    (*made.pattern.model_placement)[5] = spec.placement.translate_mm[1] + page.shift;
  if (made.pattern.wall_mm == page_mm && made.pattern.ground_mm == page_mm && is_as_wide)
    return made;
  if (is_of_facets(spec.style) || spec.splay) {
    if (!is_as_wide)
      return fail(ErrorKind::Infeasible, "/book",
                  "some of its slices are blank or cut apart, so that its pages are not those of "
                  "the other cards; use fewer or narrower slices");
    DesignSpec again = spec;
    again.card->wall_mm = again.card->ground_mm = page_mm;
    return design(again, assets);
  }
  if (!is_as_wide) straighten(made, page);
  set_card(made.strips, page_mm, page_mm);
  auto built = build_pattern(made.strips, page_mm, page_mm, true, spec.min_panel_mm);
  if (!built) return tl::unexpected(built.error());
  built->pattern.name = std::move(made.pattern.name);
  built->pattern.design_psi_rad = made.pattern.design_psi_rad;
  built->pattern.model_placement = made.pattern.model_placement;
  made.pattern = std::move(built->pattern);
  made.panel_face = std::move(built->panel_face);
  DesignReport& r = made.report;
  r.folds = r.cuts = 0;
  r.fold_length_mm = r.cut_length_mm = r.outline_length_mm = 0.0;
  count_pattern(made.pattern, r);
  return made;
}

/// A card on which nothing stands.
Result<Design> plain_card(const DesignSpec& spec, const Page& page) {
  const double page_mm = page.length;
  StripWriter writer;
  writer.start(0.0, page_mm);
  writer.panel_to(0.0, 0.0, kWallPlane);
  writer.panel_to(page_mm, 0.0, kGroundPlane);
  writer.close(StripKind::Margin, -1, page.width);
  Design out;
  out.strips = writer.take();
  auto built = build_pattern(out.strips, page_mm, page_mm, true, spec.min_panel_mm);
  if (!built) return tl::unexpected(built.error());
  const rigid::Mobility motion = rigid::mobility(built->section());
  out.pattern = std::move(built->pattern);
  out.panel_face = std::move(built->panel_face);
  out.pattern.design_psi_rad = psi_rad_of(spec.placement.design_angle_deg);
  DesignReport& r = out.report;
  r.lattice = "plain";
  r.units_per_slice = {0};
  r.design_angle_deg = spec.placement.design_angle_deg;
  r.degrees_of_freedom = motion.degrees_of_freedom, r.pieces = motion.pieces;
  r.fit_nearest = spec.fit == FitMode::Nearest;
  r.panels = out.strips.panels();
  r.notes.emplace_back("nothing of the shape is on this side of the spine: the card is plain");
  count_pattern(out.pattern, r);
  return out;
}

/// The cards of a book as they are designed, before they have one page.
class Binder {
 public:
  Binder(const DesignSpec& spec, const SurfaceAssets& assets, const Progress& progress)
      : spec_(spec),
        assets_(assets),
        progress_(progress),
        cards_(static_cast<std::size_t>(spec.book->cards)) {}

  Result<PatchAssembly> run() {
    const std::optional<double>& wall = spec_.card->wall_mm;
    const std::optional<double>& ground = spec_.card->ground_mm;
    if (wall && ground && *wall != *ground)
      return fail(ErrorKind::OutOfRange, "/card/ground_mm",
                  fmt::format("is {:g} mm, and the wall, which is glued onto the next ground, {:g} "
                              "mm; give both the same value, or leave both out",
                              *ground, *wall));
    const auto placement = book_placement(spec_, assets_);
    if (!placement) return tl::unexpected(placement.error());
    for (std::size_t i = 0; i < cards_; ++i) specs_.push_back(card_of_book(spec_, *placement, i));
    if (auto done = design_cards(); !done) return tl::unexpected(done.error());
    if (auto done = give_page(); !done) return tl::unexpected(done.error());
    return bound();
  }

 private:
  Result<void> design_cards() {
    out_.book.emplace();
    out_.book->is_alike = are_alike(spec_);
    out_.book->has_whole_target = spec_.surface && std::holds_alternative<MeshSpec>(*spec_.surface);
    made_.resize(cards_);
    const std::size_t different = out_.book->is_alike ? 1 : cards_;
    std::optional<Error> nothing;
    for (std::size_t i = 0; i < different; ++i) {
      const Progress of_card = progress_ ? Progress([&, i](std::string_view stage, double part) {
        progress_(fmt::format("card {} of {}: {}", i + 1, cards_, stage), part);
      })
                                         : Progress();
      auto made = design(specs_[i], assets_, of_card);
      if (made) {
        made_[i] = std::move(*made);
      } else if (is_nothing_there(made.error())) {
        if (!nothing) nothing = made.error();
      } else {
        return tl::unexpected(in_card(i, made.error()));
      }
    }
    if (std::none_of(made_.begin(), made_.end(),
                     [](const auto& card) { return card.has_value(); })) {
      nothing->reason = ErrorReason::None;  // no placement is proposed for a book
      return tl::unexpected(*nothing);
    }
    return {};
  }

  [[nodiscard]] static Error in_card(std::size_t card, Error error) {
    error.detail = fmt::format("card {} of the book: {}", card + 1, error.detail);
    return error;
  }

  /// The largest wall or ground of all, which clears each structure when it is shut, and the least
  /// width that has all slices at the same places.
  void find_page() {
    for (const auto& card : made_) {
      if (!card) continue;
      page_.length = std::max({page_.length, card->pattern.wall_mm, card->pattern.ground_mm});
      for (const LaidPlace& at : laid_places(*card))
        page_.shift = std::max(page_.shift, at.shift_mm);
    }
    for (const auto& card : made_)
      if (card)
        page_.width = std::max(
            page_.width, card->pattern.width_mm + page_.shift - laid_places(*card).back().shift_mm);
  }

  Result<void> give_page() {
    find_page();
    for (std::size_t i = 0; i < cards_; ++i) {
      if (i > 0 && out_.book->is_alike) break;
      const bool is_plain = !made_[i].has_value();
      auto card = is_plain ? plain_card(specs_[i], page_)
                           : with_page(std::move(*made_[i]), specs_[i], assets_, page_);
      if (!card) return tl::unexpected(in_card(i, card.error()));
      if (card->pattern.width_mm != page_.width || card->pattern.wall_mm != page_.length ||
          card->pattern.ground_mm != page_.length)
        return fail(ErrorKind::Internal, "/book",
                    fmt::format("the pages of card {} are not those of the others", i + 1));
      out_.book->is_plain.push_back(is_plain);
      out_.parts.push_back(std::move(*card));
    }
    while (out_.parts.size() < cards_) {
      out_.parts.push_back(out_.parts.front());
      out_.book->is_plain.push_back(out_.book->is_plain.front());
    }
    return {};
  }

  PatchAssembly bound() {
    BookReport& book = *out_.book;
    out_.name = spec_.name;
    book.angle_deg = spec_.book->angle_deg();
    book.page_mm = page_.length, book.width_mm = page_.width;
    book.shift_mm = page_.shift;
    double v = 0.0;
    for (std::size_t i = 0; i < cards_; ++i) {
      Pattern& pattern = out_.parts[i].pattern;
      pattern.name = out_.parts[i].report.name = card_name(spec_, i);
      pattern.place = {0.0, v};
      v += pattern.width_mm + kApart_mm;
      book.closed_mm = std::max(book.closed_mm, shut_reach_mm(pattern));
      if (i > 0) book.seams.push_back({i - 1, i});
    }
    out_.u_mm = 2.0 * page_.length, out_.v_mm = v - kApart_mm;
    return std::move(out_);
  }

  const DesignSpec& spec_;
  const SurfaceAssets& assets_;
  const Progress& progress_;
  std::size_t cards_;
  std::vector<DesignSpec> specs_;
  std::vector<std::optional<Design>> made_;  ///< none: nothing of the target is there
  Page page_;
  PatchAssembly out_;
};

/// The length of the slices along the spine, from the first one's middle to the last one's.
double slices_mm(const DesignSpec& spec) {
  const std::vector<double>& w = spec.widths_mm;
  if (w.empty()) return 0.0;
  return std::accumulate(w.begin(), w.end(), 0.0) - 0.5 * (w.front() + w.back());
}

}  // namespace

bool turns_with_cards(const SurfaceSpec& surface) {
  return std::holds_alternative<RevolutionSpec>(surface) ||
         std::holds_alternative<ImplicitSpec>(surface) || std::holds_alternative<MeshSpec>(surface);
}

Result<TargetPlacement> book_placement(const DesignSpec& spec, const SurfaceAssets& assets) {
  TargetPlacement out = spec.placement;
  if (!spec.surface || !std::holds_alternative<MeshSpec>(*spec.surface)) return out;
  if (!spec.book->is_turned) out.rotate_deg = {-90.0, 0.0, 0.0};
  if (spec.book->is_moved) return out;
  auto mesh = triangles_of(*spec.surface, assets);
  if (!mesh) return tl::unexpected(mesh.error());
  const auto turned = placed(std::move(*mesh), {out.scale_mm, out.rotate_deg, {}});
  if (!turned) return tl::unexpected(turned.error());
  const MeshBox box = box_of(*turned);
  const double length = is_of_facets(spec.style) ? box.high[1] - box.low[1] : slices_mm(spec);
  for (std::size_t k = 0; k < 3; ++k)
    out.translate_mm[k] = (k == 1 ? 0.5 * length : 0.0) - 0.5 * (box.low[k] + box.high[k]);
  return out;
}

DesignSpec card_of_book(const DesignSpec& spec, const TargetPlacement& placement,
                        std::size_t card) {
  DesignSpec out = spec;
  out.book.reset();
  out.is_card = true;
  if (!out.card->wall_mm) out.card->wall_mm = out.card->ground_mm;
  if (!out.card->ground_mm) out.card->ground_mm = out.card->wall_mm;
  out.name = card_name(spec, card);
  out.placement = placement;
  const bool turns = !spec.surface || turns_with_cards(*spec.surface);
  if (turns && !are_alike(spec))
    out.placement.about_spine_deg = spec.book->angle_deg() * static_cast<double>(card);
  return out;
}

Result<PatchAssembly> design_book(const DesignSpec& spec, const SurfaceAssets& assets,
                                  const Progress& progress) {
  return Binder(spec, assets, progress).run();
}

}  // namespace popcut
