// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/message.hpp"
#include "daemon/http/api/routes.hpp"
#include "daemon/model/input_limits.hpp"

namespace popcut::daemon::http {

/// What one field of a body, or one name of a query, may contain. The readers below, their errors
/// and the description of the API all follow from it.
struct InputRule {
  enum class Kind : std::uint8_t {
    Text,   ///< one line
    Lines,  ///< a text that may have several lines
    Texts,  ///< a list of one-line texts
    Whole,
    Number,
    Flag,
    Word,  ///< one of several words
    Time,  ///< a date, or a time in RFC 3339
    Other  ///< only `schema` says what; its handler reads it
  };
  std::string_view name;
  Kind kind{Kind::Text};
  /// Of a text: its characters, where `most` 0 is no limit. Of a number: its value.
  double least{0}, most{0};
  std::string_view words{};                          ///< with a space between
  std::vector<std::string> (*word_list)(){nullptr};  ///< in place of `words`
  std::string_view description{};
  std::optional<double> usual{};  ///< default: a number, 0 or 1 of a flag, the index of a word
  bool is_required{false};
  std::string_view need{};    ///< what a body without this field should have: "must be ..."
  std::size_t most_items{};   ///< of a list
  std::string_view schema{};  ///< JSON schema that the description has in place of the derived one

  // A row of a table reads: whole("copies", 1, 9).described("...").by_default(1).
  [[nodiscard]] constexpr InputRule described(std::string_view text) const {
    InputRule out = *this;
    out.description = text;
    return out;
  }
  [[nodiscard]] constexpr InputRule by_default(double value) const {
    InputRule out = *this;
    out.usual = value;
    return out;
  }
  /// A body without the field is refused: "is missing; " and `text`.
  [[nodiscard]] constexpr InputRule required(std::string_view text = {}) const {
    InputRule out = *this;
    out.is_required = true;
    out.need = text;
    return out;
  }
  [[nodiscard]] constexpr InputRule with_schema(std::string_view json) const {
    InputRule out = *this;
    out.schema = json;
    return out;
  }
};

/// No upper limit of a number.
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// One line of 1 to `limit` characters.
[[nodiscard]] constexpr InputRule text(std::string_view name, TextLimit limit) {
  return {.name = name, .least = 1, .most = static_cast<double>(limit.characters)};
}
/// One line that may be empty.
[[nodiscard]] constexpr InputRule text_or_empty(std::string_view name, TextLimit limit) {
  return {.name = name, .most = static_cast<double>(limit.characters)};
}
/// Several lines that may be empty.
[[nodiscard]] constexpr InputRule lines(std::string_view name, TextLimit limit) {
  return {
      .name = name, .kind = InputRule::Kind::Lines, .most = static_cast<double>(limit.characters)};
}
/// At most `most` texts of 1 to `limit` characters each.
[[nodiscard]] constexpr InputRule texts(std::string_view name, std::size_t most, TextLimit limit) {
  return {.name = name,
          .kind = InputRule::Kind::Texts,
          .least = 1,
          .most = static_cast<double>(limit.characters),
          .most_items = most};
}
[[nodiscard]] constexpr InputRule whole(std::string_view name, double least, double most) {
  return {.name = name, .kind = InputRule::Kind::Whole, .least = least, .most = most};
}
[[nodiscard]] constexpr InputRule number(std::string_view name, double least, double most) {
  return {.name = name, .kind = InputRule::Kind::Number, .least = least, .most = most};
}
[[nodiscard]] constexpr InputRule flag(std::string_view name) {
  return {.name = name, .kind = InputRule::Kind::Flag};
}
[[nodiscard]] constexpr InputRule word(std::string_view name, std::string_view words) {
  return {.name = name, .kind = InputRule::Kind::Word, .words = words};
}
[[nodiscard]] constexpr InputRule word(std::string_view name,
                                       std::vector<std::string> (*word_list)()) {
  return {.name = name, .kind = InputRule::Kind::Word, .word_list = word_list};
}
[[nodiscard]] constexpr InputRule time(std::string_view name) {
  return {.name = name, .kind = InputRule::Kind::Time};
}
[[nodiscard]] constexpr InputRule other(std::string_view name, std::string_view schema) {
  return {.name = name, .kind = InputRule::Kind::Other, .schema = schema};
}
/// A role of popcutd, by its name.
[[nodiscard]] InputRule role(std::string_view name);

/// Options of a plan, without their dashes.
[[nodiscard]] constexpr InputRule plan_options(std::string_view name) {
  return other(name, R"({"$ref": "#/components/schemas/PlanOptions"})");
}

/// The words that `rule` allows.
[[nodiscard]] std::vector<std::string> words_of(const InputRule& rule);
/// The words of `text`, which has a space between.
[[nodiscard]] std::vector<std::string> words_of(std::string_view text);

/// A JSON body: the schema of that name in the description of the API.
struct Body {
  std::string_view schema;
  std::vector<InputRule> fields{};
  std::string_view description{};
  std::string_view example{"{}"};  ///< JSON
  bool is_optional{false};         ///< a request without a body is one with an empty object
  std::size_t least_fields{0};
  bool is_in_source{false};  ///< the schema is written in openapi.json
};

/// Reads the fields of a body by the rules of `body`. A field with a fault reads as its default;
/// the faults are those of `fields`.
class BodyReader {
 public:
  BodyReader(FieldReader& fields, const Body& body);

  std::string text(std::string_view name);  ///< empty if there is none
  std::optional<std::string> optional_text(std::string_view name);
  std::vector<std::string> texts(std::string_view name);
  int whole(std::string_view name);  ///< of a rule with a default
  std::optional<int> optional_whole(std::string_view name);
  std::optional<std::int64_t> optional_large(std::string_view name);
  double number(std::string_view name);
  bool flag(std::string_view name);  ///< false if there is none
  std::optional<bool> optional_flag(std::string_view name);
  std::string word(std::string_view name);  ///< of a rule with a default, or a required field
  std::optional<std::string> optional_word(std::string_view name);
  Role role(std::string_view name);
  std::map<std::string, std::string> options(std::string_view name);

  /// For what the rules do not say.
  [[nodiscard]] FieldReader& fields() { return fields_; }

 private:
  [[nodiscard]] const InputRule& rule(std::string_view name) const;
  FieldReader& fields_;
  const Body& body_;
};

/// Parses the body of a request and reads it with `read`; fields that it does not read are faults.
template <typename Value, typename Read>
Answer<Value> read_body(const Request& request, const HandlerContext& context, const Body& body,
                        Read read) {
  return read_body_as<Value>(request, context.limits.json_depth, [&](FieldReader& fields) {
    BodyReader reader(fields, body);
    return read(reader);
  });
}
/// The problem of a body that has fields, where none is wanted.
[[nodiscard]] Answer<void> read_nothing(const Request& request, const HandlerContext& context);

/// All names that a query of some route may have.
[[nodiscard]] const std::vector<InputRule>& query_rules();
[[nodiscard]] const InputRule& query_rule(std::string_view name);

/// Reads the query of a request by `query_rules`, and keeps what is wrong with it.
class QueryReader {
 public:
  explicit QueryReader(const Request& request) : request_(request) {}

  std::string text(std::string_view name);  ///< empty if there is none
  std::optional<std::int64_t> whole(std::string_view name);
  bool flag(std::string_view name);
  std::string word(std::string_view name);
  std::optional<TimeMs> time(std::string_view name);
  /// The page that `limit` and `cursor` ask for. A cursor is that of one kind of list: the one of
  /// another list is a fault.
  PageRequest page(char list);

  void refuse(std::string_view name, std::string code, std::string detail);
  /// All that is wrong so far, or nothing.
  [[nodiscard]] std::optional<Problem> problem() const;

 private:
  [[nodiscard]] std::optional<std::string> value(std::string_view name) const;
  const Request& request_;
  std::vector<RequestFault> faults_{};
};

}  // namespace popcut::daemon::http
