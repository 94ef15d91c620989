// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

/// A step from the version before it to `version`. Then every popcutd whose version is at least
/// `least` works with the database, so that a fleet is brought up to date node by node.
struct FleetStep {
  int version{};
  int least{};
  std::string_view sql;
};
/// All steps after version 1, in order.
[[nodiscard]] const std::vector<FleetStep>& fleet_steps();

/// What `make_fleet` did: from version 0, an empty database, to the newest.
struct FleetMade {
  int from{}, to{};
};
/// Makes the schema and the roles, or brings them to the newest version, in one transaction. Two at
/// once do it once.
///
/// @throws StoreFault  Refused: the database is of a later popcut; as the statements, else
FleetMade make_fleet(Database& database, const std::vector<FleetStep>& steps = fleet_steps());

}  // namespace popcut::daemon
