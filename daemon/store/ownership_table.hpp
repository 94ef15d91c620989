// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/model/model.hpp"
#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// What people own: each who uploads the bytes, or asks for the result, is an owner.
enum class Owned : std::uint8_t { Asset, Design, Plan, Search };

/// The statements over `ownership`. All throw StoreFault; call those that change it in a
/// transaction and after `hold`, so that in a fleet nobody becomes an owner of what another node
/// removes.
class OwnershipTable {
 public:
  explicit OwnershipTable(Database& database) : db_(database) {}

  struct Row {
    std::string owner, name;
    TimeMs created{};
  };
  /// Waits until no other transaction changes the owners of this thing.
  void hold(Owned kind, std::string_view id);
  /// False: `row.owner` owns it already, and nothing changes.
  bool add(Owned kind, std::string_view id, const Row& row);
  [[nodiscard]] std::optional<Row> of(Owned kind, std::string_view id, std::string_view owner);
  [[nodiscard]] bool has(Owned kind, std::string_view id, std::string_view owner) {
    return of(kind, id, owner).has_value();
  }
  /// The owner since the longest time; nothing if nobody owns it.
  [[nodiscard]] std::optional<Row> first(Owned kind, std::string_view id);
  void remove(Owned kind, std::string_view id, std::string_view owner);
  void remove_all(Owned kind, std::string_view id);

 private:
  Database& db_;
};

}  // namespace popcut::daemon
