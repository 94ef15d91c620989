// SPDX-License-Identifier: MIT
#include "daemon/planning/search/glued_card.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/hands/wobble.hpp"
#include "core/judge/boxes_likeness.hpp"
#include "core/judge/layers_likeness.hpp"
#include "core/plan/marks.hpp"
#include "core/search/coarse_mesh.hpp"
#include "core/text/json_text.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/plan_job.hpp"

namespace popcut::planning {
namespace glued_card_parts {
namespace {

constexpr const char* kGluedAsset = "model.stl";
constexpr int kMostGluedSizes = 5;  // that are tried until the card fits

std::string glued_spec(const GluedRequest& request, double scale_mm) {
  return json_file(
      nlohmann::ordered_json{{"popcut", 1},
                             {"name", request.model.name},
                             {"material", request.model.material},
                             {"style", parts_word(request.style)},
                             {"surface", {{"type", "mesh"}, {"file", request.model.file}}},
                             {"scale_mm", scale_mm},
                             {"rotate_deg", request.rotate_deg}});
}

/// How many times larger a card could be and still lie on the area, open.
double room_for(const Structure& card, const std::array<double, 2>& area_mm) {
  const double across = 2.0 * card.page_mm, along = card.length_mm;
  return std::max(std::min(area_mm[0] / across, area_mm[1] / along),
                  std::min(area_mm[1] / across, area_mm[0] / along));
}

/// What of a person's limits it breaks; empty: none.
std::string broken_limit(const FoundGlued& found, const GluedRequest& request) {
  const HandLimits& limits = request.hands;
  if (found.seconds > request.most_s)
    return fmt::format("cutting it takes {:.1f} minutes", found.seconds / 60.0);
  if (!limits.any_hold && found.wobble_mm() > hands::kFirm_mm)
    return fmt::format("its panels move by {:.2g} mm", found.wobble_mm());
  if (found.hands.folds > limits.most_folds)
    return fmt::format("it has {} folds", found.hands.folds);
  if (found.hands.shortest_mm < limits.shortest_mm)
    return fmt::format("its shortest fold is {:.3g} mm", found.hands.shortest_mm);
  if (!limits.label.empty() && found.hands.label != limits.label && found.hands.label != "easy")
    return "it is " + found.hands.label;
  return {};
}

/// A card that is not yet proved.
using DesignedCard = std::variant<LayeredCard, BoxedCard>;

Result<DesignedCard> designed_card(const DesignSpec& spec, const SurfaceAssets& assets) {
  const auto any = [](auto&& made) { return DesignedCard(std::forward<decltype(made)>(made)); };
  return spec.style == DesignStyle::Layers ? layered_card(spec, assets).map(any)
                                           : boxed_card(spec, assets).map(any);
}

/// Proves a card, and compares it printed.
Result<void> add_sound(DesignedCard made, const GluedRequest& request, FoundGlued& out) {
  if (auto* const layered = std::get_if<LayeredCard>(&made)) {
    auto sound = judge::sound_layers(std::move(*layered), "popcut", request.progress);
    if (!sound) return tl::unexpected(sound.error());
    out.layers = std::move(*sound);
    out.printed = judge::layers_likeness(out.layers->made, request.colours);
    return {};
  }
  auto sound = judge::sound_boxes(std::get<BoxedCard>(std::move(made)), "popcut", request.progress);
  if (!sound) return tl::unexpected(sound.error());
  out.boxes = std::move(*sound);
  out.printed = judge::boxes_likeness(out.boxes->made, request.colours);
  return {};
}

}  // namespace
}  // namespace glued_card_parts

std::string FoundGlued::made_of() const {
  const std::size_t count = layers ? layers->made.layers.size() : boxes->made.boxes.size();
  return layers ? fmt::format("{} layer{}", count, count == 1 ? "" : "s")
                : fmt::format("{} box{}", count, count == 1 ? "" : "es");
}

Result<FoundGlued> glued_card(const GluedRequest& request) {
  using namespace glued_card_parts;
  tell(request.progress,
       request.style == DesignStyle::Layers ? "making a card of layers" : "making a card of boxes");
  SurfaceAssets assets;
  assets.emplace(kGluedAsset, stl_bytes(request.mesh));
  const MeshBox box = box_of(request.mesh);
  double size = 0.0;
  for (std::size_t k = 0; k < 3; ++k) size = std::max(size, box.high[k] - box.low[k]);
  if (!(size > 0.0)) return fail(ErrorKind::Infeasible, "", "the model has no size");
  constexpr double kFirstShare = 0.4, kSlack = 0.99;
  const std::array<double, 2> area_mm =
      request.plan.marks ? room_within_marks_mm(request.area_mm) : request.area_mm;
  double scale_mm = kFirstShare * std::min(area_mm[0], area_mm[1]) / size;
  Result<FoundGlued> out = fail(ErrorKind::Infeasible, "", "it does not fit on the mat");
  for (int k = 0; k < kMostGluedSizes; ++k) {
    // As they are written, so that `design` makes the same.
    scale_mm = std::stod(fmt::format("{:.5g}", scale_mm));
    std::string text = glued_spec(request, scale_mm);
    auto spec = parse_design_spec(text);
    if (!spec) return tl::unexpected(spec.error());
    spec->surface = MeshSpec{kGluedAsset};
    auto designed = designed_card(*spec, assets);
    if (!designed) return tl::unexpected(designed.error());
    const double room = room_for(
        std::visit([](const auto& card) -> const Structure& { return card.card; }, *designed),
        area_mm);
    constexpr double kFull = 0.9;  // of the area: larger is not worth another try
    if (room < 1.0 || (room > 1.0 / kFull && k + 1 < kMostGluedSizes)) {
      scale_mm *= kSlack * room;
      continue;
    }
    FoundGlued made;
    made.spec = std::move(text);
    if (auto done = add_sound(std::move(*designed), request, made); !done)
      return tl::unexpected(done.error());
    out = std::move(made);
    break;
  }
  if (!out) return out;
  const auto job = make_plan_job(
      request.plan, request.tables,
      [&](const SvgReadOptions& how) {
        return drawing_from_text(out->layers ? out->layers->fold : out->boxes->fold,
                                 InputKind::Fold, how, 1, {});
      },
      "");
  if (!job) return tl::unexpected(job.error());
  for (const PlannedSheet& sheet : job->plan.sheets) {
    out->seconds += sheet.seconds;
    for (std::size_t k = 0; k < 2; ++k) out->seconds_range[k] += sheet.seconds_range[k];
    out->cut_mm += sheet.cut_mm, out->fold_mm += sheet.fold_line_mm;
  }
  out->places = job->plan.parts;
  out->hands = job->plan.handwork.value_or(out->layers ? out->layers->made.handwork
                                                       : out->boxes->made.handwork);
  if (const std::string limit = broken_limit(*out, request); !limit.empty())
    return fail(ErrorKind::Infeasible, "", limit);
  return out;
}

std::vector<FoundGlued> glued_beside(const SearchRequest& asked, FoundCards& found) {
  std::vector<FoundGlued> out;
  if (asked.plain || asked.cards != 1 || asked.styles.name != style_choices().front().name)
    return out;
  const auto spec = parse_design_spec(found.front[found.recommended].spec);
  if (!spec) return out;
  for (const DesignStyle style : {DesignStyle::Layers, DesignStyle::Boxes}) {
    auto made = glued_card({style, found.mesh, asked.colours, asked.model,
                            spec->placement.rotate_deg, found.area_mm, asked.plan, asked.tables,
                            asked.most_s, asked.hands, asked.progress});
    if (made)
      out.push_back(std::move(*made));
    else if (style == DesignStyle::Layers || made.error().place.empty())
      found.notes.push_back(fmt::format("popcut left out a card glued from {}: {}",
                                        parts_word(style), message(made.error())));
  }
  return out;
}

}  // namespace popcut::planning
