// SPDX-License-Identifier: MIT
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/hands/fold_guide.hpp"
#include "core/text/json_text.hpp"

namespace popcut::hands {
namespace {

using GuideJson = nlohmann::ordered_json;

double micrometres(double mm) { return std::round(1e3 * mm) / 1e3 + 0.0; }

GuideJson card_json(const FoldGuide& guide, const Pattern& pattern) {
  GuideJson folds = GuideJson::array(), steps = GuideJson::array();
  for (const GuideFold& fold : guide.folds)
    folds.push_back({{"from", {micrometres(pattern.u(fold.from)), micrometres(fold.from.v)}},
                     {"to", {micrometres(pattern.u(fold.to)), micrometres(fold.to.v)}},
                     {"sense", sense_of(fold)}});
  for (const GuideStep& step : guide.steps) {
    GuideJson one{{"kind", name_of(step.kind)},
                  {"words", step.words},
                  {"folds", step.folds},
                  {"panels", step.panels}};
    if (guide.stands && !step.panels.empty()) one["look_from"] = name_of(step.look_from);
    if (step.kind == StepKind::Push)
      one["push_from"] = step.push_from == PushFrom::Behind ? "behind" : "front";
    steps.push_back(std::move(one));
  }
  return {{"name", pattern.name},
          {"waste", guide.waste.size()},
          {"folds", std::move(folds)},
          {"steps", std::move(steps)}};
}

}  // namespace

std::string fold_guide_json(std::span<const FoldGuide> guides, std::span<const Pattern> patterns) {
  GuideJson cards = GuideJson::array();
  for (std::size_t k = 0; k < guides.size(); ++k)
    cards.push_back(card_json(guides[k], patterns[k]));
  return json_file(GuideJson{{"popcut", 1}, {"cards", std::move(cards)}});
}

}  // namespace popcut::hands
