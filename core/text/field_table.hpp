// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"

/// Tables of fields: a row names a field, its type and range, its default and what it means. The
/// reader of a document and its JSON Schema are both made from the table, so they cannot disagree.
///
///   const FieldTable<Card> card{{
///       field<Card>("wall_mm", &Card::wall_mm, shape::number(shape::above(0), "mm"), "height of
///       the wall"),
///   }};
///
/// A row reads into a member; a member that is a `std::optional` has no default. A field that must
/// be there is a `needed` row.
namespace popcut {

/// The type of a value of a document: how it is read and described. `read` returns nothing where it
/// has added a fault.
template <typename V>
struct Shape {
  using Value = V;
  nlohmann::json schema;
  std::string what;  ///< "a number above 0": what a message says must stand there
  std::function<bool(const nlohmann::json&)> takes;  ///< the JSON types that it is written as
  std::function<std::optional<V>(FieldReader&, const std::string& below, const nlohmann::json&)>
      read;
  std::function<nlohmann::json(const V&)> written{};  ///< the value as JSON, for defaults
  std::string unit{};                                 ///< "mm"; empty: none
};

/// A row of a table: a field of a document's object, read into an `Object`.
template <typename Object>
struct FieldRow {
  std::string name;
  bool is_needed{};
  nlohmann::json schema;
  std::function<void(FieldReader&, Object&)> read;
};

/// The fields of one kind of object, with the rules between them.
template <typename Object>
struct FieldTable {
  std::vector<FieldRow<Object>> rows;
  /// Checks which fields stand together, before they are read.
  std::function<void(FieldReader&)> clash{};
  /// Checks what concerns several fields, and completes `Object`. Runs if each field is right.
  std::function<void(FieldReader&, Object&)> check{};
  nlohmann::json more{};  ///< what JSON Schema can say of these rules

  /// Reads all rows. @return whether no fault was found
  bool read(FieldReader& fields, Object& object) const {
    const std::size_t before = fields.faults().size();
    if (clash) clash(fields);
    for (const FieldRow<Object>& row : rows) row.read(fields, object);
    if (check && fields.faults().size() == before) check(fields, object);
    return fields.faults().size() == before;
  }
  /// Adds the rows' schemas to the properties and the required fields of an object's schema.
  void describe(nlohmann::json& schema) const {
    for (const FieldRow<Object>& row : rows) {
      schema["properties"][row.name] = row.schema;
      if (row.is_needed) schema["required"].push_back(row.name);
    }
    if (!more.is_null()) schema.update(more);
  }
};

/// The JSON Schema of an object that has the rows of `table` and no others.
template <typename Object>
[[nodiscard]] nlohmann::json object_schema(const FieldTable<Object>& table) {
  nlohmann::json schema{{"type", "object"}, {"additionalProperties", false}};
  table.describe(schema);
  return schema;
}

/// A row that may be left out. @param member  a member of `Object`, or a function from an `Object&`
/// to the reference that the field is read into
template <typename Object, typename Member, typename V>
[[nodiscard]] FieldRow<Object> field(std::string name, Member member, const Shape<V>& shape,
                                     const std::string& help, bool is_needed = false) {
  nlohmann::json schema = shape.schema;
  schema["description"] = shape.unit.empty() ? help : fmt::format("{}, {}", help, shape.unit);
  Object usual{};
  using Target = std::remove_cvref_t<decltype(std::invoke(member, usual))>;
  if (shape.written && !is_needed) {
    if constexpr (std::is_same_v<Target, V>)
      schema["default"] = shape.written(std::invoke(member, usual));
    else if constexpr (std::is_same_v<Target, std::optional<V>>)
      if (std::invoke(member, usual))
        schema["default"] = shape.written(*std::invoke(member, usual));
  }
  auto read = [name, member, shape, is_needed](FieldReader& fields, Object& object) {
    const nlohmann::json* found = fields.value(name);
    if (found == nullptr) {
      if (is_needed) fields.need(name, "must be " + shape.what);
      return;
    }
    if (auto value = shape.read(fields, name, *found))
      std::invoke(member, object) = std::move(*value);
  };
  return {std::move(name), is_needed, std::move(schema), std::move(read)};
}

template <typename Object, typename Member, typename V>
[[nodiscard]] FieldRow<Object> needed(std::string name, Member member, const Shape<V>& shape,
                                      const std::string& help) {
  return field<Object>(std::move(name), member, shape, help, true);
}

namespace shape {

using nlohmann::json;

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

[[nodiscard]] Shape<double> number(const Range& range, const std::string& unit = "");
[[nodiscard]] Shape<int> whole(int low, int high);
[[nodiscard]] Shape<std::string> text(const TextRule& rule = {});
[[nodiscard]] Shape<bool> boolean();
/// Any value; `schema` describes what the one who reads it accepts.
[[nodiscard]] Shape<json> any(json schema, std::string what);

/// One of `words`, as the enumerator of the same index.
template <typename Enum>
[[nodiscard]] Shape<Enum> word(const std::vector<std::string>& words) {
  return {{{"enum", words}},
          fmt::format("one of {}", fmt::join(words, ", ")),
          [](const json& value) { return value.is_string(); },
          [words](FieldReader& fields, const std::string& below,
                  const json& value) -> std::optional<Enum> {
            if (const auto index = fields.word_at(below, value, words))
              return static_cast<Enum>(*index);
            return std::nullopt;
          },
          [words](const Enum& value) { return words[static_cast<std::size_t>(value)]; }};
}

/// `shape` as another type of value.
template <typename To, typename From, typename Convert>
[[nodiscard]] Shape<To> as(const Shape<From>& shape, Convert convert) {
  return {shape.schema,
          shape.what,
          shape.takes,
          [read = shape.read, convert](FieldReader& fields, const std::string& below,
                                       const json& value) -> std::optional<To> {
            auto got = read(fields, below, value);
            if (!got) return std::nullopt;
            return std::optional<To>(std::in_place, convert(std::move(*got)));
          },
          {},
          shape.unit};
}

/// `shape`, where whatever is wrong with it or in it is one fault of `kind` at the value itself.
template <typename V>
[[nodiscard]] Shape<V> blamed(Shape<V> shape, ErrorKind kind) {
  shape.read = [read = shape.read, what = shape.what, kind](FieldReader& fields,
                                                            const std::string& below,
                                                            const json& value) -> std::optional<V> {
    const json nothing = json::object();
    FieldReader scratch(nothing);
    auto got = read(scratch, below, value);
    if (!got) fields.refuse(below, kind, fmt::format("is {}; must be {}", shown_type(value), what));
    return got;
  };
  return shape;
}

/// How many items a list has, and the kind of error where it has others.
struct Count {
  std::size_t least{}, most{};
  ErrorKind kind{ErrorKind::OutOfRange};
};

/// Items of one shape.
template <typename V>
[[nodiscard]] Shape<std::vector<V>> list(const Shape<V>& item, const Count& count,
                                         const std::string& what) {
  return {{{"type", "array"},
           {"minItems", count.least},
           {"maxItems", count.most},
           {"items", item.schema}},
          what,
          [](const json& value) { return value.is_array(); },
          [item, count, what](FieldReader& fields, const std::string& below,
                              const json& value) -> std::optional<std::vector<V>> {
            if (!value.is_array() || value.size() < count.least || value.size() > count.most) {
              fields.refuse(below, value.is_array() ? count.kind : ErrorKind::Malformed,
                            fmt::format("is {}; must be {}", shown_type(value), what));
              return std::nullopt;
            }
            std::vector<V> out;
            out.reserve(value.size());
            for (std::size_t k = 0; k < value.size(); ++k) {
              auto got = item.read(fields, fmt::format("{}/{}", below, k), value[k]);
              if (!got) return std::nullopt;
              out.push_back(std::move(*got));
            }
            return out;
          },
          {},
          item.unit};
}

/// Exactly three numbers. Another count of them is malformed.
[[nodiscard]] Shape<std::array<double, 3>> triple(const Range& range, const std::string& what);

/// The first of two shapes that takes the JSON type of a value.
template <typename V>
[[nodiscard]] Shape<V> either(const Shape<V>& first, const Shape<V>& second) {
  json schema =
      first.schema.contains("oneOf") ? first.schema : json{{"oneOf", json::array({first.schema})}};
  schema["oneOf"].push_back(second.schema);
  return {std::move(schema),
          first.what + ", or " + second.what,
          [first, second](const json& value) { return first.takes(value) || second.takes(value); },
          [first, second](FieldReader& fields, const std::string& below,
                          const json& value) -> std::optional<V> {
            if (first.takes(value)) return first.read(fields, below, value);
            if (second.takes(value)) return second.read(fields, below, value);
            fields.refuse(
                below, ErrorKind::Malformed,
                fmt::format("is {}; must be {}, or {}", shown_type(value), first.what, second.what),
                "type");
            return std::nullopt;
          },
          first.written,
          first.unit};
}

/// An object with the fields of a table.
template <typename Object>
[[nodiscard]] Shape<Object> object(const FieldTable<Object>& table, const std::string& what) {
  return {object_schema(table), what, [](const json& value) { return value.is_object(); },
          [table](FieldReader& fields, const std::string& below,
                  const json& value) -> std::optional<Object> {
            FieldReader inner = fields.nested(value, below);
            Object object{};
            const std::size_t before = fields.faults().size();
            if (!value.is_object()) return std::nullopt;
            const bool is_right = table.read(inner, object);
            static_cast<void>(inner.finish());
            if (is_right && fields.faults().size() == before) return object;
            return std::nullopt;
          }};
}

/// One kind of an object that says its kind in "type".
template <typename Variant>
struct Kind {
  std::string name;
  json schema;
  std::function<bool(FieldReader&, Variant&)> read;
};
template <typename Variant, typename Object>
[[nodiscard]] Kind<Variant> kind(const std::string& name, const FieldTable<Object>& table,
                                 const std::string& help) {
  json schema = object_schema(table);
  schema["properties"]["type"] = {{"const", name}};
  schema["required"].push_back("type");
  schema["description"] = help;
  return {name, std::move(schema), [table](FieldReader& fields, Variant& out) {
            Object object{};
            const bool is_right = table.read(fields, object);
            out = std::move(object);
            return is_right;
          }};
}

/// An object of one of several kinds.
template <typename Variant>
[[nodiscard]] Shape<Variant> tagged(const std::vector<Kind<Variant>>& kinds) {
  json alternatives = json::array();
  std::vector<std::string> names;
  for (const Kind<Variant>& kind : kinds) {
    alternatives.push_back(kind.schema);
    names.push_back(kind.name);
  }
  return {{{"oneOf", alternatives}},
          "an object",
          [](const json& value) { return value.is_object(); },
          [kinds, names](FieldReader& fields, const std::string& below,
                         const json& value) -> std::optional<Variant> {
            FieldReader inner = fields.nested(value, below);
            if (!value.is_object()) return std::nullopt;
            inner.need("type", fmt::format("must be one of {}", fmt::join(names, ", ")));
            const auto type = inner.optional_word("type", names);
            if (!type) return std::nullopt;
            Variant out;
            const std::size_t before = fields.faults().size();
            kinds[*type].read(inner, out);
            static_cast<void>(inner.finish());
            if (fields.faults().size() != before) return std::nullopt;
            return out;
          }};
}

}  // namespace shape
}  // namespace popcut
