// SPDX-License-Identifier: MIT
#include "daemon/planning/search/layers_card.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/hands/wobble.hpp"
#include "core/judge/layers_likeness.hpp"
#include "core/plan/marks.hpp"
#include "core/search/coarse_mesh.hpp"
#include "core/text/json_text.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/plan_job.hpp"

namespace popcut::planning {
namespace layers_card_parts {
namespace {

constexpr const char* kLayersAsset = "model.stl";
constexpr int kMostLayersSizes = 5;  // that are tried until the card fits

std::string layers_spec(const LayersRequest& request, double scale_mm) {
  return json_file(
      nlohmann::ordered_json{{"popcut", 1},
                             {"name", request.model.name},
                             {"material", request.model.material},
                             {"style", "layers"},
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
std::string broken_limit(const FoundLayers& found, const LayersRequest& request) {
  const HandLimits& limits = request.hands;
  if (found.seconds > request.most_s)
    return fmt::format("cutting it takes {:.1f} minutes", found.seconds / 60.0);
  if (!limits.any_hold && found.sound.report.wobble_mm.value_or(0.0) > hands::kFirm_mm)
    return fmt::format("its panels move by {:.2g} mm", *found.sound.report.wobble_mm);
  if (found.hands.folds > limits.most_folds)
    return fmt::format("it has {} folds", found.hands.folds);
  if (found.hands.shortest_mm < limits.shortest_mm)
    return fmt::format("its shortest fold is {:.3g} mm", found.hands.shortest_mm);
  if (!limits.label.empty() && found.hands.label != limits.label && found.hands.label != "easy")
    return "it is " + found.hands.label;
  return {};
}

}  // namespace
}  // namespace layers_card_parts

Result<FoundLayers> layers_card(const LayersRequest& request) {
  using namespace layers_card_parts;
  tell(request.progress, "making a card of layers");
  SurfaceAssets assets;
  assets.emplace(kLayersAsset, stl_bytes(request.mesh));
  const MeshBox box = box_of(request.mesh);
  double size = 0.0;
  for (std::size_t k = 0; k < 3; ++k) size = std::max(size, box.high[k] - box.low[k]);
  if (!(size > 0.0)) return fail(ErrorKind::Infeasible, "", "the model has no size");
  constexpr double kFirstShare = 0.4, kSlack = 0.99;
  const std::array<double, 2> area_mm =
      request.plan.marks ? room_within_marks_mm(request.area_mm) : request.area_mm;
  double scale_mm = kFirstShare * std::min(area_mm[0], area_mm[1]) / size;
  Result<FoundLayers> out = fail(ErrorKind::Infeasible, "", "it does not fit on the mat");
  for (int k = 0; k < kMostLayersSizes; ++k) {
    // As they are written, so that `design` makes the same.
    scale_mm = std::stod(fmt::format("{:.5g}", scale_mm));
    std::string text = layers_spec(request, scale_mm);
    auto spec = parse_design_spec(text);
    if (!spec) return tl::unexpected(spec.error());
    spec->surface = MeshSpec{kLayersAsset};
    const auto sized = layered_card(*spec, assets);
    if (!sized) return tl::unexpected(sized.error());
    const double room = room_for(sized->card, area_mm);
    constexpr double kFull = 0.9;  // of the area: larger is not worth another try
    if (room < 1.0 || (room > 1.0 / kFull && k + 1 < kMostLayersSizes)) {
      scale_mm *= kSlack * room;
      continue;
    }
    auto sound = judge::sound_layers(*spec, assets, "popcut", request.progress);
    if (!sound) return tl::unexpected(sound.error());
    out.emplace();
    out->spec = std::move(text), out->sound = std::move(*sound);
    break;
  }
  if (!out) return out;
  const auto job = make_plan_job(
      request.plan, request.tables,
      [&](const SvgReadOptions& how) {
        return drawing_from_text(out->sound.fold, InputKind::Fold, how, 1, {});
      },
      "");
  if (!job) return tl::unexpected(job.error());
  for (const PlannedSheet& sheet : job->plan.sheets) {
    out->seconds += sheet.seconds;
    for (std::size_t k = 0; k < 2; ++k) out->seconds_range[k] += sheet.seconds_range[k];
    out->cut_mm += sheet.cut_mm, out->fold_mm += sheet.fold_line_mm;
  }
  out->places = job->plan.parts;
  out->hands = job->plan.handwork.value_or(out->sound.made.handwork);
  out->printed = judge::layers_likeness(out->sound.made, request.colours);
  if (const std::string limit = broken_limit(*out, request); !limit.empty())
    return fail(ErrorKind::Infeasible, "", limit);
  return out;
}

std::optional<FoundLayers> layers_beside(const SearchRequest& asked, FoundCards& found) {
  if (asked.plain || asked.cards != 1 || asked.styles.name != style_choices().front().name)
    return std::nullopt;
  const auto spec = parse_design_spec(found.front[found.recommended].spec);
  if (!spec) return std::nullopt;
  auto layers = layers_card({found.mesh, asked.colours, asked.model, spec->placement.rotate_deg,
                             found.area_mm, asked.plan, asked.tables, asked.most_s, asked.hands,
                             asked.progress});
  if (layers) return std::move(*layers);
  found.notes.push_back("popcut left out a card glued from layers: " + message(layers.error()));
  return std::nullopt;
}

}  // namespace popcut::planning
