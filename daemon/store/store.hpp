// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "daemon/files/shared_files.hpp"
#include "daemon/store/sqlite_database.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {

struct StoreOptions {
  std::string folder;                     ///< STATE
  std::uint64_t reserve_bytes{4u << 20};  ///< kept free for the last records of a full disk
  std::string vfs{};                      ///< of SQLite; tests
  /// Leaves what takes long after a kill, SQLite's check of all pages, to `damage_at_rest`.
  bool check_later{false};
};

/// popcutd's memory: STATE/popcut.db and the files beside it, held by this process alone.
class Store {
 public:
  /// Takes the lock, checks the database and takes the reserve.
  ///
  /// A damaged database is never used, nor changed: a copy is set aside in STATE/backups, and the
  /// original stays where it is.
  ///
  /// @retval Refused      another process has the folder
  /// @retval Unwritable   the folder cannot be read or written
  /// @retval Malformed    the database is damaged: `popcut db salvage`
  /// @retval OutOfRange   another version of popcutd wrote it (`kSchemaVersion`)
  /// @retval CheckFailed  the database belongs to another user
  [[nodiscard]] static Result<std::unique_ptr<Store>> open(StoreOptions options);
  /// With the tables in a database that others use too; the folder holds the files beside them, and
  /// what only this popcutd knows.
  ///
  /// @retval Refused, Unwritable  as above
  [[nodiscard]] static Result<std::unique_ptr<Store>> over(StoreOptions options,
                                                           std::unique_ptr<Database> shared);
  /// Moves the log into the database, unless the disk failed or the database was not checked.
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  [[nodiscard]] Database& database() { return *database_; }
  /// The file with the tables; nullptr: they are in a shared database.
  [[nodiscard]] SqliteDatabase* file() { return file_; }
  [[nodiscard]] StateFolder& folder() { return *folder_; }
  [[nodiscard]] const StoreOptions& options() const { return options_; }
  /// The files that all nodes of a fleet need; nullptr: this popcutd is alone.
  [[nodiscard]] SharedFiles* files() { return files_.get(); }
  void share_files(std::unique_ptr<SharedFiles> files) { files_ = std::move(files); }
  /// Says that an unclean end may leave a log that must not be missing. After the first commit.
  void mark_in_use();
  /// Notes beside the database that this event is committed. Not synced: after a kill it is there,
  /// after a power cut it may be older. A database that knows fewer events has lost some.
  void bear_witness(std::int64_t event);
  /// The disk failed, or the database is damaged: nothing is written any more, not at the end
  /// either.
  void give_up() { failed_ = true; }
  /// Whether all of the database is known to be sound. Until it is nothing may move the log into
  /// it, and no knife may be armed.
  [[nodiscard]] bool checked() const { return checked_; }
  /// SQLite's check of all pages, of a copy: on any thread, while the database is in use. What is
  /// wrong, empty: nothing; no value: there is no room for the copy.
  [[nodiscard]] std::optional<std::string> damage_of_copy() const;
  /// The same of the database itself, on its thread, which waits for it.
  [[nodiscard]] std::string damage_in_place();
  void set_checked() { checked_ = true; }
  /// It was found damaged while in use: the next opening checks it before anything else.
  void mark_suspect() const;
  /// Copies the database aside for a person to inspect, and gives the message: what is wrong,
  /// where the copy is, and what to do.
  [[nodiscard]] std::string set_aside_as(const std::string& what) const;

 private:
  Store(StoreOptions options, std::unique_ptr<StateFolder> folder)
      : options_(std::move(options)), folder_(std::move(folder)) {}
  [[nodiscard]] std::int64_t witnessed() const;
  StoreOptions options_;
  std::unique_ptr<StateFolder> folder_;
  std::unique_ptr<Database> database_;
  SqliteDatabase* file_{};
  std::unique_ptr<SharedFiles> files_{};
  bool failed_{false};
  bool checked_{false}, in_use_{false};
  int witness_{-1};
};

/// Copies the database by VACUUM INTO to STATE/backups/NAME.
///
/// @throws StoreFault  if it cannot be read, or there is no room
[[nodiscard]] std::string back_up(Database& database, const StateFolder& folder,
                                  const std::string& name);

}  // namespace popcut::daemon
