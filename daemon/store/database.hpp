// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace popcut::daemon {

/// What kept the database from doing something.
enum class FaultKind : std::uint8_t {
  Full,        ///< no space left: rolled back, sound, works again once there is space
  Io,          ///< a read, write or fsync failed: what is on the disk is no longer known
  Busy,        ///< no file descriptor left: nothing was begun
  Corrupt,     ///< the file is no database, or a damaged one
  Constraint,  ///< a rule of the schema said no
  Other,       ///< out of memory, misuse
};

/// Thrown by statements; caught where a transaction ends.
class StoreFault : public std::runtime_error {
 public:
  StoreFault(FaultKind kind, const std::string& detail) : std::runtime_error(detail), kind_(kind) {}
  [[nodiscard]] FaultKind kind() const { return kind_; }

 private:
  FaultKind kind_;
};

/// One value for a parameter of a statement.
class Bound {
 public:
  enum class Kind : std::uint8_t { Null, Integer, Real, Text };
  Bound(std::nullptr_t) {}                                                 // NOLINT
  Bound(std::int64_t value) : kind_(Kind::Integer), integer_(value) {}     // NOLINT
  Bound(int value) : Bound(static_cast<std::int64_t>(value)) {}            // NOLINT
  Bound(bool value) : Bound(static_cast<std::int64_t>(value)) {}           // NOLINT
  Bound(std::uint64_t value) : Bound(static_cast<std::int64_t>(value)) {}  // NOLINT
  Bound(double value) : kind_(Kind::Real), real_(value) {}                 // NOLINT
  Bound(std::string_view value) : kind_(Kind::Text), text_(value) {}       // NOLINT
  Bound(const std::string& value) : Bound(std::string_view(value)) {}      // NOLINT
  Bound(const char* value) : Bound(std::string_view(value)) {}             // NOLINT
  Bound(const std::optional<std::int64_t>& value)                          // NOLINT
      : kind_(value ? Kind::Integer : Kind::Null), integer_(value.value_or(0)) {}

 private:
  friend class Rows;
  Kind kind_{Kind::Null};
  std::int64_t integer_{};
  double real_{};
  std::string_view text_;
};

/// The rows of one run of a statement. The columns are those of the row `next` went to.
class Rows {
 public:
  ~Rows();
  Rows(Rows&& other) noexcept;
  Rows& operator=(Rows&&) = delete;

  /// Goes to the next row; false after the last.
  bool next();
  [[nodiscard]] bool null(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::optional<std::int64_t> maybe_integer(int column) const;
  /// The value as it is, to be bound elsewhere before `next`.
  [[nodiscard]] Bound value(int column) const;
  [[nodiscard]] int small(int column) const { return static_cast<int>(integer(column)); }
  /// Reads the columns from `column` on, each into a variable of its type.
  template <typename... Values>
  void read(int column, const std::tuple<Values&...>& values) const {
    std::apply([&](Values&... each) { (read_one(column++, each), ...); }, values);
  }

 private:
  friend class Database;
  template <typename Value>
  void read_one(int column, Value& value) const {
    if constexpr (std::is_same_v<Value, std::string>)
      value = text(column);
    else if constexpr (std::is_same_v<Value, double>)
      value = real(column);
    else if constexpr (std::is_same_v<Value, std::optional<std::int64_t>>)
      value = maybe_integer(column);
    else if constexpr (std::is_same_v<Value, bool>)
      value = integer(column) != 0;
    else
      value = static_cast<Value>(integer(column));
  }
  Rows(sqlite3* db, sqlite3_stmt* statement, bool* busy, std::span<const Bound> values);
  void put_back();
  sqlite3* db_;
  sqlite3_stmt* statement_;
  bool* busy_;  ///< of the kept statement; nullptr: ours, to be finalised
};

/// Every row, as `one` reads it.
template <typename One>
[[nodiscard]] auto all_of(Rows rows, One one) {
  std::vector<decltype(one(rows))> all;
  while (rows.next()) all.push_back(one(rows));
  return all;
}

/// The first row, as `one` reads it.
template <typename One>
[[nodiscard]] auto first_of(Rows rows, One one) {
  std::optional<decltype(one(rows))> first;
  if (rows.next()) first = one(rows);
  return first;
}

[[nodiscard]] inline std::string first_text(const Rows& rows) { return rows.text(0); }

/// The one connection to an SQLite file. Exclusive, WAL, synchronous FULL. Not for two threads.
class Database {
 public:
  struct Options {
    std::string path;
    std::string vfs{};         ///< empty: the system's
    bool create{true};         ///< false: the file must be there
    bool exclusive_wal{true};  ///< false: for a copy that is only read (salvage)
  };
  /// @throws StoreFault  if it cannot be opened or is no database
  explicit Database(const Options& options);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Runs a statement that gives no rows; returns how many rows it changed. Statements are prepared
  /// once and kept by their text.
  template <typename... Values>
  int run(std::string_view sql, const Values&... values) {
    return run_list(sql, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  template <typename... Values>
  [[nodiscard]] Rows rows(std::string_view sql, const Values&... values) {
    return rows_list(sql, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  /// Puts one row: `into` is "INSERT INTO table(columns)", with a value for each of the columns.
  template <typename... Values>
  int insert(std::string_view into, const Values&... values) {
    return insert_list(into, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  template <typename... Values>
  int insert(std::string_view into, const std::tuple<Values...>& values) {
    return std::apply([&](const auto&... each) { return insert(into, each...); }, values);
  }
  int run_list(std::string_view sql, std::span<const Bound> values);
  int insert_list(std::string_view into, std::span<const Bound> values);
  [[nodiscard]] Rows rows_list(std::string_view sql, std::span<const Bound> values);
  /// The first column of the first row as a number; 0 without a row.
  template <typename... Values>
  [[nodiscard]] std::int64_t number(std::string_view sql, const Values&... values) {
    Rows found = rows(sql, values...);
    return found.next() ? found.integer(0) : 0;
  }
  /// Several statements without parameters, not kept.
  void script(const std::string& sql);

  /// Gives back the memory of the pages that were read.
  void forget_pages();
  [[nodiscard]] bool in_transaction() const;
  /// Pages in the write-ahead log after the last commit.
  [[nodiscard]] int wal_pages() const { return wal_pages_; }
  /// Moves what it can of the log into the file; true: all of it. `to_zero` empties the log.
  bool checkpoint(bool to_zero);
  /// Called after each commit with the seconds that it took.
  std::function<void(double seconds)> committed{};

 private:
  friend class Transaction;
  friend class SlicedCopy;
  sqlite3_stmt* prepare(std::string_view sql, bool kept);
  struct Kept;
  sqlite3* db_{};
  std::unique_ptr<Kept> kept_;
  int wal_pages_{0};
};

/// All or nothing: rolled back unless committed. Inside another one it is a savepoint of that.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();
  [[nodiscard]] bool outermost() const { return outermost_; }

 private:
  Database& database_;
  bool outermost_;
  bool open_{true};
};

}  // namespace popcut::daemon
