// SPDX-License-Identifier: MIT
#include "daemon/planning/search/search_words.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/search/candidate.hpp"
#include "core/search/choices.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"
#include "core/text/utf8.hpp"
#include "daemon/model/found_card_json.hpp"
#include "daemon/model/warnings.hpp"

namespace popcut::planning {
namespace search_words_parts {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostFound = 100, kMostNotes = 50, kMostSpec = 64u << 10;
constexpr std::size_t kMostNote = 1000, kMostWords = 200, kMostCardWarnings = 50;
constexpr std::size_t kMostNameBytes = 60;
constexpr double kMostFigure = 1e9;
constexpr int kMostCount = 1 << 30, kFrontDepth = 6;

ordered_json card_json(const daemon::FoundCardRecord& card) {
  ordered_json out = daemon::figures_json(card);
  out["warnings"] = daemon::warnings_json(card.warnings);
  out["spec"] = card.spec;
  return out;
}

std::array<double, 2> pair_of(FieldReader& fields, const char* key) {
  const std::vector<double> pair = fields.numbers(key, 2);
  for (const double one : pair)
    if (!(one >= 0.0 && one <= kMostFigure))
      fields.refuse(key, ErrorKind::OutOfRange, "is too large");
  return {pair[0], pair[1]};
}

TextRule short_line(std::size_t most) { return {0, most, TextRule::Controls::None}; }

daemon::FoundCardRecord read_card(FieldReader& fields) {
  const auto figure = [&](const char* key) { return fields.number(key, {}, 0.0, kMostFigure); };
  daemon::FoundCardRecord card;
  card.style = fields.text("style", {}, short_line(kMostWords));
  card.settings = fields.text("settings", {}, short_line(kMostWords));
  card.error = figure("error"), card.surface = figure("surface"), card.contour = figure("contour");
  card.cover = figure("cover"), card.excess = figure("excess");
  card.seconds = figure("seconds"), card.seconds_range = pair_of(fields, "seconds_range");
  card.cut_mm = figure("cut_mm"), card.fold_mm = figure("fold_mm");
  card.sheet_mm = pair_of(fields, "sheet_mm");
  if (fields.has("page_mm")) card.page_mm = figure("page_mm");
  card.folds = fields.integer("folds", {}, 0, kMostCount);
  // Searches of older versions do not have these.
  if (fields.has("label")) {
    card.shortest_fold_mm = figure("shortest_fold_mm"), card.hand_seconds = figure("hand_seconds");
    card.label = fields.text("label", {}, short_line(kMostWords));
    card.wobble_mm = figure("wobble_mm");
  }
  if (fields.has("tabs")) card.tabs = fields.integer("tabs", {}, 0, kMostCount);
  if (fields.has("looks")) card.looks = fields.text("looks", {}, short_line(kMostWords));
  card.warnings = daemon::warnings_from_json(fields.text("warnings", {}));
  daemon::shorten(card.warnings, kMostCardWarnings, kMostNote);
  card.spec = fields.text("spec", {}, {0, kMostSpec, TextRule::Controls::Any});
  const auto spec = parse_json(card.spec, kFrontDepth);
  if (!spec || !spec->is_object())
    fields.refuse("spec", ErrorKind::Malformed, "is not the text of a design");
  return card;
}

}  // namespace
}  // namespace search_words_parts

std::string thumbnail_file(int card) { return fmt::format("card-{:02}.png", card); }

std::string lattice_file(int card) { return fmt::format("card-{:02}.lattice", card); }

std::string design_name(const std::string& file) {
  std::string name = file.substr(file.find_last_of("/\\") + 1);
  if (const std::size_t dot = name.rfind('.'); dot != std::string::npos && dot > 0)
    name.resize(dot);
  const bool is_plain =
      !name.empty() && name.size() <= search_words_parts::kMostNameBytes && !has_controls(name);
  return is_plain ? name : "model";
}

std::string search_words(const daemon::CardSearchRequest& request) {
  nlohmann::ordered_json words{{"model", request.model},  {"name", request.name},
                               {"mat", request.mat},      {"style", request.style},
                               {"up", request.up},        {"front", request.front},
                               {"cards", request.cards},  {"marks", request.marks},
                               {"seed", request.seed},    {"max_minutes", request.max_minutes},
                               {"effort", request.effort}};
  // What nobody asks for is left out, so that a search of an older version is found again.
  if (request.max_folds > 0) words["max_folds"] = request.max_folds;
  if (request.min_fold_mm > 0.0) words["min_fold_mm"] = request.min_fold_mm;
  if (request.label != label_words().front()) words["label"] = request.label;
  if (request.plain) words["plain"] = true;
  return json_line(words);
}

Result<daemon::CardSearchRequest> read_search_words(std::string_view words) {
  using namespace search_words_parts;
  const auto json = parse_json(words, 2);
  if (!json) return tl::unexpected(json.error());
  std::vector<std::string> styles;
  for (const StyleChoice& style : style_choices()) styles.emplace_back(style.name);
  FieldReader fields(*json, "");
  daemon::CardSearchRequest request;
  request.name = fields.text("name", {});
  request.model = fields.text("model", {});
  request.mat = fields.text("mat", {});
  request.style = styles[fields.word("style", {}, styles)];
  request.up = up_words()[fields.word("up", {}, up_words())];
  request.cards = fields.integer("cards", {}, 1, kMostCards);
  request.front = up_words()[fields.word("front", {}, up_words())];
  request.marks = fields.boolean("marks", false);
  request.max_minutes =
      fields.number("max_minutes", {}, daemon::kLeastMinutes, daemon::kMostMinutes);
  request.effort = fields.number("effort", {}, daemon::kLeastEffort, daemon::kMostEffort);
  request.seed = fields.optional_integer("seed", 0, daemon::kMostSeed).value_or(1);
  request.max_folds =
      static_cast<int>(fields.optional_integer("max_folds", 0, daemon::kMostFolds).value_or(0));
  request.min_fold_mm = fields.number("min_fold_mm", 0.0, 0.0, daemon::kMostFold_mm);
  request.label = label_words()[fields.word("label", 0, label_words())];
  request.plain = fields.boolean("plain", false);
  if (const auto whole = fields.finish(); !whole) return tl::unexpected(whole.error());
  return request;
}

std::string front_text(const daemon::SearchFront& front) {
  using namespace search_words_parts;
  auto cards = ordered_json::array();
  for (const daemon::FoundCardRecord& card : front.cards) cards.push_back(card_json(card));
  ordered_json out{{"cards", std::move(cards)},      {"designed", front.designed},
                   {"planned", front.planned},       {"verified", front.verified},
                   {"seen_share", front.seen_share}, {"mat_mm", front.mat_mm},
                   {"notes", front.notes},           {"recommended", front.recommended}};
  if (!front.better_front.empty()) out["better_front"] = front.better_front;
  return json_line(out);
}

Result<daemon::SearchFront> read_front(std::string_view text) {
  using namespace search_words_parts;
  const auto json = parse_json(text, kFrontDepth);
  if (!json) return tl::unexpected(json.error());
  FieldReader fields(*json, "");
  daemon::SearchFront front;
  fields.objects(
      "cards", [&](FieldReader& card) { front.cards.push_back(read_card(card)); }, kMostFound);
  front.designed = fields.integer("designed", {}, 0, kMostCount);
  front.planned = fields.integer("planned", {}, 0, kMostCount);
  front.verified = fields.integer("verified", {}, 0, kMostCount);
  front.seen_share = fields.number("seen_share", {}, 0.0, 1.0 + 1e-6);
  front.mat_mm = pair_of(fields, "mat_mm");
  fields.need("notes", "must be a list of texts");
  front.notes = fields.optional_texts("notes", kMostNotes, short_line(kMostNote))
                    .value_or(std::vector<std::string>());
  const auto found = static_cast<std::int64_t>(front.cards.size());
  front.recommended =
      static_cast<int>(fields.optional_integer("recommended", 0, found).value_or(0));
  if (const auto better = fields.optional_word("better_front", up_words()))
    front.better_front = up_words()[*better];
  if (const auto whole = fields.finish(); !whole) return tl::unexpected(whole.error());
  if (front.cards.empty()) return fail(ErrorKind::Malformed, "/cards", "is empty");
  return front;
}

}  // namespace popcut::planning
