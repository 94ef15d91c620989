// SPDX-License-Identifier: MIT
#include "daemon/store/database.hpp"

#include <chrono>
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

int bind(sqlite3_stmt* statement, int at, std::string_view text) {
  // An empty view may have no address, which SQLite would take for NULL.
  const char* const data = text.data() == nullptr ? "" : text.data();
  return sqlite3_bind_text64(statement, at, data, text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
}

}  // namespace

struct Database::Kept {
  struct One {
    sqlite3_stmt* statement{};
    bool busy{false};
  };
  // By the text's own copy in the statement.
  std::unordered_map<std::string_view, One> statements;
};

Rows::Rows(sqlite3* db, sqlite3_stmt* statement, bool* busy, std::span<const Bound> values)
    : db_(db), statement_(statement), busy_(busy) {
  if (busy_ != nullptr) *busy_ = true;
  int at = 0;
  for (const Bound& value : values) {
    ++at;
    int code = SQLITE_OK;
    switch (value.kind_) {
      case Bound::Kind::Null:
        code = sqlite3_bind_null(statement_, at);
        break;
      case Bound::Kind::Integer:
        code = sqlite3_bind_int64(statement_, at, value.integer_);
        break;
      case Bound::Kind::Real:
        code = sqlite3_bind_double(statement_, at, value.real_);
        break;
      case Bound::Kind::Text:
        code = bind(statement_, at, value.text_);
        break;
    }
    if (code == SQLITE_OK) continue;
    const std::string sql = sqlite3_sql(statement_);
    put_back();
    raise(db_, code, sql);
  }
}

Rows::~Rows() { put_back(); }

Rows::Rows(Rows&& other) noexcept
    : db_(other.db_),
      statement_(std::exchange(other.statement_, nullptr)),
      busy_(std::exchange(other.busy_, nullptr)) {}

void Rows::put_back() {
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

bool Rows::next() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) raise(db_, code, sqlite3_sql(statement_));
  return false;
}

bool Rows::null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
std::int64_t Rows::integer(int column) const { return sqlite3_column_int64(statement_, column); }
double Rows::real(int column) const { return sqlite3_column_double(statement_, column); }
std::optional<std::int64_t> Rows::maybe_integer(int column) const {
  return null(column) ? std::nullopt : std::optional(integer(column));
}

std::string Rows::text(int column) const {
  const unsigned char* const bytes = sqlite3_column_text(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  if (bytes == nullptr) return {};
  return {bytes, bytes + size};
}

Bound Rows::value(int column) const {
  switch (sqlite3_column_type(statement_, column)) {
    case SQLITE_INTEGER:
      return {integer(column)};
    case SQLITE_FLOAT:
      return {real(column)};
    case SQLITE_NULL:
      return {nullptr};
    default:
      break;
  }
  const unsigned char* const bytes = sqlite3_column_text(statement_, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return {std::string_view(reinterpret_cast<const char*>(bytes), bytes == nullptr ? 0 : size)};
}

Database::Database(const Options& options) : kept_(std::make_unique<Kept>()) {
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
          static_cast<Database*>(self)->wal_pages_ = pages;
          return SQLITE_OK;
        },
        this);
  } catch (...) {
    kept_.reset();
    sqlite3_close_v2(db_);
    throw;
  }
}

Database::~Database() {
  for (const auto& [text, one] : kept_->statements) sqlite3_finalize(one.statement);
  sqlite3_close_v2(db_);
}

sqlite3_stmt* Database::prepare(std::string_view sql, bool kept) {
  sqlite3_stmt* statement = nullptr;
  check(db_,
        sqlite3_prepare_v3(db_, sql.data(), static_cast<int>(sql.size()),
                           kept ? SQLITE_PREPARE_PERSISTENT : 0, &statement, nullptr),
        sql);
  return statement;
}

Rows Database::rows_list(std::string_view sql, std::span<const Bound> values) {
  const auto found = kept_->statements.find(sql);
  if (found == kept_->statements.end()) {
    sqlite3_stmt* const statement = prepare(sql, true);
    Kept::One& one = kept_->statements[sqlite3_sql(statement)];
    one.statement = statement;
    return {db_, statement, &one.busy, values};
  }
  // Its rows are being read further up.
  if (found->second.busy) return {db_, prepare(sql, false), nullptr, values};
  return {db_, found->second.statement, &found->second.busy, values};
}

int Database::run_list(std::string_view sql, std::span<const Bound> values) {
  Rows none = rows_list(sql, values);
  while (none.next()) continue;
  return sqlite3_changes(db_);
}

int Database::insert_list(std::string_view into, std::span<const Bound> values) {
  std::string sql = std::string(into) + " VALUES(?";
  for (std::size_t at = 1; at < values.size(); ++at) sql += ", ?";
  return run_list(sql + ")", values);
}

void Database::script(const std::string& sql) {
  check(db_, sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr), sql);
}

void Database::forget_pages() { sqlite3_db_release_memory(db_); }

bool Database::in_transaction() const { return sqlite3_get_autocommit(db_) == 0; }

bool Database::checkpoint(bool to_zero) {
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

Transaction::Transaction(Database& database)
    : database_(database), outermost_(!database.in_transaction()) {
  database_.run(outermost_ ? "BEGIN IMMEDIATE" : "SAVEPOINT inner");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    if (outermost_) {
      // A failed commit may have rolled back already.
      if (database_.in_transaction()) database_.run("ROLLBACK");
    } else if (database_.in_transaction()) {
      database_.run("ROLLBACK TO inner");
      database_.run("RELEASE inner");
    }
  } catch (const StoreFault&) {
    // Nothing more can be undone; the next BEGIN says so.
  }
}

void Transaction::commit() {
  if (!outermost_) {
    database_.run("RELEASE inner");
    open_ = false;
    return;
  }
  const auto begun = std::chrono::steady_clock::now();
  database_.run("COMMIT");
  open_ = false;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  if (database_.committed) database_.committed(took.count());
}

}  // namespace popcut::daemon
