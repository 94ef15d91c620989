// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// "popc": identifies a database of popcutd.
inline constexpr int kApplicationId = 0x706F7063;
/// The version of the tables that this popcutd reads and writes; it touches no other.
inline constexpr int kSchemaVersion = 2;
/// The oldest version whose rows `salvage` brings into tables of this one.
inline constexpr int kOldestSalvaged = 1;

/// The tables and indexes that a fleet has too: tables.sql.
[[nodiscard]] std::string_view shared_tables();

/// Makes all tables in an empty database.
void build_schema(Database& database);

/// The version of the tables in a database; 0 if it has none.
[[nodiscard]] int schema_version(Database& database);
/// Why a database with tables of `version` is not used, and what to do; empty: it is used.
///
/// @param state  of which popcutd the database is: an older one is brought up to date by the
/// command
///   that is named; empty: the database is a copy
[[nodiscard]] std::string version_misfit(int version, const std::string& state);

/// The tables, for salvage: those that others refer to come first.
[[nodiscard]] const std::vector<std::string_view>& table_names();

}  // namespace popcut::daemon
