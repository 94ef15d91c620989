// SPDX-License-Identifier: MIT
#include "daemon/cli/search/front_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"
#include "core/text/utf8.hpp"
#include "daemon/cli/search/front_picture.hpp"
#include "daemon/planning/search/found_front.hpp"

namespace popcut::cli {
namespace front_report_parts {
namespace {

using nlohmann::ordered_json;

ordered_json settings_json(const Candidate& candidate) {
  ordered_json out{{"style", std::string(style_name(candidate))},
                   {"cards", candidate.cards},
                   {"fill", candidate.fill}};
  if (candidate.style == DesignStyle::Facets) {
    out["strip_mm"] = candidate.strip_mm, out["pitch_mm"] = candidate.pitch_mm;
    out["line_cost"] = candidate.line_cost;
  } else {
    out["units_per_slice"] = candidate.units, out["slices"] = candidate.slices;
  }
  return out;
}

ordered_json card_json(const planning::FoundCard& card, std::size_t k) {
  const likeness::Figures& f = card.figures;
  ordered_json out{{"folder", front_folder(k)},
                   {"seconds", card.cost.seconds},
                   {"seconds_range", card.cost.seconds_range},
                   {"error", f.error()},
                   {"surface", f.surface()},
                   {"contour", f.contour()},
                   {"cover", f.cover},
                   {"excess", f.excess},
                   {"folds", card.folds},
                   {"cut_mm", card.cost.cut_mm},
                   {"fold_mm", card.cost.fold_mm},
                   {"sheet_mm", {card.made.u_mm, card.made.v_mm}},
                   {"degrees_of_freedom", card.made.parts.front().report.degrees_of_freedom},
                   {"settings", settings_json(card.candidate)}};
  auto warnings = ordered_json::array();
  for (const Warning& warning : card.made.parts.front().report.warnings)
    warnings.push_back(warning.message);
  out["warnings"] = std::move(warnings);
  return out;
}

ordered_json usual_json(const planning::UsualCard& usual) {
  ordered_json out{{"settings", settings_json(usual.candidate)},
                   {"as_the_file_stands", usual.candidate.way != 0},
                   {"made", usual.made}};
  if (usual.made)
    out["error"] = usual.error, out["seconds"] = usual.seconds;
  else
    out["why"] = usual.why;
  return out;
}

}  // namespace
}  // namespace front_report_parts

std::string front_json(const ModelSearchOptions& options, const SearchedModel& model) {
  using namespace front_report_parts;
  const planning::FoundCards& found = model.found;
  ordered_json out{{"model", model.name},
                   {"material", model.material.name},
                   {"machine", found.machine.name},
                   {"mat_mm", found.area_mm},
                   {"max_minutes", options.max_minutes},
                   {"style", options.style},
                   {"up", options.up},
                   {"seed", options.seed},
                   {"effort", options.effort},
                   {"tried",
                    {{"ways", found.counts.ways},
                     {"designed", found.counts.designed},
                     {"planned", found.counts.planned},
                     {"verified", found.counts.verified}}},
                   {"seen_along_diagonal", found.seen_share},
                   {"best", front_folder(found.front.size() - 1)}};
  auto cards = ordered_json::array(), usual = ordered_json::array();
  for (std::size_t k = 0; k < found.front.size(); ++k)
    cards.push_back(card_json(found.front[k], k));
  for (const planning::UsualCard& one : found.usual) usual.push_back(usual_json(one));
  out["cards"] = std::move(cards), out["usual"] = std::move(usual);
  out["notes"] = found.notes;
  return json_file(out);
}

std::string front_text(const ModelSearchOptions& options, const SearchedModel& model,
                       const std::string& folder) {
  using namespace front_report_parts;
  const planning::FoundCards& found = model.found;
  std::string out = fmt::format(
      "{}: {} cards, from {} that were designed and {} that were planned\n", shown_text(model.name),
      found.front.size(), found.counts.designed, found.counts.planned);
  for (std::size_t k = 0; k < found.front.size(); ++k) {
    const planning::FoundCard& card = found.front[k];
    out += fmt::format("  {}  {:5.1f} min  error {:.4f}  {} folds, {}\n", front_folder(k),
                       card.cost.seconds / 60.0, card.figures.error(), card.folds,
                       planning::settings_words(card.candidate));
  }
  for (const std::string& note : found.notes) out += fmt::format("  note     {}\n", note);
  out += fmt::format("  seen     {:.0f} % of the model's surface is seen along the diagonal\n",
                     100.0 * found.seen_share);
  if (options.up == "any")
    out +=
        "  upright  to have it upright, name the axis of the file that points up: --up y or --up "
        "z\n";
  out += fmt::format("  best     {}/{}: the one most like the model within {:g} minutes\n", folder,
                     front_folder(found.front.size() - 1), options.max_minutes);
  out += fmt::format("  look at  {}/front.svg\n", folder);
  return out;
}

}  // namespace popcut::cli
