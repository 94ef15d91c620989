// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"

/// Tables of fields. A row names a field, says what may stand there, into which member it goes, and
/// what it means. Parser, errors and JSON Schema all follow from the row, so they cannot disagree.
///
///   FieldTable card_table(Card& card) {
///     return {{
///         {"wall_mm", needed(number(&card.wall_mm, above(0), "mm")), "height of the wall"},
///         {"shut", word(&card.shut, {"inside", "free"}), "where the structure lies"},
///     }};
///   }
///
/// A table is bound to one object. `read_fields(card_table(card), fields)` reads into `card`;
/// `object_schema(card_table(card))` describes it, with the values in `card` as defaults.
namespace popcut {

// A value as a member's type, and back. An enumeration is its number, an absent optional is null.
void assign(bool& to, const nlohmann::json& value);
void assign(int& to, const nlohmann::json& value);
void assign(std::uint64_t& to, const nlohmann::json& value);
void assign(double& to, const nlohmann::json& value);
void assign(std::string& to, const nlohmann::json& value);
void assign(nlohmann::json& to, const nlohmann::json& value);
[[nodiscard]] nlohmann::json value_of(bool member);
[[nodiscard]] nlohmann::json value_of(int member);
[[nodiscard]] nlohmann::json value_of(std::uint64_t member);
[[nodiscard]] nlohmann::json value_of(double member);
[[nodiscard]] nlohmann::json value_of(const std::string& member);
[[nodiscard]] nlohmann::json value_of(const std::array<double, 3>& member);
[[nodiscard]] nlohmann::json value_of(const std::vector<double>& member);

template <typename Enum>
concept Enumeration = std::is_enum_v<Enum>;

template <Enumeration Enum>
void assign(Enum& to, const nlohmann::json& value) {
  int number{};
  assign(number, value);
  to = static_cast<Enum>(number);
}
template <typename T, std::size_t N>
void assign(std::array<T, N>& to, const nlohmann::json& value) {
  for (std::size_t k = 0; k < N; ++k) assign(to[k], value[k]);
}
template <typename T>
void assign(std::vector<T>& to, const nlohmann::json& value) {
  to.clear();
  to.reserve(value.size());
  for (const nlohmann::json& item : value) assign(to.emplace_back(), item);
}
template <typename T>
void assign(std::optional<T>& to, const nlohmann::json& value) {
  to.reset();
  if (!value.is_null()) assign(to.emplace(), value);
}

template <Enumeration Enum>
[[nodiscard]] nlohmann::json value_of(Enum member) {
  return value_of(static_cast<int>(member));
}
template <typename T>
[[nodiscard]] nlohmann::json value_of(const std::optional<T>& member) {
  return member ? value_of(*member) : nlohmann::json();
}

/// The type of a member, without its `std::optional`.
template <typename T>
struct MemberType {
  using Value = T;
  static constexpr bool is_optional = false;
};
template <typename T>
struct MemberType<std::optional<T>> {
  using Value = T;
  static constexpr bool is_optional = true;
};

/// The member of an object that a value goes into.
struct Member {
  Member() = default;  ///< none: a value is checked only
  template <typename T>
  Member(T* member)  // NOLINT(google-explicit-constructor): rows name members as they are
      : at(member),
        set([](void* to, const nlohmann::json& value) { assign(*static_cast<T*>(to), value); }),
        takes_index(std::is_enum_v<typename MemberType<T>::Value>),
        takes_null(MemberType<T>::is_optional) {
    if constexpr (requires { value_of(*member); })
      get = [](const void* from) { return value_of(*static_cast<const T*>(from)); };
  }
  /// A member that stores values in a way of its own.
  Member(void* member, void (*how)(void*, const nlohmann::json&), bool is_index = false)
      : at(member), set(how), takes_index(is_index) {}

  void* at{};
  void (*set)(void* at, const nlohmann::json& value){};
  nlohmann::json (*get)(const void* at){};  ///< none of lists of lists, and of `set` alone
  bool takes_index{};                       ///< words are stored as their index
  bool takes_null{};                        ///< it may be absent
};

/// Adds each value to a list.
template <typename T>
[[nodiscard]] Member appended(std::vector<T>* list) {
  return {list,
          [](void* to, const nlohmann::json& value) {
            assign(static_cast<std::vector<T>*>(to)->emplace_back(), value);
          },
          std::is_enum_v<T>};
}

/// Numbers from `low` to `high`; `is_open` leaves `low` itself out.
struct Range {
  double low{-std::numeric_limits<double>::infinity()};
  double high{std::numeric_limits<double>::infinity()};
  bool is_open{};
};
[[nodiscard]] constexpr Range above(double low, double high = Range{}.high) {
  return {low, high, true};
}
[[nodiscard]] constexpr Range from(double low, double high) { return {low, high, false}; }

/// How many items a list has, and the kind of error where it has more or fewer.
struct Count {
  std::size_t least{}, most{};
  ErrorKind kind{ErrorKind::OutOfRange};
};

struct FieldTable;
struct ValuePlace;

/// What may stand at a field. The functions in `rule` make one.
struct ValueRule {
  /// Reads a value into the member. @return whether the value follows the rule
  bool (*read)(const ValueRule& rule, const ValuePlace& at){};
  /// Whether the value has the JSON type of the rule.
  bool (*takes)(const nlohmann::json& value){};
  Member into{};
  std::string what{};                ///< what a message says must stand there: "a number above 0"
  nlohmann::json schema{};           ///< without that of the parts and of the table
  std::string unit{};                ///< "mm"; empty: none
  Range range{};                     ///< of a number
  TextRule text{};                   ///< of a text
  std::vector<std::string> words{};  ///< of a word; else the types of the parts
  Count count{};                     ///< of a list, whose only part is the rule of its items
  std::vector<ValueRule> parts{};    ///< of a list, or of a value of one of several forms
  /// Of an object: makes a new one, and returns a table that is bound to it.
  std::function<FieldTable()> table{};
  nlohmann::json usual{};  ///< the default, where the member does not say it
  bool is_needed{};        ///< the field may not be left out
  bool is_blamed{};        ///< whatever is wrong in the value is one fault of the value itself
};

/// A row of a table.
struct Field {
  std::string_view name;
  ValueRule rule;
  std::string_view help;
};

/// The fields of one object, with the rules between them.
struct FieldTable {
  std::vector<Field> rows;
  /// Two fields of which exactly one must stand, or nothing. If neither does, the first is missing.
  std::vector<std::string> exactly_one{};
  /// Checks what concerns several fields, and completes the object. Runs if each field is right.
  std::function<void(FieldReader&)> complete{};
  nlohmann::json more{};  ///< what JSON Schema can say of these rules
};

/// Reads the fields of `table` into their members. @return whether no fault was found
bool read_fields(const FieldTable& table, FieldReader& fields);

/// The JSON Schema of an object with the fields of `table` and no others.
[[nodiscard]] nlohmann::json object_schema(const FieldTable& table);
/// Adds the fields of `table` to the properties and the required fields of an object's schema.
void describe_fields(const FieldTable& table, nlohmann::json& schema);

namespace rule {

[[nodiscard]] ValueRule number(Member into, Range range, std::string unit = "");
/// A number, or null for none; the member is an optional.
[[nodiscard]] ValueRule number_or_null(Member into, Range range);
[[nodiscard]] ValueRule whole(Member into, int low, int high);
[[nodiscard]] ValueRule text(Member into, const TextRule& limits = {});
/// The name of a file: 1 to 1024 bytes, none of them zero.
[[nodiscard]] ValueRule file_name(Member into);
[[nodiscard]] ValueRule flag(Member into);
/// One of `words`: an enumeration by their order, or a text.
[[nodiscard]] ValueRule word(Member into, std::vector<std::string> words);
/// Any value; `schema` and `what` describe what its reader accepts.
[[nodiscard]] ValueRule any(Member into, nlohmann::json schema, std::string what);
/// Items of one rule, which have no member of their own or append themselves.
[[nodiscard]] ValueRule list(Member into, ValueRule item, Count count, std::string what);
/// Exactly three numbers. Another count of them is malformed, and a list of lists no such value.
[[nodiscard]] ValueRule triple(Member into, Range range, std::string what);
/// An object; `table` makes a new one and returns a table that is bound to it.
[[nodiscard]] ValueRule object(std::function<FieldTable()> table, std::string what = "an object");
/// An object that says in "type" which of `kinds` it is. Each has a name and the rule of an object.
[[nodiscard]] ValueRule tagged(const std::vector<Field>& kinds);
/// A value of one of two or more JSON types.
[[nodiscard]] ValueRule either(std::vector<ValueRule> alternatives);

[[nodiscard]] ValueRule needed(ValueRule rule);
/// `rule`, where whatever is wrong in the value is one fault of the value itself.
[[nodiscard]] ValueRule blamed(ValueRule rule);

}  // namespace rule
}  // namespace popcut
