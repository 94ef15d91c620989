// SPDX-License-Identifier: MIT
#include "daemon/fleet/fleet_schema.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut::daemon {

std::string schema_misfit(Database& database) {
  if (database.number("SELECT count(*) FROM pg_tables WHERE schemaname='popcut' AND "
                      "tablename='popcut_schema'") == 0)
    return "the database has no tables of popcut; make them with: popcut fleet init";
  Rows rows = database.rows("SELECT version, least FROM popcut.popcut_schema");
  if (!rows.next()) return "the database does not say which version its tables have";
  const std::int64_t version = rows.integer(0), least = rows.integer(1);
  if (least > kFleetVersion)
    return fmt::format(
        "the database was made by a later popcut (version {}, this one knows {}); "
        "install that version",
        version, kFleetVersion);
  if (version < kFleetVersion)
    return fmt::format(
        "the tables of the database have version {}, this popcutd needs {}; bring "
        "them up to date with: popcut fleet init",
        version, kFleetVersion);
  return {};
}

const std::vector<FleetStep>& fleet_steps() {
  static const std::vector<FleetStep> none;  // there is version 1 only
  return none;
}

FleetMade make_fleet(Database& database, const std::vector<FleetStep>& steps) {
  FleetMade made{0, steps.empty() ? 1 : steps.back().version};
  Transaction all(database);
  database.hold("popcut.fleet-init");
  if (database.number("SELECT count(*) FROM pg_catalog.pg_namespace WHERE nspname='popcut'") == 0) {
    database.script(std::string(fleet_schema()));
    made.from = 0;
  } else {
    if (database.number("SELECT count(*) FROM pg_catalog.pg_tables WHERE schemaname='popcut' AND "
                        "tablename='popcut_schema'") == 0)
      throw StoreFault(FaultKind::Refused,
                       "the database has a schema popcut that is not of popcut; give the fleet a "
                       "database of its own");
    made.from = static_cast<int>(database.number("SELECT version FROM popcut.popcut_schema"));
  }
  if (made.from > made.to)
    throw StoreFault(FaultKind::Refused,
                     fmt::format("the database was made by a later popcut (version {}, this one "
                                 "knows {}); install that version",
                                 made.from, made.to));
  for (const FleetStep& step : steps) {
    if (step.version <= std::max(made.from, 1)) continue;
    database.script("SET LOCAL ROLE popcut_owner");
    database.script(std::string(step.sql));
    database.run("UPDATE popcut.popcut_schema SET version=?, least=?", step.version, step.least);
    database.script("RESET ROLE");
  }
  all.commit();
  return made;
}

}  // namespace popcut::daemon
