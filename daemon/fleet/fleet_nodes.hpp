// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// What those who look after a fleet do with its nodes. All of these throw StoreFault: Refused,
/// with a sentence for people, or as the statements.

/// The login role of a node: "popcut_n_room_1" for "room-1".
[[nodiscard]] std::string login_of(const std::string& node);
/// Whether a node may have this name: a letter or digit, then letters, digits and "._-", 48 at
/// most.
[[nodiscard]] bool is_node_name(const std::string& name);

struct JoinedNode {
  std::string login, password;
  bool is_new{true};  ///< false: the login was there and has another password now
};
/// Makes the login of a node with a random password, of which the server gets a digest only.
///
/// @param again  also for a node that has joined: its old password stops working
JoinedNode join_node(Database& database, const std::string& node, bool again);

/// A node as others see it. Times by the database's clock.
struct NodeState {
  std::string name, login, url, version;
  std::int64_t epoch{};               ///< 0: it has joined and was never started
  bool alive{}, draining{}, ended{};  ///< `ended`: it was stopped in order
  bool reported{true};     ///< false: until it compares its journals with this database nobody arms
  std::int64_t begun_s{};  ///< ago
  std::int64_t heartbeat_s{};          ///< ago
  double lease_s{};                    ///< left; below 0: over
  std::vector<std::string> devices{};  ///< "usb:51053P idle"
  std::string site{};                  ///< where they stand; empty: nobody said, or it has none
};
[[nodiscard]] std::vector<NodeState> fleet_nodes(Database& database);

/// "5 s", "12 min", "3 h", "4 d"
[[nodiscard]] std::string rough_time(std::int64_t seconds);

void drain_node(Database& database, const std::string& node, bool draining);
/// Removes the node and, if the caller may, its login.
///
/// @return the login that is still there; empty: none
[[nodiscard]] std::string forget_node(Database& database, const std::string& node);

}  // namespace popcut::daemon
