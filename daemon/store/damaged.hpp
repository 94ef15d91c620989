// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/store/database.hpp"
#include "daemon/store/schema.hpp"

namespace popcut::daemon {

/// Makes the tables of `version` in an empty database.
void build_schema(Database& database, const std::vector<Migration>& steps, int version);

/// Copies a database and its log to BACKUPS/damaged-DIGEST/, once for the same bytes; gives that
/// folder.
[[nodiscard]] Result<std::string> set_aside(const std::string& database,
                                            const std::string& backups);

}  // namespace popcut::daemon
