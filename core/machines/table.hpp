// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace popcut {

/// One row of a table as JSON, with what it inherits by "like" filled in.
struct TableRow {
  std::string name;
  std::string pointer;  ///< where it stands in its text
  int table{-1};        ///< index of the user's table, -1 for the built-in one
  nlohmann::json row;
};

/// The rows of `list` ("machines" or "materials") of the built-in text and then of each user's
/// text. A row of a name that is there already takes its place; "like": "NAME" starts from another
/// row.
///
/// @retval Malformed  a text is not of the table's form; place is a JSON pointer
[[nodiscard]] Result<std::vector<TableRow>> table_rows(std::string_view list,
                                                       std::string_view built_in,
                                                       const std::vector<std::string>& user_tables);

/// The same error with the number of the user's table it was found in.
[[nodiscard]] Error in_table(const TableRow& row, Error error);

}  // namespace popcut
