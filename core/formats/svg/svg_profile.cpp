// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_profile.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_colour.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"
#include "core/machines/table.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/near_names.hpp"
#include "core/text/utf8.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostRules = 1000;

/// Lower case, with spaces and underscores as hyphens.
std::string plain_label(std::string_view label) {
  std::string out = lower(trimmed(label));
  for (char& c : out)
    if (c == ' ' || c == '_' || c == '\t') c = '-';
  return out;
}

const std::vector<std::string>& use_words() {
  static const std::vector<std::string> words{"draw", "score",   "fold-mountain", "fold-valley",
                                              "cut",  "outline", "ignore"};
  return words;
}

StrokeUse use_at(std::size_t index) {
  if (index + 1 == use_words().size()) return std::nullopt;
  return static_cast<Operation>(index);
}

StrokeUse read_use(FieldReader& fields, const std::string& key) {
  return use_at(fields.word(key, use_words().size() - 1, use_words()));
}

std::uint32_t read_colour(FieldReader& fields, const nlohmann::json& value,
                          const std::string& place) {
  const auto paint =
      value.is_string() ? parse_svg_paint(value.get_ref<const std::string&>()) : std::nullopt;
  if (paint && paint->kind == SvgPaint::Kind::Colour) return paint->rgb;
  fields.refuse(place, ErrorKind::Malformed, "is not a colour; write one such as #ff0000 or red");
  return 0;
}

StrokeRule read_rule(FieldReader& fields) {
  StrokeRule rule;
  if (const nlohmann::json* colour = fields.value("colour")) {
    if (colour->is_array())
      for (std::size_t i = 0; i < colour->size(); ++i)
        rule.colours.push_back(read_colour(fields, (*colour)[i], fmt::format("colour/{}", i)));
    else
      rule.colours.push_back(read_colour(fields, *colour, "colour"));
  }
  const std::vector<std::string> lines{"solid", "dashed", "dash-dot", "any"};
  const std::size_t line = fields.word("line", 3, lines);
  if (line < 3) rule.line = static_cast<LineStyle>(line);
  rule.css_class = fields.text("class", "");
  if (!fields.has("use"))
    fields.refuse(
        "use", ErrorKind::Malformed,
        "is missing; use cut, outline, score, fold-mountain, fold-valley, draw or ignore");
  rule.use = read_use(fields, "use");
  return rule;
}

LayerMeaning read_meaning(FieldReader& fields, const std::string& key) {
  constexpr std::array kMeanings{LayerMeaning::Draw,         LayerMeaning::Score,
                                 LayerMeaning::FoldMountain, LayerMeaning::FoldValley,
                                 LayerMeaning::Cut,          LayerMeaning::Outline,
                                 LayerMeaning::Ignore};  // in the order of the words
  return kMeanings.at(fields.word(key, kMeanings.size() - 1, use_words()));
}

void read_labels(FieldReader& fields, StrokeProfile& profile) {
  const nlohmann::json* labels = fields.value("labels");
  if (labels == nullptr) return;
  if (!labels->is_object())
    return fields.refuse("labels", ErrorKind::Malformed,
                         "must be an object of labels and uses such as {\"kiss cut\": \"score\"}");
  FieldReader inner = fields.nested(*labels, "labels");
  for (const auto& label : labels->items())
    profile.labels[layer_key(label.key())] = read_meaning(inner, label.key());
}

Result<StrokeProfile> read_profile(const TableRow& row) {
  StrokeProfile profile;
  FieldReader fields(row.row, row.pointer);
  profile.name = fields.text("name", {});
  profile.title = fields.text("title", "");
  fields.value("source");
  profile.names = fields.boolean("names", true);
  profile.nearest = fields.word("colours", 0, {"same", "nearest"}) == 1;
  read_labels(fields, profile);
  fields.optional_objects(
      "rules", [&](FieldReader& rule) { profile.rules.push_back(read_rule(rule)); }, kMostRules);
  profile.otherwise = use_at(fields.word("otherwise", 4, use_words()));
  profile.fills = read_use(fields, "fills");
  profile.asks = fields.boolean("asks", false);
  if (const auto whole = fields.finish(); !whole)
    return tl::unexpected(in_table(row, whole.error()));
  return profile;
}

int distance_squared(std::uint32_t a, std::uint32_t b) {
  int sum = 0;
  for (const unsigned shift : {0u, 8u, 16u}) {
    const int d = static_cast<int>(a >> shift & 255) - static_cast<int>(b >> shift & 255);
    sum += d * d;
  }
  return sum;
}

std::uint32_t nearest_colour(const StrokeProfile& profile, std::uint32_t rgb) {
  std::uint32_t best = rgb;
  int least = 1 << 30;
  for (const StrokeRule& rule : profile.rules)
    for (const std::uint32_t colour : rule.colours)
      if (const int d = distance_squared(colour, rgb); d < least) {
        least = d;
        best = colour;
      }
  return best;
}

}  // namespace

Result<std::vector<StrokeProfile>> all_stroke_profiles(
    const std::vector<std::string>& user_tables) {
  static const auto built_in = table_values("svg_profiles", kSvgProfilesJson, {}, read_profile);
  return user_tables.empty()
             ? built_in
             : table_values("svg_profiles", kSvgProfilesJson, user_tables, read_profile);
}

Result<StrokeProfile> find_stroke_profile(std::string_view name,
                                          const std::vector<std::string>& user_tables) {
  return value_named(name, all_stroke_profiles(user_tables), "profile", ErrorKind::Usage,
                     "/options/svg-profile");
}

std::string illustrator_name(std::string_view id) {
  if (id.size() > 200) return {};
  const auto end_of = [&](std::size_t at, std::string_view digits) {
    return std::min(id.find_first_not_of(digits, at), id.size());
  };
  std::string name;
  for (std::size_t at = 0; at < id.size();) {
    if (id[at] != '_') {
      name += id[at++];
      continue;
    }
    if (id.substr(at, 2) == "_x") {
      unsigned code = 0;
      const std::size_t end = end_of(at + 2, "0123456789abcdefABCDEF");
      if (end < id.size() && id[end] == '_' && end > at + 2 && end <= at + 6 &&
          std::from_chars(id.data() + at + 2, id.data() + end, code, 16).ec == std::errc{}) {
        append_utf8(name, code >= 0x20 ? code : '?');
        at = end + 1;
        continue;
      }
    }
    const std::size_t end = end_of(at + 1, "0123456789");
    if (!name.empty() && end > at + 1 && end + 1 == id.size() && id[end] == '_') break;
    name += ' ';
    ++at;
  }
  return name;
}

LayerMeaning meaning_of_label(const StrokeProfile& profile, std::string_view label) {
  return profile.names ? meaning_of_name(profile.labels, label) : LayerMeaning::Wordless;
}

StrokeUse use_of(LayerMeaning meaning) {
  if (meaning == LayerMeaning::Ignore) return std::nullopt;
  return operation_of(meaning);
}

std::optional<StrokeUse> use_of_assignment(std::string_view word) {
  if (word.size() > 40) return std::nullopt;
  const std::string plain = plain_label(word);
  constexpr std::array<std::pair<std::string_view, std::size_t>, 14> kWords{{{"m", 2},
                                                                             {"mountain", 2},
                                                                             {"v", 3},
                                                                             {"valley", 3},
                                                                             {"c", 4},
                                                                             {"slit", 4},
                                                                             {"b", 5},
                                                                             {"border", 5},
                                                                             {"boundary", 5},
                                                                             {"mark", 0},
                                                                             {"label", 0},
                                                                             {"f", 6},
                                                                             {"u", 6},
                                                                             {"j", 6}}};
  for (const auto& [name, use] : kWords)
    if (plain == name) return use_at(use);
  for (std::size_t i = 0; i < use_words().size(); ++i)
    if (plain == use_words()[i]) return use_at(i);
  const LayerMeaning meaning = layer_meaning(word);
  return is_known(meaning) ? std::optional<StrokeUse>(use_of(meaning)) : std::nullopt;
}

std::optional<StrokeUse> use_of_stroke(const StrokeProfile& profile, std::uint32_t rgb,
                                       LineStyle line, std::string_view classes) {
  if (const auto said = use_of_colour(profile.colours, rgb)) return use_of(*said);
  if (profile.rules.empty()) return std::nullopt;
  if (profile.nearest) rgb = nearest_colour(profile, rgb);
  for (const StrokeRule& rule : profile.rules) {
    const bool same_line = !rule.line || *rule.line == line ||
                           (*rule.line == LineStyle::Dashed && line == LineStyle::DashDot);
    if (same_line && (rule.css_class.empty() || has_word(classes, rule.css_class)) &&
        (rule.colours.empty() ||
         std::find(rule.colours.begin(), rule.colours.end(), rgb) != rule.colours.end()))
      return rule.use;
  }
  return std::nullopt;
}

}  // namespace popcut
