// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// What was moved from a state folder into a fleet's database.
struct Imported {
  struct Table {
    std::string name;
    std::int64_t rows{};  ///< moved
    std::int64_t kept{};  ///< were there already, and are as the fleet has them
  };
  std::vector<Table> tables;
  std::int64_t files{}, bytes{};
  std::vector<std::string> missing;  ///< files that should be in the folder but are not
  std::string original;              ///< where the database of the folder is now
};

struct ImportRequest {
  std::string folder;  ///< STATE
  std::string node;    ///< has joined
  /// Called with what is moved now: "job", "files".
  std::function<void(const std::string& what)> report{};
};

/// Moves the jobs, plans, ledgers, events and tokens of a popcutd that was alone, and its files,
/// into a fleet: all in one transaction, or nothing. Ids stay; a local user "uid:1000" becomes
/// "uid:1000@NODE". Then the folder's own database goes into its backups, so that no popcutd cuts
/// the same jobs from it. Takes the lock: popcutd must not run.
///
/// @param fleet  as a member of popcut_owner
/// @retval Refused     another process has the folder; a sheet is armed or its cut has no end; it
/// was
///                     imported before; the node has not joined; the fleet's database says no
/// @retval Malformed, OutOfRange, CheckFailed, Unwritable  the folder's database, as `Store::open`
[[nodiscard]] Result<Imported> import_folder(Database& fleet, const ImportRequest& request);

}  // namespace popcut::daemon
