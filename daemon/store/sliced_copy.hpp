// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "daemon/store/sqlite_database.hpp"

struct sqlite3_backup;

namespace popcut::daemon {

/// Copies a database page by page, in steps between which it may be read and changed: the copy is
/// that of the moment of the last step. (SQLite applies what changes meanwhile through the same
/// connection to both.)
class SlicedCopy {
 public:
  /// Begins a copy at `path`, which must not exist.
  ///
  /// @throws StoreFault
  SlicedCopy(SqliteDatabase& from, const std::string& path);
  ~SlicedCopy();
  SlicedCopy(const SlicedCopy&) = delete;
  SlicedCopy& operator=(const SlicedCopy&) = delete;

  /// Copies as many pages more. True: the copy is whole, and closed. Outside of a transaction.
  ///
  /// @throws StoreFault
  [[nodiscard]] bool step(int pages);

 private:
  void close();
  sqlite3* to_{};
  sqlite3_backup* backup_{};
};

/// Puts a whole copy into the mode in which popcutd keeps its database, so that it can be put in
/// its place. On any thread.
///
/// @throws StoreFault
void finish_copy(const std::string& path);

/// "ok", or what is wrong in the copy, a line each; the whole of it is read. On any thread.
///
/// @throws StoreFault
[[nodiscard]] std::string verdict_on_copy(const std::string& path);

}  // namespace popcut::daemon
