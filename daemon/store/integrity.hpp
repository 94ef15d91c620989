// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "daemon/store/sqlite_database.hpp"

namespace popcut::daemon {

/// What there is in a database, as SQLite's full check and a few counts say.
struct Integrity {
  std::string damage;          ///< the first that is wrong with it; empty: it is whole
  std::int64_t application{};  ///< whose it is: `kApplicationId`
  int version{};               ///< of its schema
  std::int64_t jobs{};         ///< how many there are
  std::int64_t last_event{};   ///< number of the last one
};

/// What SQLite's full check of all pages finds first; empty: nothing.
///
/// @throws StoreFault  if it cannot be read at all
[[nodiscard]] std::string damage_in(Database& database);

/// Looks at all of a database and its log. Both are copied into the folder `scratch`, which is
/// made and removed, so that neither of them is changed nor locked. A log may grow meanwhile, but
/// must not be moved into the database.
///
/// @throws StoreFault  Full, Io: there is no room for the copy, or a file cannot be read
[[nodiscard]] Integrity integrity_of(const std::string& database, const std::string& scratch);

/// What STATE/database-state says of a database that was closed in order: each of its bytes is
/// known, and there is no log. Empty: the file cannot be read.
[[nodiscard]] std::string clean_mark(const std::string& database);
inline constexpr std::string_view kCleanMark = "clean ";  ///< how it begins

}  // namespace popcut::daemon
