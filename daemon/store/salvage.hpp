// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {

/// What salvage copied into the new database.
struct Salvage {
  struct Table {
    std::string name;
    std::int64_t rows{};     ///< copied
    std::int64_t refused{};  ///< read, but the schema does not allow them
    bool whole{true};        ///< false: reading stopped at damage
  };
  std::vector<Table> tables;
  std::string original;  ///< where the damaged file is now
};

/// Reads what can be read of STATE/popcut.db into a new database, which takes its place. The
/// damaged one is kept in STATE/backups. Takes the lock: popcutd must not run.
///
/// @retval Refused     another process has the folder
/// @retval Malformed   nothing can be read of the database
/// @retval OutOfRange  another version of popcutd wrote it
/// @retval Unwritable  the folder cannot be read or written, or there is no database
[[nodiscard]] Result<Salvage> salvage(const std::string& path);

/// Puts the database `fresh`, which is closed, in the place of the folder's own, and makes the
/// folder's owner own it. Killed at any instant it leaves the old one, which popcutd then refuses,
/// or the new one, whole; it can be done again.
///
/// @retval Unwritable  the folder cannot be written
[[nodiscard]] Result<void> put_in_place(const StateFolder& folder, const std::string& fresh);

/// Run by root, gives what root made in the folder to whose folder it is: a service has a user of
/// its own. Does nothing for others.
void give_to_owner(const std::string& folder);

/// Copies a database and its log to BACKUPS/damaged-DIGEST/, once for the same bytes; gives that
/// folder.
[[nodiscard]] Result<std::string> set_aside(const std::string& database,
                                            const std::string& backups);

}  // namespace popcut::daemon
