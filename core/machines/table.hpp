// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace popcut {

/// One row of a table as JSON. The fields it inherits through "like" are filled in.
struct TableRow {
  std::string name;
  std::string pointer;  ///< JSON pointer of the row in its text
  int table{-1};        ///< index of the user's table, -1 for the built-in one
  nlohmann::json row;
};

/// Returns the rows of `list` ("machines", "materials" or "svg_profiles"): first those of the
/// built-in text, then those of each user's text. A user's row replaces an earlier row of the same
/// name. "like": "NAME" inherits the fields of an earlier row.
///
/// @retval Malformed  a text is not a valid table; place is a JSON pointer
[[nodiscard]] Result<std::vector<TableRow>> table_rows(std::string_view list,
                                                       std::string_view built_in,
                                                       const std::vector<std::string>& user_tables);

/// The same error, with the number of the user's table it was found in.
[[nodiscard]] Error in_table(const TableRow& row, Error error);

}  // namespace popcut
