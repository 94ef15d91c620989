// SPDX-License-Identifier: MIT
// What popcutd makes of a server's answers, in whatever language they are.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "daemon/fleet/postgres_database.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/process.hpp"

namespace connection_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::PostgresServer;
using popcut::testing::TempFolder;

namespace {

/// A server that speaks German, if this machine can make its locale.
struct German {
  German() {
    std::filesystem::permissions(folder.path(), std::filesystem::perms{0755});
    const std::string place = (folder / "de_DE.UTF-8").string();
    const auto made = popcut::testing::run_program(
        {"/usr/bin/localedef", "-i", "de_DE", "-f", "UTF-8", place}, folder.path());
    is_there = made.exit == 0;
  }
  [[nodiscard]] popcut::testing::PostgresOptions options() const {
    return {.tcp = true,
            .more = "lc_messages = 'de_DE.UTF-8'\n",
            .environment = {"LOCPATH=" + folder.path().string()}};
  }
  TempFolder folder;
  bool is_there{false};
};

bool is_skipped(const German& german, bool in_german) {
  std::string why = PostgresServer::why_not();
  if (why.empty() && in_german && !german.is_there) why = "no German locale can be made here";
  if (!why.empty()) WARN("skipped: " << why);
  return !why.empty();
}

bool is_refused(const std::string& url) {
  PostgresDatabase database({.url = url, .connect_s = 1}, false);
  INFO(url << ": " << database.why_away());
  CHECK_FALSE(database.is_there());
  return database.is_refused();
}

}  // namespace

TEST_CASE("a wrong login is not taken for a server that is away, in any language", "[fleet]") {
  const German german;
  const bool in_german = GENERATE(false, true);
  CAPTURE(in_german);
  if (is_skipped(german, in_german)) return;
  PostgresServer server(in_german ? german.options()
                                  : popcut::testing::PostgresOptions{.tcp = true});
  server.run_sql("CREATE ROLE anna LOGIN PASSWORD 'right'");
  server.run_sql("CREATE ROLE idle NOLOGIN");
  server.create_database("closed");
  server.run_sql("REVOKE CONNECT ON DATABASE closed FROM PUBLIC");
  CHECK_THROWS_WITH(server.run_sql("SELECT nonsense"),
                    Catch::Contains(in_german ? "existiert nicht" : "does not exist"));
  CHECK(is_refused(server.tcp_url("postgres", "anna", "wrong")));
  CHECK(is_refused(server.tcp_url("postgres", "anna", "")));
  CHECK(is_refused(server.url("nowhere")));
  CHECK(is_refused(server.url("postgres", "nobody_knows")));
  CHECK(is_refused(server.url("postgres", "idle")));
  CHECK(is_refused(server.url("closed", "anna")));
  CHECK(is_refused(server.url() + "&nonsense=1"));
  CHECK(is_refused("postgresql://x/y?port=abc"));
  // Full of others: that passes.
  server.run_sql("ALTER ROLE anna CONNECTION LIMIT 0");
  CHECK_FALSE(is_refused(server.tcp_url("postgres", "anna", "right")));
  server.stop();
  CHECK_FALSE(is_refused(server.url()));
}

TEST_CASE("a commit whose wait for the standby was given up is in doubt, in any language",
          "[fleet]") {
  const German german;
  const bool in_german = GENERATE(false, true);
  CAPTURE(in_german);
  if (is_skipped(german, in_german)) return;
  PostgresServer primary(in_german ? german.options() : popcut::testing::PostgresOptions{});
  PostgresServer standby =
      PostgresServer::standby_of(primary, PostgresServer::Commits::Synchronous);
  primary.run_sql("CREATE SCHEMA popcut; CREATE TABLE popcut.sheet(k bigint)");
  standby.stop_following();
  PostgresDatabase database({.url = primary.url(), .name = "waits"});
  const bool in_transaction = GENERATE(true, false);
  std::thread somebody([&] {
    const std::string waits =
        "FROM pg_stat_activity WHERE application_name='waits' AND "
        "wait_event='SyncRep'";
    for (int i = 0; i < 500 && primary.run_sql("SELECT count(*) " + waits) == "0"; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    primary.run_sql("SELECT pg_cancel_backend(pid) " + waits);
  });
  FaultKind kind = FaultKind::Other;
  try {
    if (in_transaction) {
      Transaction all(database);
      database.run("INSERT INTO sheet VALUES(?)", 1);
      all.commit();
    } else {
      database.run("INSERT INTO sheet VALUES(?)", 1);
    }
  } catch (const StoreFault& fault) {
    kind = fault.kind();
  }
  somebody.join();
  CHECK(kind == FaultKind::InDoubt);
  // It goes on with the same connection.
  CHECK(database.number("SELECT count(*) FROM sheet") == 1);
}

}  // namespace connection_test
