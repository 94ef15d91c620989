// SPDX-License-Identifier: MIT
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/hands/handwork_json.hpp"
#include "core/judge/glue_guide.hpp"
#include "core/text/json_text.hpp"

namespace popcut::judge {
namespace glue_json_parts {
namespace {

using Json = nlohmann::ordered_json;

Json place_json(double u_mm, double v_mm) {
  const auto micrometres = [](double mm) { return std::round(1e3 * mm) / 1e3 + 0.0; };
  return {micrometres(u_mm), micrometres(v_mm)};
}

Json outline_json(const std::vector<Vec2>& outline) {
  Json json = Json::array();
  for (const Vec2& p : outline) json.push_back(place_json(p.x(), p.y()));
  return json;
}

Json part_json(const GluePart& part) {
  Json folds = Json::array();
  for (const hands::GuideFold& fold : part.folds.folds)
    folds.push_back({{"from", place_json(part.sheet.u(fold.from), fold.from.v)},
                     {"to", place_json(part.sheet.u(fold.to), fold.to.v)},
                     {"sense", hands::sense_of(fold)}});
  return {{"name", part.name}, {"waste", part.folds.waste.size()}, {"folds", std::move(folds)}};
}

}  // namespace
}  // namespace glue_json_parts

std::string glue_guide_json(const GlueGuide& guide) {
  using namespace glue_json_parts;
  Json parts = Json::array(), tabs = Json::array(), steps = Json::array();
  for (const GluePart& part : guide.parts) parts.push_back(part_json(part));
  for (const GlueTab& tab : guide.tabs)
    tabs.push_back({{"letter", tab.letter},
                    {"part", guide.parts[tab.part].name},
                    {"on", guide.parts[tab.on_part].name},
                    {"outline_mm", outline_json(tab.outline)},
                    {"place_mm", outline_json(tab.place)}});
  for (const GlueStep& step : guide.steps) {
    Json letters = Json::array(), with = Json::array(), onto = Json::array();
    for (const std::size_t t : step.tabs) letters.push_back(guide.tabs[t].letter);
    for (const std::size_t p : step.with) with.push_back(guide.parts[p].name);
    for (const std::size_t k : step.slots) onto.push_back(guide.parts[guide.slots[k].onto].name);
    steps.push_back({{"kind", name_of(step.kind)},
                     {"part", guide.parts[step.part].name},
                     {"with", std::move(with)},
                     {"words", step.words},
                     {"folds", step.folds},
                     {"tabs", std::move(letters)},
                     {"onto", std::move(onto)}});
  }
  return json_file(Json{{"popcut", 1},
                        {"name", guide.name},
                        {"handwork", hands::handwork_json(handwork(guide))},
                        {"parts", std::move(parts)},
                        {"tabs", std::move(tabs)},
                        {"steps", std::move(steps)}});
}

}  // namespace popcut::judge
