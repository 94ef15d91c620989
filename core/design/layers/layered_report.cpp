// SPDX-License-Identifier: MIT
#include "core/design/layers/layered_report.hpp"

#include "core/compare/printed_json.hpp"
#include "core/hands/handwork_json.hpp"
#include "core/text/json_text.hpp"
#include "core/text/warnings_json.hpp"

namespace popcut {

std::string layered_report_json(const LayeredCard& made, const likeness::PrintedFigures& printed,
                                double seconds) {
  using Json = nlohmann::ordered_json;
  const Structure& card = made.card;
  return json_file(Json{{"name", card.name},
                        {"style", "layers"},
                        {"opens_deg", card.opens_deg},
                        {"pieces", card.parts.size()},
                        {"folds", made.folds},
                        {"tabs", made.tabs},
                        {"page_mm", {card.page_mm, card.length_mm}},
                        {"front", made.looks_along_spine ? "beginning" : "end"},
                        {"layers", json_list(made.layers,
                                             [](const CardLayer& layer) {
                                               return Json{
                                                   {"depth_mm", layer.depth_mm},
                                                   {"at_mm", layer.at_mm},
                                                   {"height_mm", layer.height_mm},
                                                   {"width_mm", layer.width_mm},
                                                   {"bridges", layer.changes.bridges},
                                                   {"holes_filled", layer.changes.filled},
                                                   {"parts_dropped", layer.changes.dropped}};
                                             })},
                        {"printed", likeness::printed_json(printed)},
                        {"handwork", hands::handwork_json(made.handwork)},
                        {"warnings", warnings_json(made.warnings)},
                        {"seconds", seconds}});
}

}  // namespace popcut
