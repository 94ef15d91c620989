// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"
#include "daemon/store/integrity.hpp"

namespace popcut::daemon {

/// What a copy replaced.
struct Restored {
  Integrity copy;
  std::string original;  ///< where the database that was there is now; empty: there was none
};

/// Puts a copy of the database in the place of STATE/popcut.db; a log beside the copy belongs to
/// it. What was there is kept in STATE/backups. Takes the lock: popcutd must not run.
///
/// @param older  also where the database that is there is whole and knows more than the copy
/// @retval Refused      another process has the folder; or without `older` something would be lost
/// @retval Malformed    the copy is damaged, or no database of popcutd
/// @retval OutOfRange   another version of popcutd wrote the copy
/// @retval Unwritable   the folder cannot be read or written
[[nodiscard]] Result<Restored> restore(const std::string& folder, const std::string& copy,
                                       bool older);

}  // namespace popcut::daemon
