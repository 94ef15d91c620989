// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// "popc": identifies a database of popcutd.
inline constexpr int kApplicationId = 0x706F7063;

/// One step from the version before it to `version`, forward only.
struct Migration {
  int version{};
  std::string_view sql;
};

/// All steps in order, the first making the tables of an empty database.
[[nodiscard]] const std::vector<Migration>& migrations();

/// The tables, for salvage: those that others refer to come first.
[[nodiscard]] const std::vector<std::string_view>& table_names();

/// Makes the tables of `version` in an empty database.
void build_schema(Database& database, const std::vector<Migration>& steps, int version);

}  // namespace popcut::daemon
