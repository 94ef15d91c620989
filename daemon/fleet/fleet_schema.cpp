// SPDX-License-Identifier: MIT
#include "daemon/fleet/fleet_schema.hpp"

#include <fmt/format.h>

namespace popcut::daemon {

std::string schema_misfit(Database& database) {
  if (database.number("SELECT count(*) FROM pg_tables WHERE schemaname='popcut' AND "
                      "tablename='popcut_schema'") == 0)
    return "the database has no tables of popcut; make them with: popcut fleet init";
  Rows rows = database.rows("SELECT version, least FROM popcut_schema");
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

}  // namespace popcut::daemon
