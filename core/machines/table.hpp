// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "core/text/near_names.hpp"

namespace popcut {

/// The built-in tables core/data/*.json, embedded when the library is built.
extern const std::string_view kMachinesJson;
extern const std::string_view kMaterialsJson;
extern const std::string_view kSvgProfilesJson;
extern const std::string_view kLayerWordsJson;

/// One row of a table as JSON, with what it inherits by "like" filled in.
struct TableRow {
  std::string name;
  std::string pointer;  ///< JSON pointer of the row in its text
  int table{-1};        ///< index of the user's table, -1 for the built-in one
  nlohmann::json row;
};

/// Returns the rows of `list` ("machines", "materials", "svg_profiles" or "layer_words"): first
/// those of the built-in text, then those of each user's text. A user's row replaces an earlier row
/// of the same name. "like": "NAME" inherits the fields of an earlier row.
///
/// @retval Malformed  a text is not a valid table; place is a JSON pointer
[[nodiscard]] Result<std::vector<TableRow>> table_rows(std::string_view list,
                                                       std::string_view built_in,
                                                       const std::vector<std::string>& user_tables);

/// The same error, with the number of the user's table it was found in.
[[nodiscard]] Error in_table(const TableRow& row, Error error);

/// All rows of a table as values; `read` makes a `Result` of one of a row.
template <typename Read>
[[nodiscard]] auto table_values(std::string_view list, std::string_view built_in,
                                const std::vector<std::string>& user_tables, const Read& read)
    -> Result<std::vector<typename decltype(read(TableRow{}))::value_type>> {
  const auto rows = table_rows(list, built_in, user_tables);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<typename decltype(read(TableRow{}))::value_type> values;
  for (const TableRow& row : *rows) {
    auto value = read(row);
    if (!value) return tl::unexpected(value.error());
    values.push_back(std::move(*value));
  }
  return values;
}

/// The value of a name; `kind` is what the table lists, for the error.
///
/// @retval `unknown`  no such name; the detail lists the names that are near
template <typename Value>
[[nodiscard]] Result<Value> value_named(std::string_view name, Result<std::vector<Value>> values,
                                        const char* kind, ErrorKind unknown = ErrorKind::OutOfRange,
                                        std::string place = "") {
  if (!values) return tl::unexpected(values.error());
  std::vector<std::string> names;
  for (Value& value : *values) {
    if (value.name == name) return std::move(value);
    names.push_back(value.name);
  }
  return fail(
      unknown, std::move(place),
      fmt::format("no {} is called {}; {}", kind, name.substr(0, 80), suggestion(name, names)));
}

}  // namespace popcut
