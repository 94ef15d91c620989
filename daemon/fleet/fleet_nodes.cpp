// SPDX-License-Identifier: MIT
#include "daemon/fleet/fleet_nodes.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/digest/digest.hpp"
#include "daemon/fleet/fleet_schema.hpp"

namespace popcut::daemon {
namespace {

constexpr std::string_view kLogin = "popcut_n_";
constexpr std::size_t kLongestName = 48;  // as popcutd takes them
constexpr std::size_t kLongestRole = 63;  // PostgreSQL cuts off the rest
constexpr std::size_t kSecretBytes = 24;

[[noreturn]] void refuse(const std::string& sentence) {
  throw StoreFault(FaultKind::Refused, sentence);
}

bool has_role(Database& database, const std::string& role) {
  return database.number("SELECT count(*) FROM pg_catalog.pg_roles WHERE rolname=?", role) > 0;
}

// Only letters, digits and "_" come from `login_of`, so that nothing needs quotes.
bool is_login(std::string_view role) {
  return role.starts_with(kLogin) &&
         role.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string_view::npos;
}

void check_schema(Database& database) {
  if (const std::string misfit = schema_misfit(database); !misfit.empty()) refuse(misfit);
}

}  // namespace

bool is_node_name(const std::string& name) {
  constexpr std::string_view kFirst =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  return !name.empty() && name.size() <= kLongestName &&
         name.find_first_not_of(kFirst) == std::string::npos && name.find_first_of("._-") != 0;
}

std::string login_of(const std::string& node) {
  std::string login(kLogin);
  for (const char c : node) {
    const bool is_big = c >= 'A' && c <= 'Z';
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    login += is_big ? static_cast<char>(c - 'A' + 'a') : is_plain ? c : '_';
  }
  if (login.size() <= kLongestRole) return login;
  constexpr std::size_t kDigits = 8;
  return login.substr(0, kLongestRole - kDigits - 1) + "_" + sha256_hex(node).substr(0, kDigits);
}

JoinedNode join_node(Database& database, const std::string& node, bool again) {
  if (!is_node_name(node))
    refuse(
        fmt::format("\"{}\" is no name for a node; use letters, digits, '.', '_' and '-', at "
                    "most 48, as in room-1",
                    node));
  JoinedNode joined{.login = login_of(node), .password = base64url(random_bytes(kSecretBytes))};
  Transaction all(database);
  database.hold("popcut.fleet-join");
  check_schema(database);
  if (const auto other =
          first_of(database.rows("SELECT name FROM popcut.node WHERE login=? AND name<>?",
                                 joined.login, node),
                   first_text))
    refuse(
        fmt::format("node {} has the login {} that this name would have; choose a name that "
                    "differs in more than its case and '-'",
                    *other, joined.login));
  const bool has_node = database.number("SELECT count(*) FROM popcut.node WHERE name=?", node) > 0;
  joined.is_new = !has_role(database, joined.login);
  if (!has_node && !joined.is_new && !again)
    refuse(
        fmt::format("this PostgreSQL has a login {0} already, of another fleet or of a node that "
                    "was forgotten; to give it a new password, which stops the old one, type: "
                    "popcut fleet join --node {1} --again",
                    joined.login, node));
  if (has_node && !again)
    refuse(
        fmt::format("node {0} has joined; to give it a new password, type: popcut fleet join "
                    "--node {0} --again",
                    node));
  if (!has_node && joined.is_new && again)
    refuse(fmt::format("node {0} has not joined yet; type: popcut fleet join --node {0}", node));
  database.script(fmt::format("{} ROLE {} LOGIN PASSWORD '{}'", joined.is_new ? "CREATE" : "ALTER",
                              joined.login, scram_verifier(joined.password, random_bytes(16))));
  database.script(fmt::format("GRANT popcut_node TO {}", joined.login));
  database.run("SELECT popcut.node_join(?, ?)", node, joined.login);
  all.commit();
  return joined;
}

std::vector<NodeState> fleet_nodes(Database& database) {
  check_schema(database);
  std::vector<NodeState> nodes = all_of(
      database.rows(
          "SELECT name, login, url, version, epoch, alive::int, draining, ended, "
          "CASE WHEN isfinite(begun) THEN extract(epoch FROM now - begun)::bigint ELSE 0 END, "
          "CASE WHEN isfinite(heartbeat) THEN extract(epoch FROM now - heartbeat)::bigint ELSE 0 "
          "END, CASE WHEN alive THEN extract(epoch FROM lease_until - now)::float8 ELSE 0 END, "
          // As generation_check() in schema.sql.
          "(epoch = 0 OR generation = timeline || '.' || went_back OR "
          "  (ended = 1 AND split_part(generation, '.', 2) = went_back))::int "
          "FROM (SELECT *, lease_until > clock_timestamp() AS alive, clock_timestamp() AS now, "
          "  substr(pg_walfile_name(pg_current_wal_lsn()), 1, 8) AS timeline, "
          "  (SELECT went_back FROM popcut.popcut_schema)::text AS went_back "
          "  FROM popcut.node) AS each ORDER BY name"),
      [](const Rows& row) {
        NodeState one;
        row.read(0, std::tie(one.name, one.login, one.url, one.version, one.epoch, one.alive,
                             one.draining, one.ended, one.begun_s, one.heartbeat_s, one.lease_s,
                             one.reported));
        return one;
      });
  Rows devices =
      database.rows("SELECT node, id, state, site FROM popcut.device WHERE node<>'' ORDER BY id");
  while (devices.next()) {
    const std::string name = devices.text(0);
    const auto at = std::find_if(nodes.begin(), nodes.end(),
                                 [&](const NodeState& node) { return node.name == name; });
    if (at == nodes.end()) continue;
    at->devices.push_back(fmt::format("{} {}", devices.text(1), devices.text(2)));
    at->site = devices.text(3);  // all of a node's stand there
  }
  return nodes;
}

std::string rough_time(std::int64_t seconds) {
  constexpr std::int64_t kMinute = 60, kHour = 3600, kDay = 86'400;
  if (seconds < 2 * kMinute) return fmt::format("{} s", seconds);
  if (seconds < 2 * kHour) return fmt::format("{} min", seconds / kMinute);
  if (seconds < 2 * kDay) return fmt::format("{} h", seconds / kHour);
  return fmt::format("{} d", seconds / kDay);
}

void drain_node(Database& database, const std::string& node, bool draining) {
  check_schema(database);
  database.run("SELECT popcut.node_drain(?, ?)", node, draining);
}

std::string forget_node(Database& database, const std::string& node) {
  Transaction all(database);
  check_schema(database);
  const std::string login =
      first_of(database.rows("SELECT login FROM popcut.node WHERE name=?", node), first_text)
          .value_or("");
  database.run("SELECT popcut.node_forget(?)", node);
  std::string left;
  if (is_login(login) && has_role(database, login)) {
    left = login;
    try {
      Transaction drop(database);
      database.script(fmt::format("DROP ROLE {}", login));
      drop.commit();
      left.clear();
    } catch (const StoreFault& fault) {
      if (fault.kind() != FaultKind::Other && fault.kind() != FaultKind::Constraint) throw;
    }
  }
  all.commit();
  return left;
}

}  // namespace popcut::daemon
