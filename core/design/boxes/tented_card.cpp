// SPDX-License-Identifier: MIT
#include "core/design/boxes/tented_card.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/design/facet_design.hpp"
#include "core/design/layers/layered_card.hpp"
#include "core/parts/elements.hpp"

namespace popcut {
namespace {

constexpr double kRoofTab_mm = 7.0;
constexpr double kBeside_mm = 1.0;  ///< from a roof to what is beside it, whose contours are moved

/// The sheet as the first part of a card: u = 0 at the spine.
Structure sheet_of(const FacetCard& made) {
  const BuiltPattern& built = made.pattern.built;
  const Pattern& pattern = built.pattern;
  Structure card;
  card.page_mm = std::min(pattern.wall_mm, pattern.ground_mm), card.length_mm = pattern.width_mm;
  card.opens_deg = 90.0, card.tab_mm = kRoofTab_mm;
  SheetPart sheet;
  sheet.name = "card";
  for (const PatternVertex& p : pattern.vertices)
    sheet.vertices.push_back({pattern.u(p) - pattern.wall_mm, p.v});
  for (std::uint32_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    sheet.faces.emplace_back(face.begin(), face.end());
    const bool upright = built.upright[f] != 0;
    const PatternVertex& corner = pattern.vertices[face.front()];
    card.planes.push_back({upright, upright ? corner.x : corner.z});
    for (const std::uint32_t v : face) {
      const PatternVertex& p = pattern.vertices[v];
      if (p.z >= pattern.wall_mm) card.pages[0] = f;
      if (p.x >= pattern.ground_mm) card.pages[1] = f;
    }
  }
  for (const SheetLine& line : pattern.lines)
    if (line.role == EdgeRole::Slit)
      sheet.slits.push_back(
          {Vec2{line.u0 - pattern.wall_mm, line.v0}, Vec2{line.u1 - pattern.wall_mm, line.v1}});
  card.parts.push_back(std::move(sheet));
  return card;
}

/// Glues a roof and its strut on the sheet.
Result<CardTent> add_tent(const FacetCard& made, const TentRun& run, const std::string& name,
                          Structure& card) {
  const double step = made.grid.step_mm, strip = made.grid.strip_mm;
  CardTent out;
  out.name = name, out.section = run.section;
  out.along_mm = {made.card.margin_mm + run.first * strip + kBeside_mm,
                  made.card.margin_mm + run.end * strip - kBeside_mm};
  // Runs of a strip: wall, level panel, front, ground.
  const auto face = [&](std::size_t k) {
    return static_cast<std::uint32_t>(made.pattern.face_of(run.first, k));
  };
  const Vec2 fold{-step * run.level.offset, 0.0}, along{0.0, 1.0};
  const Seat seat{{0, face(0), fold, along, {-1.0, 0.0}}, {0, face(1), fold, along, {1.0, 0.0}}};
  out.roof_part = card.parts.size(), out.strut_part = out.roof_part + 1;
  add_glued_roof(card, seat, face(2), run.section, name, out.along_mm[0], out.along_mm[1]);
  if (auto done = shuts_inside(card, out.roof_part); !done)
    return tl::unexpected(within("/facets/sloped", done.error()));
  return out;
}

}  // namespace

Result<BoxedCard> tented_card(const DesignSpec& spec, const SurfaceAssets& assets,
                              double most_play_mm, const Progress& progress) {
  tell(progress, "reading the shape");
  const auto target = facet_target(spec, assets);
  if (!target) return tl::unexpected(target.error());
  const auto made = facets_of(spec, *target, most_play_mm, progress);
  if (!made) return tl::unexpected(made.error());
  if (made->pattern.motion.degrees_of_freedom != 1)
    return fail(ErrorKind::Infeasible, "/facets",
                "not all of it holds, so no roof can be glued on; use a smaller strip_mm or "
                "pitch_mm, or leave sloped out");
  BoxedCard out;
  out.card = sheet_of(*made);
  out.card.name = spec.name;
  out.placement = spec.placement;
  out.shift = {0.0, made->card.margin_mm - made->grid.v_from_mm, 0.0};
  for (const TentRun& run : made->tents) {
    auto tent = add_tent(*made, run, fmt::format("roof-{}", out.tents.size() + 1), out.card);
    if (!tent) return tl::unexpected(tent.error());
    out.tents.push_back(std::move(*tent));
  }
  for (const SheetPart& part : out.card.parts) out.panels += part.faces.size() - part.tabs.size();
  out.target = target->soup;
  move_to_card(out, out.target.corners);
  tell(progress, "measuring the distance from the shape");
  measure(out);
  const PartsWork work = parts_work(out.card);
  out.folds = work.folds, out.tabs = work.tabs, out.handwork = work.handwork;
  DesignReport report;
  report.handwork = out.handwork;
  warn_of_facets(spec, *target, *made, report);
  out.warnings = std::move(report.warnings);
  return out;
}

}  // namespace popcut
