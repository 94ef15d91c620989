// SPDX-License-Identifier: MIT
#include "core/design/boxes/boxed_card.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/design/boxes/box_ends.hpp"
#include "core/design/layers/layered_card.hpp"
#include "core/design/target/surface.hpp"
#include "core/fit/fit.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/parts/elements.hpp"

namespace popcut {
namespace {

constexpr double kMargin_mm = 8.0;  ///< of the pages, around all that is shut or open
constexpr double kLeastSize_mm = 20.0;
constexpr double kOnPage_mm = 0.05;       ///< what is no higher lies on the pages
constexpr double kLeastShown = 0.5;       ///< of the target within `kShownWithin` of the boxes
constexpr std::size_t kShownWithin = 1;   ///< of `FitFigures::kWithin`: 2 % of its size
constexpr std::size_t kFilledBeyond = 2;  ///< of `FitFigures::kWithin`: 5 % of its size
constexpr double kMostMisfit = 0.12;      ///< volume that differs, seen from above
constexpr double kMostEaves = 0.97;       ///< of the longest that can shut
constexpr double kFar_mm = 1e4;

struct Size {
  Vec3 low, high;
};
Size size_of(const TriangleSoup& soup) {
  Size out{soup.corner(0, 0), soup.corner(0, 0)};
  for (std::size_t t = 0; t < soup.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      out.low = out.low.cwiseMin(soup.corner(t, k)),
      out.high = out.high.cwiseMax(soup.corner(t, k));
  return out;
}

/// The surface in millimetres, its middle at x = 0 and y = 0, its foot at z = 0.
Result<TriangleSoup> upright_target(const DesignSpec& spec, const SurfaceAssets& assets,
                                    BoxedCard& out) {
  out.placement = spec.placement;
  out.placement.translate_mm = {kFar_mm, 0.0, kFar_mm};  // away from wall and ground
  const auto surface = Surface::make(*spec.surface, out.placement, FitMode::Nearest, assets);
  if (!surface) return tl::unexpected(surface.error());
  TriangleSoup soup = surface->triangles({});
  if (soup.size() == 0) return fail(ErrorKind::Infeasible, "/surface", "has no surface");
  const Size box = size_of(soup);
  const Vec3 size = box.high - box.low;
  out.origin =
      Vec3{0.5 * (box.low.x() + box.high.x()), 0.5 * (box.low.y() + box.high.y()), box.low.z()};
  for (std::size_t k = 0; k < soup.corners.size(); ++k)
    soup.corners[k] -= out.origin[static_cast<Eigen::Index>(k % 3)];
  if (size.minCoeff() < kLeastSize_mm)
    return fail(ErrorKind::Infeasible, "/scale_mm",
                fmt::format("makes the shape {:.3g} x {:.3g} mm wide and {:.3g} mm high; boxes "
                            "need at least {:g} mm: give a larger one",
                            size.x(), size.y(), size.z(), kLeastSize_mm));
  return soup;
}

/// Shortens eaves that would pass through the pages as the card shuts, and makes room between
/// blocks that touch.
void make_foldable(BlockRow& row, double thickness_mm, std::vector<Warning>& warnings) {
  for (std::size_t k = 0; k < row.blocks.size(); ++k) {
    Block& block = row.blocks[k];
    if (row.touches[k]) {
      Block& next = row.blocks[k + 1];
      const double border = 0.5 * (block.to_mm + next.from_mm);
      block.to_mm = border - 0.5 * thickness_mm, next.from_mm = border + 0.5 * thickness_mm;
    }
    const double p = std::hypot(block.half_mm, block.rise_mm),
                 most = kMostEaves * block.height_mm * p / (p + block.half_mm);
    if (block.is_tent() || block.eaves_mm <= most) continue;
    warnings.push_back(
        {.code = "eaves_shortened",
         .message = fmt::format("the eaves of box {} are {:.1f} mm, not {:.1f}: longer ones would "
                                "pass through the pages as the card shuts",
                                k + 1, most, block.eaves_mm)});
    block.eaves_mm = most;
  }
}

const char* word_of(const Block& block) { return block.is_tent() ? "tent" : "box"; }

/// Builds the blocks on a card, whatever its pages are.
Result<void> add_blocks(const BlockRow& row, BoxedCard& out) {
  const auto boxes = firm_boxes(row);
  if (!boxes) return tl::unexpected(boxes.error());
  for (std::size_t k = 0; k < row.blocks.size(); ++k) {
    const Block& block = row.blocks[k];
    const std::size_t first = out.card.parts.size();
    const std::string name = fmt::format("{}-{}", word_of(block), k + 1);
    const auto put = [&](auto element) -> Result<void> {
      element.name = name;
      if (auto done = can_move(element); !done)
        return tl::unexpected(within(fmt::format("/boxes: {}", name), done.error()));
      build(out.card, spine_of(out.card), element);
      return {};
    };
    const BoxElement box = block.is_tent() ? BoxElement{} : (*boxes)[k];
    const auto done = block.is_tent() ? put(tent_of(block)) : put(box);
    if (!done) return done;
    CardBox made;
    made.name = name, made.block = block;
    made.first_part = first, made.parts = out.card.parts.size() - first;
    made.inner_mm = box.inner_mm, made.bend_mm = box.bend_mm;
    made.off_mm = block.is_tent() ? 0.0 : box.bend_mm - std::abs(box.from_mm - block.from_mm);
    if (box.inner_mm > 0.0) made.inner_part = out.card.parts.size() - 1;
    for (std::size_t p = first; p < out.card.parts.size(); ++p)
      made.panels += out.card.parts[p].faces.size() - out.card.parts[p].tabs.size();
    out.panels += made.panels;
    out.boxes.push_back(std::move(made));
  }
  return {};
}

/// What the boxes take of the pages, shut and open: from the spine outward, and along it.
struct Needed {
  double page_mm{}, low_mm{}, high_mm{};
};
Needed needed_by(const Structure& card) {
  constexpr double kShut_rad = 1e-5, kOpen_rad = radians(179.99);
  Needed out{0.0, std::numeric_limits<double>::infinity(), -kFar_mm};
  for (const double opening : {kShut_rad, 0.5 * std::numbers::pi, kOpen_rad}) {
    const PartPoses pose = posed(card, opening);
    for (std::size_t p = 1; p < card.parts.size(); ++p)
      for (std::size_t f = 0; f < card.parts[p].faces.size(); ++f)
        for (const std::uint32_t v : card.parts[p].faces[f]) {
          const Vec2 flat = card.parts[p].vertices[v];
          const Vec3 at = pose[p][f] * Vec3{flat.x(), flat.y(), 0.0};
          // The right page lies along x, the left one turns; open it is at -x.
          if (opening != 0.5 * std::numbers::pi)
            out.page_mm = std::max(out.page_mm, std::abs(at.x()));
          out.low_mm = std::min(out.low_mm, at.y()), out.high_mm = std::max(out.high_mm, at.y());
        }
  }
  return out;
}

/// The lengths that a card of the spec has, or those that are needed.
Result<double> length_for(const std::optional<double>& given, double needed, const char* field,
                          const char* what) {
  if (!given) return needed;
  if (*given < needed)
    return fail(ErrorKind::Infeasible, fmt::format("/boxes/{}", field),
                fmt::format("is {:g}; the boxes need {} of at least {:.4g} mm, or a smaller "
                            "scale_mm",
                            *given, what, needed));
  return *given;
}

/// What of a target a person sees on the pages, which lie below its foot.
TriangleSoup shown_of(const TriangleSoup& whole) {
  constexpr std::size_t kSeenCells = 700;
  const TriangleSoup target = seen_from_around(whole, kSeenCells);
  TriangleSoup out;
  for (std::size_t t = 0; t < target.size(); ++t) {
    const std::array<Vec3, 3> at{target.corner(t, 0), target.corner(t, 1), target.corner(t, 2)};
    if (std::max({at[0].z(), at[1].z(), at[2].z()}) > kOnPage_mm) out.add(at[0], at[1], at[2]);
  }
  return out;
}

void warn_of_rest(const BlockRow& row, BoxedCard& out) {
  if (row.aside > 0)
    out.warnings.push_back(
        {.code = "boxes_aside",
         .message = fmt::format("{} part{} of the shape stand{} beside the middle of the others "
                                "and {} left out: all boxes stand over the spine",
                                row.aside, row.aside == 1 ? "" : "s", row.aside == 1 ? "s" : "",
                                row.aside == 1 ? "is" : "are")});
  const double rest = 1.0 - out.fit.share_within[kShownWithin];
  constexpr double kSmallRest = 0.01;
  if (rest > kSmallRest)
    out.warnings.push_back(
        {.code = "left_out",
         .message =
             fmt::format("{:.0f} % of the shape's surface, such as dormers, chimneys and "
                         "what stands beside the walls, is farther than {:.1f} mm from the "
                         "boxes and left out",
                         100.0 * rest, FitFigures::kWithin[kShownWithin] * out.fit.size_mm)});
  const double filled = 1.0 - out.fit.structure_within[kFilledBeyond];
  constexpr double kSmallGap = 0.02;
  if (filled > kSmallGap)
    out.warnings.push_back(
        {.code = "gaps_filled",
         .message =
             fmt::format("{:.0f} % of the boxes' paper is farther than {:.1f} mm from the shape: "
                         "boxes have no openings, such as gates and arches, and only flat, gabled "
                         "and pyramid roofs",
                         100.0 * filled, FitFigures::kWithin[kFilledBeyond] * out.fit.size_mm)});
}

}  // namespace

double BoxedCard::near_mm(std::size_t part) const {
  constexpr double kNear = 0.02;  // of the target's size
  const auto box = std::find_if(boxes.begin(), boxes.end(),
                                [&](const CardBox& one) { return one.first_part == part; });
  return kNear * fit.size_mm + (box == boxes.end() ? 0.0 : box->off_mm);
}

std::vector<float> seen_in_front(const TriangleSoup& soup, bool faces_along_spine) {
  std::vector<float> out(soup.corners.begin(), soup.corners.end());
  for (std::size_t k = 0; faces_along_spine && k + 2 < out.size(); k += 3)
    std::swap(out[k], out[k + 1]), out[k + 1] = -out[k + 1];
  return out;
}

std::vector<OpenPanel> open_panels(const BoxedCard& made) {
  const Structure& card = made.card;
  const PartPoses pose = open_pose(made);
  std::vector<OpenPanel> out;
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    if (made.is_inner(p)) continue;
    const SheetPart& part = card.parts[p];
    for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
      std::vector<Triangle> triangles;
      if ((p == 0 && (f == card.pages[0] || f == card.pages[1])) ||
          std::find(part.tabs.begin(), part.tabs.end(), f) != part.tabs.end() ||
          !triangulate(part.vertices, part.faces[f], triangles))
        continue;
      const auto at = [&](std::uint32_t v) {
        return Vec3(pose[p][f] * Vec3{part.vertices[v].x(), part.vertices[v].y(), 0.0});
      };
      OpenPanel panel{p, {}};
      for (const auto& [a, b, c] : triangles) panel.triangles.add(at(a), at(b), at(c));
      out.push_back(std::move(panel));
    }
  }
  return out;
}

void measure(BoxedCard& out) {
  TriangleSoup panels;
  for (const OpenPanel& panel : open_panels(out))
    panels.corners.insert(panels.corners.end(), panel.triangles.corners.begin(),
                          panel.triangles.corners.end());
  const TriangleSoup shown = shown_of(out.target);
  out.fit = FitTarget(shown).measure(panels);
  out.fit.out_of_reach = {};
  const bool turns = out.faces_along_spine();
  likeness::Scene scene{likeness::cone_views(), 512, {}};
  if (out.is_of_facets()) scene.corner = likeness::Corner{};
  // Facets are compared as 'popcut compare' does: with all of the target that is in the corner.
  const TriangleSoup& whole = out.is_of_facets() ? out.target : shown;
  out.seen =
      likeness::Target(seen_in_front(whole, turns), scene).measure(seen_in_front(panels, turns));
}

Result<BoxedCard> boxed_card(const DesignSpec& spec, const SurfaceAssets& assets,
                             const Progress& progress) {
  tell(progress, "reading the shape");
  BoxedCard out;
  auto target = upright_target(spec, assets, out);
  if (!target) return tl::unexpected(target.error());
  tell(progress, "finding walls and roofs");
  constexpr const char* kNoBoxes =
      "has no boxes: a card of them needs upright walls at right angles to each other, and flat or "
      "gabled roofs; for other shapes use the style layers or slices";
  const double thickness_mm = out.card.thickness_mm;
  BlockRows rows = block_rows(*target, {}, [&](const Block& block, bool before, bool after) {
    return can_stand(block, before, after, thickness_mm);
  });
  // Where none can stand that is near enough, the nearest says why not.
  const bool stands = !rows.standing.empty() && rows.standing.misfit <= kMostMisfit;
  BlockRow row = std::move(stands ? rows.standing : rows.nearest);
  if (row.empty()) return fail(ErrorKind::Infeasible, "/surface", kNoBoxes);
  if (row.misfit > kMostMisfit)
    return fail(
        ErrorKind::Infeasible, "/surface",
        fmt::format("{}; the nearest boxes differ from it by {:.0f} % of its volume, and at "
                    "most {:.0f} % is allowed",
                    kNoBoxes, 100.0 * row.misfit, 100.0 * kMostMisfit));
  if (row.blocks.size() > static_cast<std::size_t>(spec.boxes.most))
    return fail(
        ErrorKind::Infeasible, "/boxes/most",
        fmt::format("is {}; the shape has {} boxes in a row: {}", spec.boxes.most,
                    row.blocks.size(),
                    row.blocks.size() > kMostBoxes
                        ? fmt::format("a card has at most {}, so give a part of it", kMostBoxes)
                        : fmt::format("give {}", row.blocks.size())));
  out.card.name = spec.name;
  out.card.tab_mm = kBoxTab_mm;
  make_foldable(row, out.card.thickness_mm, out.warnings);
  const auto empty_card = [&](double page_mm, double length_mm) {
    Structure card = plain_card(page_mm, length_mm);
    card.name = out.card.name, card.tab_mm = out.card.tab_mm;
    return card;
  };
  BoxedCard trial;
  trial.card = empty_card(kFar_mm, kFar_mm);
  if (auto done = add_blocks(row, trial); !done) return tl::unexpected(done.error());
  const Needed needed = needed_by(trial.card);
  const auto page = length_for(spec.boxes.page_mm, needed.page_mm + kMargin_mm, "page_mm", "pages");
  if (!page) return tl::unexpected(page.error());
  const auto spine =
      length_for(spec.boxes.spine_mm, needed.high_mm - needed.low_mm + 2.0 * kMargin_mm, "spine_mm",
                 "a spine");
  if (!spine) return tl::unexpected(spine.error());
  out.turn_rad = row.turn_rad;
  out.shift = {-row.middle_mm, 0.5 * (*spine - needed.high_mm - needed.low_mm), 0.0};
  for (Block& block : row.blocks) {
    block.from_mm += out.shift.y(), block.to_mm += out.shift.y();
    block.middle_mm = 0.0;
  }
  out.card = empty_card(*page, *spine);
  if (auto done = add_blocks(row, out); !done) return tl::unexpected(done.error());
  if (auto done = shuts_inside(out.card, 1); !done)
    return tl::unexpected(within("/boxes", done.error()));
  move_to_card(out, target->corners);
  out.target = std::move(*target);
  tell(progress, "measuring the distance from the shape");
  measure(out);
  if (out.fit.share_within[kShownWithin] < kLeastShown)
    return fail(ErrorKind::Infeasible, "/surface",
                fmt::format("{}; the nearest boxes show {:.0f} % of it within {:.0f} % of its size",
                            kNoBoxes, 100.0 * out.fit.share_within[kShownWithin],
                            100.0 * FitFigures::kWithin[kShownWithin]));
  const PartsWork work = parts_work(out.card);
  out.folds = work.folds, out.tabs = work.tabs, out.handwork = work.handwork;
  warn_of_rest(row, out);
  return out;
}

PartPoses pose_at(const BoxedCard& made, double opening_rad) {
  PartPoses out = posed(made.card, opening_rad);
  if (made.is_of_facets()) return out;
  const Eigen::Isometry3d turn(
      Eigen::AngleAxisd(-0.5 * (std::numbers::pi - opening_rad), Vec3{0.0, 1.0, 0.0}));
  for (auto& part : out)
    for (Eigen::Isometry3d& face : part) face = turn * face;
  return out;
}

PartPoses open_pose(const BoxedCard& made) {
  constexpr double kOpen_rad = radians(179.99);  // closed forms end before 180 degrees
  return pose_at(made, std::min(kOpen_rad, radians(made.card.opens_deg)));
}

void move_to_card(const BoxedCard& made, std::vector<double>& corners) {
  TriangleSoup soup{std::move(corners)};
  turn_about_z(soup, made.turn_rad);
  corners = std::move(soup.corners);
  for (std::size_t k = 0; k < corners.size(); ++k)
    corners[k] += made.shift[static_cast<Eigen::Index>(k % 3)];
}

}  // namespace popcut
