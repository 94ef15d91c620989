// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// The tables, functions and roles of a fleet: schema.sql. Run as one script in an empty database,
/// by a role that may make roles.
[[nodiscard]] std::string_view fleet_schema();

/// The version of the schema that this popcutd knows.
inline constexpr int kFleetVersion = 1;

/// Whether this popcutd may use the database.
///
/// @return why not, with what to do; empty: it may
/// @throws StoreFault  Away: it is not known
[[nodiscard]] std::string schema_misfit(Database& database);

}  // namespace popcut::daemon
