// SPDX-License-Identifier: MIT
// The PostgreSQL that all programs of a test run share: fleet_postgres FILE starts it, writes its
// folder into FILE, and ends it on SIGTERM. tests/support/beside starts and ends this program.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "daemon/fleet/fleet_schema.hpp"
#include "tests/support/postgres_server.hpp"

int main(int argc, char** argv) {
  using namespace popcut::testing;
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FILE\n", argv[0]);
    return 2;
  }
  if (const std::string why = PostgresServer::why_not(); !why.empty()) {
    std::fprintf(stderr, "skipped: %s\n", why.c_str());
    return 77;
  }
  sigset_t ends;
  ::sigemptyset(&ends);
  ::sigaddset(&ends, SIGTERM);
  PostgresServer server({.more = "max_connections = 500\n"});
  // The roles that fleets share, before several programs make their fleets at once.
  server.create_database("roles");
  server.run_sql(std::string(popcut::daemon::fleet_schema()), "roles");
  ::sigprocmask(SIG_BLOCK, &ends, nullptr);
  const std::string file = argv[1];
  std::ofstream(file + ".new") << server.folder().string() << '\n';
  std::filesystem::rename(file + ".new", file);
  int signal = 0;
  ::sigwait(&ends, &signal);
  return 0;
}
