// SPDX-License-Identifier: MIT
#include "daemon/http/api/input.hpp"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/target.hpp"

namespace popcut::daemon::http {
namespace {

using Kind = InputRule::Kind;

TextRule text_rule(const InputRule& rule) {
  return {static_cast<std::size_t>(rule.least), static_cast<std::size_t>(rule.most),
          rule.kind == Kind::Lines ? TextRule::Controls::Lines : TextRule::Controls::None};
}

std::int64_t most_of(const InputRule& rule) {
  return rule.most == kNoLimit ? std::numeric_limits<std::int64_t>::max()
                               : static_cast<std::int64_t>(rule.most);
}

const InputRule& rule_in(const std::vector<InputRule>& rules, std::string_view name) {
  const auto found = std::find_if(rules.begin(), rules.end(),
                                  [&](const InputRule& rule) { return rule.name == name; });
  assert(found != rules.end());
  return *found;
}

}  // namespace

InputRule role(std::string_view name) {
  return word(name, "viewer submitter operator admin")
      .with_schema(R"({"$ref": "#/components/schemas/Role"})");
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    out.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::vector<std::string> words_of(const InputRule& rule) {
  return rule.word_list != nullptr ? rule.word_list() : words_of(rule.words);
}

BodyReader::BodyReader(FieldReader& fields, const Body& body) : fields_(fields), body_(body) {
  for (const InputRule& rule : body.fields)
    if (!rule.need.empty()) fields.need(std::string(rule.name), std::string(rule.need));
}

const InputRule& BodyReader::rule(std::string_view name) const {
  return rule_in(body_.fields, name);
}

std::string BodyReader::text(std::string_view name) {
  return fields_.text(std::string(name), "", text_rule(rule(name)));
}

std::optional<std::string> BodyReader::optional_text(std::string_view name) {
  return fields_.optional_text(std::string(name), text_rule(rule(name)));
}

std::vector<std::string> BodyReader::texts(std::string_view name) {
  const InputRule& of = rule(name);
  return fields_.optional_texts(std::string(name), of.most_items, text_rule(of))
      .value_or(std::vector<std::string>());
}

int BodyReader::whole(std::string_view name) {
  return optional_whole(name).value_or(static_cast<int>(rule(name).usual.value_or(0)));
}

std::optional<int> BodyReader::optional_whole(std::string_view name) {
  const std::optional<std::int64_t> value = optional_large(name);
  return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

std::optional<std::int64_t> BodyReader::optional_large(std::string_view name) {
  const InputRule& of = rule(name);
  return fields_.optional_integer(std::string(name), static_cast<std::int64_t>(of.least),
                                  most_of(of));
}

double BodyReader::number(std::string_view name) {
  const InputRule& of = rule(name);
  return fields_.number(std::string(name), of.usual, of.least, of.most);
}

bool BodyReader::flag(std::string_view name) { return optional_flag(name).value_or(false); }

std::optional<bool> BodyReader::optional_flag(std::string_view name) {
  assert(rule(name).kind == Kind::Flag);
  return fields_.optional_boolean(std::string(name));
}

std::string BodyReader::word(std::string_view name) {
  const InputRule& of = rule(name);
  const std::vector<std::string> words = words_of(of);
  const auto usual = of.usual ? std::optional(static_cast<std::size_t>(*of.usual)) : std::nullopt;
  return words[fields_.word(std::string(name), usual, words)];
}

std::optional<std::string> BodyReader::optional_word(std::string_view name) {
  const std::vector<std::string> words = words_of(rule(name));
  const auto found = fields_.optional_word(std::string(name), words);
  return found ? std::optional(words[*found]) : std::nullopt;
}

Role BodyReader::role(std::string_view name) {
  return role_from(word(name)).value_or(Role::Viewer);
}

std::map<std::string, std::string> BodyReader::options(std::string_view name) {
  return read_options(fields_, std::string(name));
}

Answer<void> read_nothing(const Request& request, const HandlerContext& context) {
  const auto read =
      read_body<bool>(request, context, body::kNothing, [](BodyReader&) { return true; });
  if (!read) return tl::unexpected<Problem>(read.error());
  return {};
}

const std::vector<InputRule>& query_rules() {
  constexpr TextLimit kReadingLimit{2000};
  constexpr std::string_view kTime = "a date, or a time in RFC 3339";
  static const std::vector<InputRule> rules{
      whole("limit", 1, kMostPageItems),
      InputRule{.name = "cursor"}.described("next_cursor of the previous page"),
      whole("after", 0, kNoLimit)
          .described(
              "number of the last event that you received; the list starts with the next one"),
      time("from").described(kTime),
      time("to").described(kTime),
      time("since").described(kTime),
      word("by", "owner device material").by_default(0),
      text_or_empty("name", kNameLimit).described("a name for people; never used as a path"),
      InputRule{.name = "state"}.described("states, separated by commas"),
      word("order", "asc desc")
          .described("asc: the oldest first; desc: the newest first")
          .by_default(0),
      {.name = "owner"},
      {.name = "device"},
      {.name = "site"},
      whole("part", 1, kMostSheets)
          .described("number of the part, if the design has several")
          .by_default(1),
      text_or_empty("layers", kReadingLimit).described("what layers are for, as when you plan it"),
      text_or_empty("colors", kReadingLimit).described("what colours are for, as when you plan it"),
      text_or_empty("units", kIdLimit).described("the unit of a DXF or FOLD file"),
      word("mode", "view surface")
          .described("view: the model as you see it; surface: the colour of the nearest point of "
                     "its surface")
          .by_default(0),
      whole("dpi", kLeastDpi, kMostDpi).described("dots per inch").by_default(300),
      flag("clay").described("print without the colours of the model").by_default(0),
      flag("back").described("add a mirrored second page for the other side").by_default(0),
      InputRule{.name = "model"}.described("id of the asset with the colours to print: OBJ, GLB, "
                                           "glTF or STL, in the units and axes of the spec's mesh"),
  };
  return rules;
}

const InputRule& query_rule(std::string_view name) { return rule_in(query_rules(), name); }

std::optional<std::string> QueryReader::value(std::string_view name) const {
  for (const auto& [known, value] : request_.query)
    if (known == name) return value;
  return std::nullopt;
}

std::string QueryReader::text(std::string_view name) {
  const InputRule& rule = query_rule(name);
  std::string text = value(name).value_or("");
  if (rule.most > 0) {
    const TextLimit limit{static_cast<std::size_t>(rule.most)};
    if (text.size() > limit.bytes() || has_controls(text))
      refuse(name, "length",
             fmt::format("must have at most {} characters, and no control characters",
                         limit.characters));
  }
  return text;
}

std::optional<std::int64_t> QueryReader::whole(std::string_view name) {
  const InputRule& rule = query_rule(name);
  const auto low = static_cast<std::int64_t>(rule.least), high = most_of(rule);
  const std::optional<std::string> text = value(name);
  if (!text) {
    if (!rule.usual) return std::nullopt;
    return static_cast<std::int64_t>(*rule.usual);
  }
  const std::optional<std::int64_t> number = whole_number(*text);
  if (number && *number >= low && *number <= high) return number;
  refuse(name, "range", fmt::format("must be {}..{}", low, high));
  return std::nullopt;
}

bool QueryReader::flag(std::string_view name) {
  assert(query_rule(name).kind == Kind::Flag);
  const std::string text = value(name).value_or("false");
  if (text != "true" && text != "false") refuse(name, "word", "must be true or false");
  return text == "true";
}

std::string QueryReader::word(std::string_view name) {
  const InputRule& rule = query_rule(name);
  const std::vector<std::string> words = words_of(rule);
  const auto usual = static_cast<std::size_t>(rule.usual.value_or(0));
  std::string text = value(name).value_or(words[usual]);
  if (std::find(words.begin(), words.end(), text) != words.end()) return text;
  refuse(name, "word", fmt::format("must be one of {}", fmt::join(words, ", ")));
  return words[usual];
}

std::optional<TimeMs> QueryReader::time(std::string_view name) {
  assert(query_rule(name).kind == Kind::Time);
  const std::optional<std::string> text = value(name);
  if (!text) return std::nullopt;
  const std::optional<TimeMs> time = time_from(*text);
  if (!time)
    refuse(name, "time", "must be a date like 2026-11-21 or a time like 2026-11-21T10:00:00Z");
  return time;
}

PageRequest QueryReader::page(char list) {
  PageRequest wanted;
  wanted.limit = static_cast<int>(whole("limit").value_or(request_.usual_page_items));
  const std::optional<std::string> cursor = value("cursor");
  if (!cursor) return wanted;
  const std::optional<std::string> place = decode_cursor(*cursor);
  if (place && place->size() > 1 && place->front() == list)
    wanted.cursor = place->substr(1);
  else
    refuse("cursor", "cursor", "must be the next_cursor of the previous page of the same list");
  return wanted;
}

void QueryReader::refuse(std::string_view name, std::string code, std::string detail) {
  faults_.push_back({fmt::format("?{}", name), std::move(code), std::move(detail)});
}

std::optional<Problem> QueryReader::problem() const {
  return faults_.empty() ? std::nullopt : std::optional(validation(faults_));
}

}  // namespace popcut::daemon::http
