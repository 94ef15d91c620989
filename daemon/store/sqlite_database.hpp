// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/store/database.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace popcut::daemon {

/// The one connection to an SQLite file. Exclusive, WAL, synchronous FULL.
class SqliteDatabase final : public Database {
 public:
  struct Options {
    std::string path;
    std::string vfs{};         ///< empty: the system's
    bool create{true};         ///< false: the file must be there
    bool exclusive_wal{true};  ///< false: for a copy that is only read (salvage)
  };
  /// @throws StoreFault  if it cannot be opened or is no database
  explicit SqliteDatabase(const Options& options);
  ~SqliteDatabase() override;

  int run_list(std::string_view sql, std::span<const Bound> values) override;
  [[nodiscard]] Rows rows_list(std::string_view sql, std::span<const Bound> values) override;
  void hold(std::string_view) override {}
  void script(const std::string& sql) override;
  [[nodiscard]] bool in_transaction() const override;
  [[nodiscard]] bool is_shared() const override { return false; }

  /// Gives back the memory of the pages that were read.
  void forget_pages();
  /// Pages in the write-ahead log after the last commit.
  [[nodiscard]] int wal_pages() const { return wal_pages_; }
  /// Moves what it can of the log into the file; true: all of it. `to_zero` empties the log.
  bool checkpoint(bool to_zero);

 private:
  friend class SlicedCopy;
  [[nodiscard]] std::string_view begin_words() const override { return "BEGIN IMMEDIATE"; }
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;
  Statement prepare(std::string_view sql, bool kept);
  struct Kept;
  sqlite3* db_{};
  std::unique_ptr<Kept> kept_;
  int wal_pages_{0};
};

}  // namespace popcut::daemon
