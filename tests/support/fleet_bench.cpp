// SPDX-License-Identifier: MIT
// Part of tests/support/service_bench.hpp: every bench is a node of a fleet of its own.
#include <iostream>

#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/fleet/postgres_database.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/service_bench.hpp"

namespace popcut::testing {
namespace {

const bool kIsSet = [] {
  if (const std::string why = popcut::testing::PostgresServer::why_not(); !why.empty()) {
    std::cerr << "skipped, the cases run on SQLite: " << why << '\n';
    return false;
  }
  ServiceBench::shared_database =
      [](std::shared_ptr<void>& kept) -> std::unique_ptr<daemon::Database> {
    const bool is_new = !kept;
    if (is_new) kept = std::make_shared<popcut::testing::FreshDatabase>();
    const auto& database = *static_cast<popcut::testing::FreshDatabase*>(kept.get());
    if (is_new) (void)database.run_sql(std::string(daemon::fleet_schema()));
    // These cases wait for states; on a busy machine a login may take longer than popcutd waits for
    // it.
    return std::make_unique<daemon::PostgresDatabase>(daemon::PostgresDatabase::Options{
        .url = database.url(), .name = "bench", .connect_s = 60, .answer_s = 60});
  };
  return true;
}();

}  // namespace
}  // namespace popcut::testing
