// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace popcut::daemon {

/// How to reach a database, taken apart: "postgresql://user@host:port/database?key=value" or
/// "key=value key='value'" (PostgreSQL manual, "Connection Strings"). What is wrong in it is left
/// to libpq, which says so.
struct FleetUrl {
  std::string user, password, hosts, database;  ///< `hosts` as in a URL: "db.lab:5432", "a,b"
  std::vector<std::pair<std::string, std::string>> more{};  ///< "sslmode", "require"

  [[nodiscard]] static FleetUrl parse(std::string_view text);
  /// As a URL.
  [[nodiscard]] std::string text() const;
  /// The same without what nobody else may see.
  [[nodiscard]] std::string shown() const;
  /// A key of `more`; empty: it is not there.
  [[nodiscard]] std::string value(std::string_view key) const;
  /// One for each host that it lists, in that order.
  [[nodiscard]] std::vector<FleetUrl> each_host() const;
  /// Whether the connection goes through the network to another machine.
  [[nodiscard]] bool is_remote() const;
};

}  // namespace popcut::daemon
