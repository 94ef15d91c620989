// SPDX-License-Identifier: MIT
#include "daemon/store/ownership_table.hpp"

#include <array>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

std::string_view word_of(Owned kind) {
  constexpr std::array<std::string_view, 4> kWords{"asset", "design", "plan", "search"};
  return kWords.at(static_cast<std::size_t>(kind));
}

OwnershipTable::Row row_of(const Rows& rows) {
  OwnershipTable::Row row;
  rows.read(0, std::tie(row.owner, row.name, row.created));
  return row;
}

}  // namespace

void OwnershipTable::hold(Owned kind, std::string_view id) {
  db_.hold(fmt::format("owners of {} {}", word_of(kind), id));
}

bool OwnershipTable::add(Owned kind, std::string_view id, const Row& row) {
  if (has(kind, id, row.owner)) return false;
  db_.insert("ownership(kind, id, owner, name, created)", word_of(kind), id, row.owner, row.name,
             row.created);
  return true;
}

std::optional<OwnershipTable::Row> OwnershipTable::of(Owned kind, std::string_view id,
                                                      std::string_view owner) {
  return first_of(
      db_.rows("SELECT owner, name, created FROM ownership WHERE kind=? AND id=? AND owner=?",
               word_of(kind), id, owner),
      row_of);
}

std::optional<OwnershipTable::Row> OwnershipTable::first(Owned kind, std::string_view id) {
  return first_of(db_.rows("SELECT owner, name, created FROM ownership WHERE kind=? AND id=? "
                           "ORDER BY created, owner LIMIT 1",
                           word_of(kind), id),
                  row_of);
}

void OwnershipTable::remove(Owned kind, std::string_view id, std::string_view owner) {
  db_.run("DELETE FROM ownership WHERE kind=? AND id=? AND owner=?", word_of(kind), id, owner);
}

void OwnershipTable::remove_all(Owned kind, std::string_view id) {
  db_.run("DELETE FROM ownership WHERE kind=? AND id=?", word_of(kind), id);
}

}  // namespace popcut::daemon
