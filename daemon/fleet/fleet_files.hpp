// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "daemon/files/shared_files.hpp"
#include "daemon/fleet/postgres_database.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {

/// The shared files of a fleet: tables `blob` and `blob_part` of its database. Each is held against
/// its digest when it is fetched.
///
/// @param service  the connection of the service's thread
/// @param own      how to reach the database from other threads
[[nodiscard]] std::unique_ptr<SharedFiles> make_fleet_files(Database& service,
                                                            const StateFolder& folder,
                                                            PostgresDatabase::Options own);

}  // namespace popcut::daemon
