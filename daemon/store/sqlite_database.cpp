// SPDX-License-Identifier: MIT
#include "daemon/store/sqlite_database.hpp"

#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <sqlite3.h>

namespace popcut::daemon {
namespace {

FaultKind kind_of(int code) {
  switch (code & 0xFF) {
    case SQLITE_FULL:
      return FaultKind::Full;
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_BUSY:
      return FaultKind::Io;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_MISMATCH:
      return FaultKind::Corrupt;
    case SQLITE_CONSTRAINT:
      return FaultKind::Constraint;
    default:
      return FaultKind::Other;
  }
}

[[noreturn]] void raise(sqlite3* db, int code, std::string_view doing) {
  const char* const words = db != nullptr ? sqlite3_errmsg(db) : sqlite3_errstr(code);
  throw StoreFault(kind_of(code),
                   fmt::format("{}: {} (SQLite {})", doing, words, sqlite3_errstr(code)));
}

void check(sqlite3* db, int code, std::string_view doing) {
  if (code != SQLITE_OK) raise(db, code, doing);
}

int bind(sqlite3_stmt* statement, int at, const Bound& value) {
  switch (value.kind()) {
    case Bound::Kind::Null:
      break;
    case Bound::Kind::Integer:
      return sqlite3_bind_int64(statement, at, value.integer());
    case Bound::Kind::Real:
      return sqlite3_bind_double(statement, at, value.real());
    case Bound::Kind::Text: {
      // An empty view may have no address, which SQLite would take for NULL.
      const std::string_view text = value.text();
      return sqlite3_bind_text64(statement, at, text.data() == nullptr ? "" : text.data(),
                                 text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
    }
  }
  return sqlite3_bind_null(statement, at);
}

/// A statement while its rows are read.
class SqliteRows final : public RowSource {
 public:
  /// @param busy  of the kept statement; nullptr: it is ours, to be finalised
  SqliteRows(sqlite3* db, sqlite3_stmt* statement, bool* busy)
      : db_(db), statement_(statement), busy_(busy) {
    if (busy_ != nullptr) *busy_ = true;
  }
  ~SqliteRows() override { put_back(); }
  SqliteRows(const SqliteRows&) = delete;
  SqliteRows& operator=(const SqliteRows&) = delete;

  void take(std::span<const Bound> values) {
    int at = 0;
    for (const Bound& value : values) {
      const int code = bind(statement_, ++at, value);
      if (code != SQLITE_OK) raise(db_, code, sqlite3_sql(statement_));
    }
  }

  bool next() override {
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) raise(db_, code, sqlite3_sql(statement_));
    return false;
  }
  [[nodiscard]] bool null(int column) const override {
    return sqlite3_column_type(statement_, column) == SQLITE_NULL;
  }
  [[nodiscard]] std::int64_t integer(int column) const override {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] double real(int column) const override {
    return sqlite3_column_double(statement_, column);
  }
  [[nodiscard]] std::string_view text(int column) const override {
    const unsigned char* const bytes = sqlite3_column_text(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return {reinterpret_cast<const char*>(bytes), bytes == nullptr ? 0 : size};
  }
  [[nodiscard]] Bound value(int column) const override {
    switch (sqlite3_column_type(statement_, column)) {
      case SQLITE_INTEGER:
        return {integer(column)};
      case SQLITE_FLOAT:
        return {real(column)};
      case SQLITE_NULL:
        return {nullptr};
      default:
        return {text(column)};
    }
  }

 private:
  void put_back() {
    if (statement_ == nullptr) return;
    if (busy_ == nullptr) {
      sqlite3_finalize(statement_);
    } else {
      sqlite3_reset(statement_);
      sqlite3_clear_bindings(statement_);
      *busy_ = false;
    }
    statement_ = nullptr;
  }
  sqlite3* db_;
  sqlite3_stmt* statement_;
  bool* busy_;
};

}  // namespace

struct SqliteDatabase::Kept {
  struct One {
    Statement statement;
    bool busy{false};
  };
  // By the text's own copy in the statement.
  std::unordered_map<std::string_view, One> statements;
};

SqliteDatabase::SqliteDatabase(const Options& options) : kept_(std::make_unique<Kept>()) {
  const int flags = SQLITE_OPEN_READWRITE | (options.create ? SQLITE_OPEN_CREATE : 0) |
                    SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE | SQLITE_OPEN_EXRESCODE;
  const int code = sqlite3_open_v2(options.path.c_str(), &db_, flags,
                                   options.vfs.empty() ? nullptr : options.vfs.c_str());
  try {
    check(db_, code, options.path);
    sqlite3_limit(db_, SQLITE_LIMIT_LENGTH, 16 << 20);
    sqlite3_db_config(db_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(db_, SQLITE_DBCONFIG_DQS_DML, 0, nullptr);
    sqlite3_db_config(db_, SQLITE_DBCONFIG_DQS_DDL, 0, nullptr);
    // The log is moved into the file by `checkpoint`, where a failing fsync is seen, and kept for
    // the next opening to find.
    sqlite3_db_config(db_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    // One connection, so no shared memory: the log's index is in the heap. And none can join, which
    // SQLite before 3.51.3 needs (its WAL-reset bug takes two writers). This comes before anything
    // is read.
    if (options.exclusive_wal) script("PRAGMA locking_mode=EXCLUSIVE;");
    script(
        "PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON; PRAGMA mmap_size=0;"
        "PRAGMA temp_store=MEMORY; PRAGMA foreign_keys=ON; PRAGMA cache_size=-2000;");
    if (!options.exclusive_wal) return;
    script("PRAGMA synchronous=FULL;");
    Rows mode = rows("PRAGMA journal_mode=WAL");
    if (!mode.next() || mode.text(0) != "wal")
      throw StoreFault(FaultKind::Io, options.path + ": SQLite cannot use a write-ahead log here");
    script("PRAGMA wal_autocheckpoint=0; PRAGMA journal_size_limit=16777216;");
    sqlite3_wal_hook(
        db_,
        [](void* self, sqlite3*, const char*, int pages) {
          static_cast<SqliteDatabase*>(self)->wal_pages_ = pages;
          return SQLITE_OK;
        },
        this);
  } catch (...) {
    kept_.reset();
    sqlite3_close_v2(db_);
    throw;
  }
}

SqliteDatabase::~SqliteDatabase() {
  kept_.reset();
  sqlite3_close_v2(db_);
}

void SqliteDatabase::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

SqliteDatabase::Statement SqliteDatabase::prepare(std::string_view sql, bool kept) {
  sqlite3_stmt* statement = nullptr;
  check(db_,
        sqlite3_prepare_v3(db_, sql.data(), static_cast<int>(sql.size()),
                           kept ? SQLITE_PREPARE_PERSISTENT : 0, &statement, nullptr),
        sql);
  return Statement(statement);
}

Rows SqliteDatabase::rows_list(std::string_view sql, std::span<const Bound> values) {
  auto found = kept_->statements.find(sql);
  if (found == kept_->statements.end()) {
    Statement statement = prepare(sql, true);
    found = kept_->statements.try_emplace(sqlite3_sql(statement.get())).first;
    found->second.statement = std::move(statement);
  }
  Kept::One& one = found->second;
  std::unique_ptr<SqliteRows> rows;
  if (!one.busy) {
    rows = std::make_unique<SqliteRows>(db_, one.statement.get(), &one.busy);
  } else {  // its rows are being read further up
    Statement own = prepare(sql, false);
    rows = std::make_unique<SqliteRows>(db_, own.get(), nullptr);
    static_cast<void>(own.release());
  }
  rows->take(values);
  return Rows(std::move(rows));
}

int SqliteDatabase::run_list(std::string_view sql, std::span<const Bound> values) {
  Rows none = rows_list(sql, values);
  while (none.next()) continue;
  return sqlite3_changes(db_);
}

void SqliteDatabase::script(const std::string& sql) {
  check(db_, sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr), sql);
}

void SqliteDatabase::forget_pages() { sqlite3_db_release_memory(db_); }

bool SqliteDatabase::in_transaction() const { return sqlite3_get_autocommit(db_) == 0; }

bool SqliteDatabase::checkpoint(bool to_zero) {
  int log = 0;
  int moved = 0;
  check(db_,
        sqlite3_wal_checkpoint_v2(db_, nullptr,
                                  to_zero ? SQLITE_CHECKPOINT_TRUNCATE : SQLITE_CHECKPOINT_PASSIVE,
                                  &log, &moved),
        "checkpoint");
  if (log == moved) wal_pages_ = 0;
  return log == moved;
}

}  // namespace popcut::daemon
