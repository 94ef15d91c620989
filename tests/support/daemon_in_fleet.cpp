// SPDX-License-Identifier: MIT
// Part of tests/support/daemon_process.hpp: with POPCUT_TEST_FLEET=1 every popcutd of a test
// program that has this source is the node of a fleet of its own.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "daemon/fleet/fleet_schema.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/fleet_nodes.hpp"
#include "tests/support/postgres_server.hpp"

namespace popcut::testing {
namespace {

std::string section_of(std::shared_ptr<void>& kept) {
  const auto database = std::make_shared<FreshDatabase>();
  database->run_sql(std::string(daemon::fleet_schema()));
  const std::string login = join_fleet(shared_postgres(), database->name(), "alone");
  kept = database;
  return fmt::format("[fleet]\ndatabase = \"{}\"\nnode = \"alone\"\n", database->url(login));
}

const bool kIsSet = [] {
  const char* const asked = std::getenv("POPCUT_TEST_FLEET");
  if (asked == nullptr || std::string_view(asked) != "1") return false;
  if (const std::string why = PostgresServer::why_not(); !why.empty()) {
    std::fprintf(stderr, "skipped, each popcutd is alone: %s\n", why.c_str());
    return false;
  }
  DaemonProcess::fleet_section = section_of;
  return true;
}();

}  // namespace
}  // namespace popcut::testing
