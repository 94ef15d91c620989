// SPDX-License-Identifier: MIT
#include "daemon/store/database.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

// The names between the brackets of "table(one, two)", or of "one, two".
std::vector<std::string_view> names_in(std::string_view list) {
  const std::size_t open = list.find('(');
  if (open != std::string_view::npos) list = list.substr(open + 1, list.rfind(')') - open - 1);
  std::vector<std::string_view> names;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view name = list.substr(0, comma);
    name.remove_prefix(std::min(name.find_first_not_of(' '), name.size()));
    names.push_back(name);
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return names;
}

}  // namespace

std::string Database::insertion(std::string_view into, std::size_t values) {
  std::string sql = fmt::format("INSERT INTO {} VALUES(?", into);
  for (std::size_t at = 1; at < values; ++at) sql += ", ?";
  return sql + ")";
}

int Database::insert_list(std::string_view into, std::span<const Bound> values) {
  return run_list(insertion(into, values.size()), values);
}

int Database::put_list(std::string_view into, std::string_view keys,
                       std::span<const Bound> values) {
  const std::vector<std::string_view> key_names = names_in(keys);
  std::string sets;
  for (const std::string_view name : names_in(into))
    if (std::find(key_names.begin(), key_names.end(), name) == key_names.end())
      sets += fmt::format("{}{}=excluded.{}", sets.empty() ? "" : ", ", name, name);
  return run_list(fmt::format("{} ON CONFLICT({}) DO {}{}", insertion(into, values.size()), keys,
                              sets.empty() ? "NOTHING" : "UPDATE SET ", sets),
                  values);
}

Transaction::Transaction(Database& database)
    : database_(database), outermost_(!database.in_transaction()) {
  database_.run(outermost_ ? database_.begin_words() : "SAVEPOINT part");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    if (outermost_) {
      // A failed commit may have rolled back already.
      if (database_.in_transaction()) database_.run("ROLLBACK");
    } else if (database_.in_transaction()) {
      database_.run("ROLLBACK TO part");
      database_.run("RELEASE part");
    }
  } catch (const StoreFault&) {
    // Nothing more can be undone; the next BEGIN says so.
  }
}

void Transaction::commit() {
  if (!outermost_) {
    database_.run("RELEASE part");
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
