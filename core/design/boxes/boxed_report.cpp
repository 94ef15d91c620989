// SPDX-License-Identifier: MIT
#include "core/design/boxes/boxed_report.hpp"

#include <cmath>

#include "core/compare/printed_json.hpp"
#include "core/geometry/angle.hpp"
#include "core/hands/handwork_json.hpp"
#include "core/text/json_text.hpp"
#include "core/text/warnings_json.hpp"

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

Json distances_json(const DistanceFigures& far) {
  return {{"mean", far.mean_mm}, {"rms", far.rms_mm}, {"p95", far.p95_mm}, {"max", far.max_mm}};
}

Json box_json(const CardBox& box) {
  const Block& block = box.block;
  return {{"name", box.name},
          {"roof", roof_word(block)},
          {"panels", box.panels},
          {"from_mm", block.from_mm},
          {"to_mm", block.to_mm},
          {"width_mm", 2.0 * block.half_mm},
          {"walls_mm", block.height_mm},
          {"height_mm", block.top_mm()},
          {"eaves_mm", block.eaves_mm},
          {"verge_mm", block.verge_mm},
          {"bend_mm", box.bend_mm},
          {"inner_wall_mm", box.inner_mm}};
}

Json tent_json(const CardTent& tent) {
  const TentSection& section = tent.section;
  return {{"name", tent.name},
          {"from_mm", tent.along_mm[0]},
          {"to_mm", tent.along_mm[1]},
          {"slope_deg", degrees(section.slope_rad)},
          {"eave_mm", section.foot_mm},
          {"roof_mm", section.roof_mm},
          {"strut_at_mm", section.strut_at_mm},
          {"strut_foot_mm", section.strut_foot_mm},
          {"strut_mm", section.strut_mm}};
}

}  // namespace

const char* roof_word(const Block& block) {
  if (block.is_tent()) return "tent";
  return block.roof == BlockRoof::Flat     ? "flat"
         : block.roof == BlockRoof::Gabled ? "gabled"
                                           : "pyramid";
}

std::string boxed_report_json(const BoxedCard& made, const likeness::PrintedFigures& printed,
                              double seconds) {
  const Structure& card = made.card;
  const FitFigures& fit = made.fit;
  Json shares;
  for (std::size_t w = 0; w < FitFigures::kWithin.size(); ++w)
    shares[std::to_string(static_cast<int>(std::floor(100.0 * FitFigures::kWithin[w] + 0.5))) +
           "_percent"] = fit.share_within[w];
  return json_file(Json{
      {"name", card.name},
      {"style", made.is_of_facets() ? "facets" : "boxes"},
      {"opens_deg", card.opens_deg},
      {"pieces", card.parts.size()},
      {"panels", made.panels},
      {"folds", made.folds},
      {"tabs", made.tabs},
      {"page_mm", {card.page_mm, card.length_mm}},
      {"turned_deg", degrees(made.turn_rad)},
      {made.is_of_facets() ? "tents" : "boxes",
       made.is_of_facets() ? json_list(made.tents, tent_json) : json_list(made.boxes, box_json)},
      {"error", made.error()},
      {"fit",
       {{"structure_to_target_mm", distances_json(fit.to_target)},
        {"target_to_structure_mm", distances_json(fit.to_structure)},
        {"two_sided_rms_mm", fit.two_sided_rms_mm()},
        {"size_mm", fit.size_mm},
        {"share_within", std::move(shares)},
        {"area_mm2", {{"structure", fit.structure_mm2}, {"target", fit.target_mm2}}},
        {"samples", {{"structure", fit.to_target.samples}, {"target", fit.to_structure.samples}}}}},
      {"seen",
       {{"error", made.seen.error()},
        {"surface", made.seen.surface()},
        {"contour", made.seen.contour()},
        {"cover", made.seen.cover}}},
      {"wobble_mm", made.wobble_mm ? Json(*made.wobble_mm) : Json()},
      {"printed", likeness::printed_json(printed)},
      {"handwork", hands::handwork_json(made.handwork)},
      {"warnings", warnings_json(made.warnings)},
      {"seconds", seconds}});
}

}  // namespace popcut
