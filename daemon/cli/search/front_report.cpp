// SPDX-License-Identifier: MIT
#include "daemon/cli/search/front_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/compare/printed_json.hpp"
#include "core/text/json_text.hpp"
#include "core/text/utf8.hpp"
#include "daemon/cli/search/front_picture.hpp"
#include "daemon/client/command_words.hpp"
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
    out["line_cost"] = candidate.line_cost, out["hinge_cost_mm3"] = candidate.hinge_mm3;
  } else if (candidate.style == DesignStyle::Silhouette) {
    out["layers"] = candidate.layers;
  } else {
    out["units_per_slice"] = candidate.units, out["slices"] = candidate.slices;
  }
  return out;
}

ordered_json card_json(const planning::FoundCard& card, std::size_t k) {
  const likeness::Figures& f = card.figures;
  ordered_json out{
      {"folder", front_folder(card, k)},
      {"seconds", card.cost.seconds},
      {"seconds_range", card.cost.seconds_range},
      {"error", card.error()},
      {"surface", f.surface()},
      {"contour", f.contour()},
      {"cover", f.cover},
      {"excess", f.excess},
      {"folds", card.cost.hands.folds},
      {"shortest_fold_mm", card.cost.hands.shortest_mm},
      {"hand_seconds", card.cost.hands.time_s},
      {"label", card.cost.hands.label},
      {"wobble_mm", card.cost.wobble_mm},
      {"cut_mm", card.cost.cut_mm},
      {"fold_mm", card.cost.fold_mm},
      {"sheet_mm", {card.made.u_mm, card.made.book ? card.made.book->width_mm : card.made.v_mm}},
      {"degrees_of_freedom", card.made.parts.front().report.degrees_of_freedom},
      {"settings", settings_json(card.candidate)}};
  if (card.made.book)
    out["page_mm"] = card.made.book->page_mm, out["width_mm"] = card.made.book->width_mm;
  if (card.printed) out["printed"] = likeness::printed_json(*card.printed);
  auto warnings = ordered_json::array();
  for (const Design& part : card.made.parts)
    for (const Warning& warning : part.report.warnings) warnings.push_back(warning.message);
  out["warnings"] = std::move(warnings);
  return out;
}

/// A card of layers or of boxes, with the figures that cards of one sheet have.
ordered_json glued_json(const planning::FoundGlued& found) {
  return {{"folder", found.style()},
          {"seconds", found.seconds},
          {"error", found.printed.error()},
          {"pieces", found.card().parts.size()},
          {"folds", found.hands.folds},
          {"tabs", found.hands.tabs},
          {"shortest_fold_mm", found.hands.shortest_mm},
          {"hand_seconds", found.hands.time_s},
          {"label", found.hands.label},
          {"wobble_mm", found.wobble_mm()},
          {"printed", likeness::printed_json(found.printed)}};
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

/// The options of a plan that a search was made for, as one types them.
std::string plan_words(const ModelSearchOptions& options) {
  std::string out;
  if (!options.machine.empty()) out += " --machine " + client::quoted(options.machine);
  if (!options.mat.empty()) out += " --mat " + client::quoted(options.mat);
  return out;
}

}  // namespace
}  // namespace front_report_parts

std::string front_json(const ModelSearchOptions& options, const SearchedModel& model) {
  using namespace front_report_parts;
  const planning::FoundCards& found = model.found;
  ordered_json out{
      {"model", model.name},
      {"material", model.material.name},
      {"machine", found.machine.name},
      {"mat_mm", found.area_mm},
      {"max_minutes", options.max_minutes},
      {"style", options.style},
      {"cards", options.cards},
      {"up", model.up},
      {"front", options.front},
      {"marks", options.marks},
      {"seed", options.seed},
      {"effort", options.effort},
      {"tried",
       {{"ways", found.counts.ways},
        {"designed", found.counts.designed},
        {"planned", found.counts.planned},
        {"verified", found.counts.verified}}},
      {"seen_along_diagonal", found.seen_share},
      {"best", front_folder(found.front.back(), found.front.size() - 1)},
      {"recommended", front_folder(found.front[found.recommended], found.recommended)}};
  auto cards = ordered_json::array(), usual = ordered_json::array();
  for (std::size_t k = 0; k < found.front.size(); ++k)
    cards.push_back(card_json(found.front[k], k));
  for (const planning::UsualCard& one : found.usual) usual.push_back(usual_json(one));
  out["cards"] = std::move(cards), out["usual"] = std::move(usual);
  for (const planning::FoundGlued& one : model.glued) out[one.style()] = glued_json(one);
  out["notes"] = found.notes;
  return json_file(out);
}

std::string front_text(const ModelSearchOptions& options, const SearchedModel& model,
                       const std::string& folder) {
  using namespace front_report_parts;
  const planning::FoundCards& found = model.found;
  const bool is_book = found.front.back().made.book.has_value();
  std::string out =
      fmt::format("{}: {} {}{}{}, from {} that were designed and {} that were planned\n",
                  shown_text(model.name), found.front.size(), is_book ? "book" : "card",
                  found.front.size() == 1 ? "" : "s",
                  is_book ? fmt::format(" of {} cards", options.cards) : std::string(),
                  found.counts.designed, found.counts.planned);
  for (std::size_t k = 0; k < found.front.size(); ++k) {
    const planning::FoundCard& card = found.front[k];
    out += fmt::format(
        "  {}  {:6} {:3} folds, the shortest {:.3g} mm; {:.0f} min to fold, {:.1f} to cut; {}error "
        "{:.4f}; {}\n",
        front_folder(card, k), card.cost.hands.label, card.cost.hands.folds,
        card.cost.hands.shortest_mm, std::max(1.0, card.cost.hands.time_s / 60.0),
        card.cost.seconds / 60.0,
        card.printed ? fmt::format("looks {}; ", likeness::name_of(likeness::looks(*card.printed)))
                     : std::string(),
        card.error(), planning::settings_words(card.candidate));
  }
  for (const planning::FoundGlued& one : model.glued) {
    out += fmt::format(
        "  {:<7}  {} folds and {} tabs ({}), about {:.0f} min by hand, {:.1f} min to cut; looks "
        "{}; "
        "error {:.4f}; {}, opens flat\n",
        one.style(), one.hands.folds, one.hands.tabs, one.hands.label,
        std::max(1.0, one.hands.time_s / 60.0), one.seconds / 60.0,
        likeness::name_of(likeness::looks(one.printed)), one.printed.error(), one.made_of());
  }
  for (const std::string& note : found.notes) out += fmt::format("  note     {}\n", note);
  const double seen = 100.0 * found.seen_share;
  out += is_book ? fmt::format("  seen     {} cards show {:.0f} % of the model's surface\n",
                               options.cards, seen)
                 : fmt::format(
                       "  seen     a card shows one side of a model: here {:.0f} % of its "
                       "surface\n",
                       seen);
  const planning::FoundCard& recommended = found.front[found.recommended];
  if (!is_book) {
    const Stand stand = stand_of(recommended);
    const bool guessed = options.up == kUsualUp || options.up == "any" || options.front == "any";
    out += fmt::format("  stands   {} points up{}, {} toward you{}\n", stand.up,
                       options.up == kUsualUp && model.up != "any" ? ", as in most such files" : "",
                       stand.front,
                       guessed ? fmt::format("; {}/sides.svg shows it from six sides: choose one "
                                             "with --up and --front",
                                             folder)
                               : std::string());
  }
  const double scale_mm = nlohmann::json::parse(recommended.spec).value("scale_mm", 1.0);
  constexpr double kOtherUnit = 10.0;  // the file is hardly in millimetres
  if (scale_mm > kOtherUnit || scale_mm < 1.0 / kOtherUnit)
    out += fmt::format(
        "  sized    one unit of the file is {} mm on the card, to fit the paper\n",
        scale_mm > 1.0 ? fmt::format("{:.0f}", scale_mm) : fmt::format("{:.2g}", scale_mm));
  const std::string easiest = front_folder(recommended, found.recommended);
  out += fmt::format("  closest  {}/{} looks most like the model\n", folder,
                     front_folder(found.front.back(), found.front.size() - 1));
  out += fmt::format("  make     {}/{}: easy to fold, and looks about as good as any\n", folder,
                     easiest);
  out += fmt::format("  look at  {}/front.svg\n", folder);
  const std::string best =
      client::quoted(fmt::format("{}/{}/spec.json", folder, easiest)) + plan_words(options);
  out += fmt::format(
      "  next     popcut cut {0} --direct    # cuts it; simulated unless you add --device\n"
      "           popcut print {0} -o printed    # or first prints the model's colours\n{1}",
      best,
      options.marks ? ""
                    : "           to print and cut on one sheet, search again with --marks: they "
                      "need room\n");
  return out;
}

}  // namespace popcut::cli
