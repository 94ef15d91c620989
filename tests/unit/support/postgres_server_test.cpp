// SPDX-License-Identifier: MIT
#include "tests/support/postgres_server.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <future>
#include <thread>

#include <catch2/catch.hpp>

#include "tests/support/needs_postgres.hpp"
#include "tests/support/process.hpp"

namespace popcut::testing::postgres_server_test {
namespace {

using namespace std::chrono_literals;

template <typename Holds>
bool comes_true(const Holds& holds, std::chrono::milliseconds patience = 10s) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

TEST_CASE("a PostgreSQL of a test has what its cases share and what each has for itself",
          "[postgres]") {
  NEEDS_POSTGRES();
  PostgresServer& server = shared_postgres();
  CHECK(&server == &shared_postgres());
  CHECK(server.run_sql("SHOW server_encoding") == "UTF8");
  CHECK(server.run_sql("SHOW lc_collate") == "C");
  CHECK(server.run_sql("SHOW fsync") == "off");
  CHECK(server.run_sql("SHOW listen_addresses").empty());
  CHECK(server.run_sql("VALUES (1, 'a'), (NULL, 'b')") == "1|a\n|b");
  const FreshDatabase one, other;
  one.run_sql("CREATE TABLE t(i int); INSERT INTO t VALUES (7)");
  CHECK(one.run_sql("SELECT i FROM t") == "7");
  CHECK_THROWS_WITH(other.run_sql("SELECT i FROM t"), Catch::Contains("does not exist"));
  server.run_sql("CREATE ROLE student LOGIN");
  CHECK(run_sql(one.url("student"), "SELECT current_user, current_database()") ==
        "student|" + one.name());
  server.run_sql("DROP ROLE student");
}

TEST_CASE("what is committed outlives a PostgreSQL that is killed, and one that is stopped",
          "[postgres]") {
  NEEDS_POSTGRES();
  PostgresServer server({.fsync = true});
  CHECK(server.run_sql("SHOW fsync") == "on");
  const std::string database = server.create_database("lab");
  run_sql(database, "CREATE TABLE t(i int)");
  for (int i = 1; i <= 3; ++i) {
    run_sql(database, "INSERT INTO t VALUES (" + std::to_string(i) + ")");
    if (i == 1) server.kill();
    if (i == 2) server.stop(PostgresServer::Stop::Immediate);
    if (i == 3) server.stop();
    CHECK_FALSE(server.running());
    CHECK_THROWS(run_sql(database, "SELECT 1"));
    server.start();
    CHECK(run_sql(database, "SELECT count(*) FROM t") == std::to_string(i));
  }
}

TEST_CASE("a frozen PostgreSQL answers nothing until it is thawed", "[postgres]") {
  NEEDS_POSTGRES();
  PostgresServer& server = shared_postgres();
  server.freeze();
  std::future<std::string> asked =
      std::async(std::launch::async, [&] { return server.run_sql("SELECT 42"); });
  CHECK(asked.wait_for(50ms) == std::future_status::timeout);
  server.thaw();
  CHECK(asked.get() == "42");
}

TEST_CASE("a PostgreSQL on 127.0.0.1 asks for a password", "[postgres]") {
  NEEDS_POSTGRES();
  PostgresServer server({.tcp = true});
  server.run_sql("CREATE ROLE node_1 LOGIN PASSWORD 'Leim & Papier'");
  CHECK(run_sql(server.tcp_url("postgres", "node_1", "Leim & Papier"), "SELECT 1") == "1");
  CHECK_THROWS_WITH(run_sql(server.tcp_url("postgres", "node_1", "no"), "SELECT 1"),
                    Catch::Contains("password authentication failed"));
}

TEST_CASE("a standby has what was committed synchronously, and takes over", "[postgres]") {
  NEEDS_POSTGRES();
  PostgresServer primary;
  primary.run_sql("CREATE TABLE t(i int)");
  PostgresServer standby =
      PostgresServer::standby_of(primary, PostgresServer::Commits::Synchronous);
  CHECK(standby.run_sql("SELECT pg_is_in_recovery()") == "t");
  CHECK_THROWS_WITH(standby.run_sql("INSERT INTO t VALUES (0)"), Catch::Contains("read-only"));
  for (int i = 0; i < 20; ++i) primary.run_sql("INSERT INTO t VALUES (" + std::to_string(i) + ")");
  // A commit that the standby has not is not told to the client.
  standby.freeze();
  std::future<std::string> late =
      std::async(std::launch::async, [&] { return primary.run_sql("INSERT INTO t VALUES (20)"); });
  CHECK(late.wait_for(50ms) == std::future_status::timeout);
  primary.kill();
  CHECK_THROWS(late.get());
  standby.thaw();
  standby.promote();
  CHECK(standby.run_sql("SELECT count(*) FROM t WHERE i < 20") == "20");
  standby.run_sql("INSERT INTO t VALUES (21)");
  CHECK(standby.run_sql("SELECT count(*) FROM t WHERE i = 21") == "1");
}

TEST_CASE("a line of configuration is in force when it is set", "[postgres]") {
  NEEDS_POSTGRES();
  PostgresServer& server = shared_postgres();
  server.configure("work_mem = '1234kB'");
  CHECK(server.run_sql("SHOW work_mem") == "1234kB");
}

// As when somebody kills a test program with all its children, one after the other.
TEST_CASE("a PostgreSQL ends with the process that guards it", "[postgres]") {
  NEEDS_POSTGRES();
  PostgresServer server;
  const auto stat_of = [](pid_t process) {  // "S 17 ...": its state, its parent
    const std::string text = text_of_file("/proc/" + std::to_string(process) + "/stat");
    return text.empty() ? text : text.substr(text.rfind(')') + 2);
  };
  const pid_t postmaster = server.pid(), warden = std::stoi(stat_of(postmaster).substr(2));
  REQUIRE(warden != ::getpid());
  ::kill(warden, SIGKILL);
  CHECK(comes_true([&] {
    const std::string now = stat_of(postmaster);
    return now.empty() || now[0] == 'Z';
  }));
}

// The test program is played by a child that is killed, frozen server and all.
TEST_CASE("nothing is left of a PostgreSQL whose test is killed", "[postgres]") {
  NEEDS_POSTGRES();
  struct Seen {
    pid_t postmaster;
    std::array<char, 200> folder;
  };
  std::array<int, 2> ends{};
  REQUIRE(::pipe(ends.data()) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    PostgresServer server;
    server.freeze();
    Seen seen{server.pid(), {}};
    server.folder().string().copy(seen.folder.data(), seen.folder.size() - 1);
    if (::write(ends[1], &seen, sizeof seen) != sizeof seen) ::_exit(1);
    for (;;) ::pause();
  }
  ::close(ends[1]);
  Seen seen{};
  REQUIRE(::read(ends[0], &seen, sizeof seen) == sizeof seen);
  ::close(ends[0]);
  CHECK(std::filesystem::exists(seen.folder.data()));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(comes_true([&] { return ::kill(seen.postmaster, 0) != 0; }));
  CHECK(comes_true([&] { return !std::filesystem::exists(seen.folder.data()); }));
}

}  // namespace
}  // namespace popcut::testing::postgres_server_test
