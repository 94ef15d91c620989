// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cassert>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "daemon/model/fields.hpp"
#include "daemon/store/database.hpp"

// From a list of fields (daemon/model/fields.hpp) to rows: the columns have the names and the order
// of the list, without what is only shown.

namespace popcut::daemon {

/// Values of columns, to be bound. Texts of the row that they come from are not copied: it lives as
/// long.
class ColumnValues {
 public:
  void put(const std::string& text) { bounds_.emplace_back(text); }
  void put(std::string_view text) { bounds_.emplace_back(text); }
  void put(int value) { bounds_.emplace_back(value); }
  void put(bool value) { bounds_.emplace_back(value); }
  void put(std::int64_t value) { bounds_.emplace_back(value); }
  void put(std::uint64_t value) { bounds_.emplace_back(value); }
  void put(double value) { bounds_.emplace_back(value); }
  void put(const std::optional<std::int64_t>& value) { bounds_.emplace_back(value); }
  void put(const std::array<double, 2>& pair) { put(pair[0]), put(pair[1]); }
  void put(JobState state) { put(name_of(state)); }
  void put(PlanState state) { put(name_of(state)); }
  // Lists and objects are JSON.
  void put(const std::vector<std::string>& texts);
  void put(const std::vector<Warning>& warnings);
  void put(const std::optional<LoadedSheet>& load);
  void put(const std::optional<Handwork>& work);

  [[nodiscard]] std::span<const Bound> all() const { return bounds_; }

 private:
  void put_own(std::string text) { put(texts_.emplace_back(std::move(text))); }
  std::vector<Bound> bounds_;
  std::deque<std::string> texts_;  // a deque, so that what is bound stays where it is
};

/// Takes the columns of a row from `rows`, one after the other.
///
/// @throws StoreFault  Corrupt: a value has another form
class ColumnReader {
 public:
  explicit ColumnReader(const Rows& rows) : rows_(rows) {}
  void take(std::string& text) { text = rows_.text(at_++); }
  void take(int& value) { value = rows_.small(at_++); }
  void take(bool& value) { value = rows_.integer(at_++) != 0; }
  void take(std::int64_t& value) { value = rows_.integer(at_++); }
  void take(std::uint64_t& value) { value = static_cast<std::uint64_t>(rows_.integer(at_++)); }
  void take(double& value) { value = rows_.real(at_++); }
  void take(std::optional<std::int64_t>& value) { value = rows_.maybe_integer(at_++); }
  void take(std::array<double, 2>& pair) { take(pair[0]), take(pair[1]); }
  void take(JobState& state);
  void take(PlanState& state);
  void take(std::vector<std::string>& texts);
  void take(std::vector<Warning>& warnings);
  void take(std::optional<LoadedSheet>& load);
  void take(std::optional<Handwork>& work);

 private:
  const Rows& rows_;
  int at_{0};
};

/// Calls `work(name, member, use)` for each field of `Row` that is stored.
template <typename Row, typename Work>
void each_stored(Work work) {
  list_fields(static_cast<const Row*>(nullptr),
              [&]<typename Member, typename Owner>(std::string_view name, Member Owner::*member,
                                                   FieldUse use = {}) {
                if constexpr (std::is_same_v<Owner, Row>) work(name, member, use);
              });
}

/// "id, rev, state", with what follows each name ("=?").
template <typename Row>
[[nodiscard]] std::string column_names(bool with_fixed = true, std::string_view after_each = "") {
  std::string names;
  each_stored<Row>([&]<typename Member>(std::string_view name, Member Row::*, FieldUse use) {
    if (use.is_fixed && !with_fixed) return;
    constexpr bool is_pair = std::is_same_v<Member, std::array<double, 2>>;
    for (const char* number : {"_1", "_2"}) {
      names.append(names.empty() ? "" : ", ").append(name);
      names.append(is_pair ? number : "").append(after_each);
      if (!is_pair) break;
    }
  });
  return names;
}

/// Where a column stands among `column_names`.
template <typename Row>
[[nodiscard]] int column_at(std::string_view wanted) {
  int at = 0, found = -1;
  each_stored<Row>([&]<typename Member>(std::string_view name, Member Row::*, FieldUse) {
    if (name == wanted) found = at;
    at += std::is_same_v<Member, std::array<double, 2>> ? 2 : 1;
  });
  assert(found >= 0);
  return found;
}

/// The values of `row` in the order of `column_names`.
template <typename Row>
void put_row(ColumnValues& values, const Row& row, bool with_fixed = true) {
  each_stored<Row>([&](std::string_view, auto member, FieldUse use) {
    if (!use.is_fixed || with_fixed) values.put(row.*member);
  });
}

/// A row of `column_names`.
///
/// @throws StoreFault  Corrupt: a value has another form
template <typename Row>
[[nodiscard]] Row read_row(const Rows& rows) {
  Row row;
  ColumnReader reader(rows);
  each_stored<Row>([&](std::string_view, auto member, FieldUse) { reader.take(row.*member); });
  return row;
}

}  // namespace popcut::daemon
