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

namespace popcut::daemon {

/// What kept the database from doing something.
enum class FaultKind : std::uint8_t {
  Full,        ///< no space left: rolled back, sound, works again once there is space
  Io,          ///< a read, write or fsync failed: what is on the disk is no longer known
  Busy,        ///< no file descriptor left: nothing was begun
  Corrupt,     ///< the file is no database, or a damaged one
  Constraint,  ///< a rule of the schema said no
  Away,        ///< the server does not answer: nothing was committed
  Again,       ///< somebody else was quicker: rolled back, and may be tried once more
  InDoubt,     ///< the server went away during the commit: it is done, or not
  Refused,     ///< a rule of the fleet says no, in words for people
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

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] std::int64_t integer() const { return integer_; }
  [[nodiscard]] double real() const { return real_; }
  [[nodiscard]] std::string_view text() const { return text_; }

 private:
  Kind kind_{Kind::Null};
  std::int64_t integer_{};
  double real_{};
  std::string_view text_;
};

/// Where rows come from: one run of a statement.
class RowSource {
 public:
  virtual ~RowSource() = default;
  virtual bool next() = 0;
  [[nodiscard]] virtual bool null(int column) const = 0;
  [[nodiscard]] virtual std::int64_t integer(int column) const = 0;
  [[nodiscard]] virtual double real(int column) const = 0;
  [[nodiscard]] virtual std::string_view text(int column) const = 0;
  /// The value as it is, to be bound elsewhere before `next`.
  [[nodiscard]] virtual Bound value(int column) const = 0;
};

/// The rows of one run of a statement. The columns are those of the row `next` went to.
class Rows {
 public:
  explicit Rows(std::unique_ptr<RowSource> source) : source_(std::move(source)) {}

  /// Goes to the next row; false after the last.
  bool next() { return source_->next(); }
  [[nodiscard]] bool null(int column) const { return source_->null(column); }
  /// 0 where there is none.
  [[nodiscard]] std::int64_t integer(int column) const { return source_->integer(column); }
  [[nodiscard]] double real(int column) const { return source_->real(column); }
  [[nodiscard]] std::string text(int column) const { return std::string(source_->text(column)); }
  [[nodiscard]] std::optional<std::int64_t> maybe_integer(int column) const {
    return null(column) ? std::nullopt : std::optional(integer(column));
  }
  /// The value as it is, to be bound elsewhere before `next`.
  [[nodiscard]] Bound value(int column) const { return source_->value(column); }
  [[nodiscard]] int small(int column) const { return static_cast<int>(integer(column)); }
  /// Reads the columns from `column` on, each into a variable of its type.
  template <typename... Values>
  void read(int column, const std::tuple<Values&...>& values) const {
    std::apply([&](Values&... each) { (read_one(column++, each), ...); }, values);
  }

 private:
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
  std::unique_ptr<RowSource> source_;
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

/// Where the service's tables are: an SQLite file of popcutd's own, or a PostgreSQL that a fleet
/// shares. Statements are in the SQL that both understand, with `?` or `?1` for parameters. Not for
/// two threads.
class Database {
 public:
  Database() = default;
  virtual ~Database() = default;
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Runs a statement that gives no rows; returns how many rows it changed. Statements are prepared
  /// once and kept by their text.
  template <typename... Values>
  int run(std::string_view sql, const Values&... values) {
    return run_list(sql, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  /// As `run`, in a transaction, for a statement whose outcome decides nothing there: it may run as
  /// late as the next one that is not for later, or the commit, which then throws its fault. A
  /// shared database is further away than a file: what goes there together costs one way.
  template <typename... Values>
  void later(std::string_view sql, const Values&... values) {
    later_list(sql, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  /// As `insert`, like `later`.
  template <typename... Values>
  void insert_later(std::string_view into, const Values&... values) {
    const std::array<Bound, sizeof...(Values)> all{Bound(values)...};
    later_list(insertion(into, all.size()), all);
  }
  template <typename... Values>
  [[nodiscard]] Rows rows(std::string_view sql, const Values&... values) {
    return rows_list(sql, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  /// Puts one row: `into` is "table(columns)", with a value for each of the columns.
  template <typename... Values>
  int insert(std::string_view into, const Values&... values) {
    return insert_list(into, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  template <typename... Values>
  int insert(std::string_view into, const std::tuple<Values...>& values) {
    return std::apply([&](const auto&... each) { return insert(into, each...); }, values);
  }
  /// As `insert`; a row with the same `keys`, which are columns, gets the other values.
  template <typename... Values>
  int put(std::string_view into, std::string_view keys, const Values&... values) {
    return put_list(into, keys, std::array<Bound, sizeof...(Values)>{Bound(values)...});
  }
  /// Waits until no other transaction holds this name; it is held to the end of this one. In a
  /// database that is not shared there is nobody to wait for.
  virtual void hold(std::string_view name) = 0;
  virtual int run_list(std::string_view sql, std::span<const Bound> values) = 0;
  virtual void later_list(std::string_view sql, std::span<const Bound> values) {
    run_list(sql, values);
  }
  [[nodiscard]] virtual Rows rows_list(std::string_view sql, std::span<const Bound> values) = 0;
  int insert_list(std::string_view into, std::span<const Bound> values);
  int put_list(std::string_view into, std::string_view keys, std::span<const Bound> values);
  /// The first column of the first row as a number; 0 without a row.
  template <typename... Values>
  [[nodiscard]] std::int64_t number(std::string_view sql, const Values&... values) {
    Rows found = rows(sql, values...);
    return found.next() ? found.integer(0) : 0;
  }
  /// Several statements without parameters, not kept.
  virtual void script(const std::string& sql) = 0;
  [[nodiscard]] virtual bool in_transaction() const = 0;
  /// Whether others write to it, too: then who may cut is decided by its functions (daemon/fleet).
  [[nodiscard]] virtual bool is_shared() const = 0;
  /// Called after each commit with the seconds that it took.
  std::function<void(double seconds)> committed{};

 private:
  friend class Transaction;
  [[nodiscard]] static std::string insertion(std::string_view into, std::size_t values);
  /// How a transaction that will write begins.
  [[nodiscard]] virtual std::string_view begin_words() const = 0;
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
