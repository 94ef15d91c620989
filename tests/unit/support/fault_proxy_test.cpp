// SPDX-License-Identifier: MIT
#include "tests/support/fault_proxy.hpp"

#include <chrono>
#include <future>
#include <thread>

#include <catch2/catch.hpp>
#include <pqxx/pqxx>

#include "tests/support/needs_postgres.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/process.hpp"

namespace popcut::testing::fault_proxy_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Way = FaultProxy::Way;
using Lost = FaultProxy::Lost;

constexpr auto kSoon = 60s;  // a fault is reported at once; machines are busy

/// A database with a table, and a proxy before its server.
struct Bench {
  FreshDatabase database;
  FaultProxy proxy{shared_postgres().socket()};

  Bench() { database.run_sql("CREATE TABLE t(i int)"); }
  [[nodiscard]] std::string url() const { return proxy.url(database.name()); }
  [[nodiscard]] std::string rows() const { return database.run_sql("SELECT count(*) FROM t"); }
};

template <typename Holds>
bool comes_true(const Holds& holds) {
  const auto until = Clock::now() + kSoon;
  while (!holds()) {
    if (Clock::now() > until) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

std::string ask(pqxx::connection& connection, const std::string& sql) {
  pqxx::nontransaction work(connection);
  const pqxx::result rows = work.exec(sql);
  return rows.empty() ? std::string() : std::string(rows[0][0].c_str());
}

/// That a connection is broken is told soon.
void is_cut(pqxx::connection& connection) {
  const auto begun = Clock::now();
  CHECK_THROWS_AS(ask(connection, "SELECT 1"), pqxx::broken_connection);
  CHECK(Clock::now() - begun < kSoon);
}

TEST_CASE("a proxy passes what is said, by its socket and by 127.0.0.1", "[proxy]") {
  NEEDS_POSTGRES();
  const Bench bench;
  CHECK(run_sql(bench.url(), "SELECT current_database()") == bench.database.name());
  CHECK(run_sql(bench.proxy.tcp_url(bench.database.name()), "SELECT 2") == "2");
  const std::string much(3u << 20, 'x');
  pqxx::connection connection(bench.url());
  CHECK(ask(connection, "SELECT length('" + much + "')") == std::to_string(much.size()));
  CHECK(ask(connection, "SELECT repeat('x', " + std::to_string(much.size()) + ")") == much);
  CHECK(bench.proxy.passed(Way::ToServer) > much.size());
  CHECK(bench.proxy.passed(Way::ToClient) > much.size());
  CHECK(bench.proxy.accepted() == 3);
  CHECK(comes_true([&] { return bench.proxy.connections() == 1; }));
}

TEST_CASE("a proxy lets bytes come later, each way", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  pqxx::connection connection(bench.url());
  for (const Way way : {Way::ToServer, Way::ToClient}) {
    bench.proxy.delay(way, 60ms);
    const auto begun = Clock::now();
    CHECK(ask(connection, "SELECT 7") == "7");
    CHECK(Clock::now() - begun >= 60ms);
    bench.proxy.delay(way, 0ms);
  }
  const auto begun = Clock::now();
  CHECK(ask(connection, "SELECT 7") == "7");
  CHECK(Clock::now() - begun < kSoon);
}

TEST_CASE("a proxy holds what is said, and passes it later", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  pqxx::connection connection(bench.url());
  for (const Way way : {Way::ToServer, Way::ToClient}) {
    const std::string before = bench.rows();
    bench.proxy.hold(way);
    std::future<std::string> asked = std::async(std::launch::async, [&] {
      return ask(connection, "INSERT INTO t VALUES (1) RETURNING i");
    });
    if (way == Way::ToClient) CHECK(comes_true([&] { return bench.rows() != before; }));
    CHECK(asked.wait_for(50ms) == std::future_status::timeout);
    CHECK((bench.rows() != before) == (way == Way::ToClient));
    bench.proxy.pass(way);
    CHECK(asked.get() == "1");
  }
  CHECK(bench.rows() == "2");
}

TEST_CASE("a server behind a black hole does not see that its client is gone", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  const auto clients = [&] {
    return bench.database.run_sql(
        "SELECT count(*) FROM pg_stat_activity WHERE application_name = 'gone'");
  };
  {
    pqxx::connection connection(bench.url());
    static_cast<void>(ask(connection, "SET application_name = 'gone'"));
    bench.proxy.hold();
  }
  std::this_thread::sleep_for(50ms);
  CHECK(clients() == "1");
  CHECK(bench.proxy.connections() == 1);
  bench.proxy.pass();
  CHECK(comes_true([&] { return clients() == "0"; }));
  CHECK(comes_true([&] { return bench.proxy.connections() == 0; }));
}

TEST_CASE("a proxy cuts all connections, also those that wait in a black hole", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  pqxx::connection idle(bench.url()), over_tcp(bench.proxy.tcp_url(bench.database.name())),
      waiting(bench.url());
  bench.proxy.hold(Way::ToClient);
  std::future<std::string> asked =
      std::async(std::launch::async, [&] { return ask(waiting, "SELECT 1"); });
  CHECK(asked.wait_for(20ms) == std::future_status::timeout);
  bench.proxy.cut_all();
  REQUIRE(asked.wait_for(kSoon) == std::future_status::ready);
  CHECK_THROWS_AS(asked.get(), pqxx::broken_connection);
  bench.proxy.pass();
  is_cut(idle);
  is_cut(over_tcp);
  CHECK(bench.proxy.connections() == 0);
  CHECK(run_sql(bench.url(), "SELECT 3") == "3");
}

TEST_CASE("a proxy refuses new connections and keeps the old ones", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  pqxx::connection old(bench.url());
  for (int round = 0; round < 2; ++round) {
    bench.proxy.refuse(true);
    for (const std::string& url : {bench.url(), bench.proxy.tcp_url(bench.database.name())}) {
      const auto begun = Clock::now();
      CHECK_THROWS_WITH(run_sql(url, "SELECT 1"), Catch::Contains("Connection refused"));
      CHECK(Clock::now() - begun < kSoon);
    }
    CHECK(ask(old, "SELECT 4") == "4");
    bench.proxy.refuse(false);
    CHECK(run_sql(bench.url(), "SELECT 5") == "5");
    CHECK(run_sql(bench.proxy.tcp_url(bench.database.name()), "SELECT 6") == "6");
  }
}

TEST_CASE("a proxy whose server is gone ends its clients", "[proxy]") {
  NEEDS_POSTGRES();
  const TempFolder none;
  const FaultProxy proxy((none / "socket").string());
  const auto begun = Clock::now();
  CHECK_THROWS_AS(run_sql(proxy.url(), "SELECT 1"), pqxx::broken_connection);
  CHECK(Clock::now() - begun < kSoon);
}

TEST_CASE("a proxy cuts a connection in the middle of what is said", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  // The fault is in all of what an INSERT says and is answered with, byte by byte.
  pqxx::connection one(bench.url());
  const std::size_t said = bench.proxy.passed(Way::ToServer),
                    answered = bench.proxy.passed(Way::ToClient);
  static_cast<void>(ask(one, "INSERT INTO t VALUES (1)"));
  const std::size_t question = bench.proxy.passed(Way::ToServer) - said,
                    answer = bench.proxy.passed(Way::ToClient) - answered;
  REQUIRE(question > 20);
  REQUIRE(answer > 10);
  int rows = 1;
  for (const Way way : {Way::ToServer, Way::ToClient}) {
    const std::size_t size = way == Way::ToServer ? question : answer;
    for (const std::size_t bytes : {std::size_t{0}, size / 2, size - 1}) {
      pqxx::connection connection(bench.url());
      bench.proxy.cut_after(way, bytes);
      CHECK(bench.proxy.cut_to_come());
      CHECK_THROWS_AS(ask(connection, "INSERT INTO t VALUES (1)"), pqxx::broken_connection);
      CHECK_FALSE(bench.proxy.cut_to_come());
      if (way == Way::ToClient) ++rows;
      CHECK(bench.rows() == std::to_string(rows));
    }
  }
  CHECK(ask(one, "SELECT count(*) FROM t") == std::to_string(rows));
}

TEST_CASE("a proxy loses a COMMIT or the answer to it", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  for (const Lost lost : {Lost::Request, Lost::Answer}) {
    const std::string before = bench.rows();
    pqxx::connection connection(bench.url()), other(bench.url());
    static_cast<void>(ask(connection, "BEGIN; INSERT INTO t VALUES (1)"));
    bench.proxy.cut_at("COMMIT", lost);
    static_cast<void>(ask(other, "SELECT 1"));
    CHECK(bench.proxy.cut_to_come());
    CHECK_THROWS_AS(ask(connection, "COMMIT"), pqxx::broken_connection);
    CHECK_FALSE(bench.proxy.cut_to_come());
    CHECK((bench.rows() != before) == (lost == Lost::Answer));
    CHECK(ask(other, "BEGIN; COMMIT; SELECT 8") == "8");
  }
  // libpqxx says that nobody knows what became of it.
  pqxx::connection connection(bench.url());
  pqxx::work work(connection);
  work.exec("INSERT INTO t VALUES (1)");
  bench.proxy.cut_at("COMMIT", Lost::Answer);
  CHECK_THROWS_AS(work.commit(), pqxx::in_doubt_error);
  CHECK(bench.rows() == "2");
}

TEST_CASE("a proxy loses the COMMIT of the client that has said something before", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  pqxx::connection connection(bench.url()), other(bench.url());
  static_cast<void>(ask(connection, "BEGIN; INSERT INTO t VALUES (1)"));  // said too early
  bench.proxy.cut_at("COMMIT", Lost::Request, "VALUES (2)");
  static_cast<void>(ask(connection, "COMMIT"));
  CHECK(bench.proxy.cut_to_come());
  static_cast<void>(ask(connection, "BEGIN; INSERT INTO t VALUES (2)"));
  static_cast<void>(ask(other, "BEGIN; INSERT INTO t VALUES (3); COMMIT"));
  CHECK(bench.proxy.cut_to_come());
  CHECK_THROWS_AS(ask(connection, "COMMIT"), pqxx::broken_connection);
  CHECK_FALSE(bench.proxy.cut_to_come());
  // Both in one message.
  bench.proxy.cut_at("COMMIT", Lost::Request, "VALUES (4)");
  CHECK_THROWS_AS(ask(other, "BEGIN; INSERT INTO t VALUES (4); COMMIT"), pqxx::broken_connection);
  CHECK(bench.rows() == "2");
}

TEST_CASE("what a client said comes to the server twice", "[proxy]") {
  NEEDS_POSTGRES();
  Bench bench;
  bench.proxy.record(true);
  run_sql(bench.url(), "INSERT INTO t VALUES (1)");
  bench.proxy.record(false);
  run_sql(bench.url(), "INSERT INTO t VALUES (2)");
  REQUIRE(bench.proxy.recordings() == 1);
  CHECK(comes_true([&] { return bench.proxy.connections() == 0; }));
  const std::string said = bench.proxy.recorded(0);
  CHECK(says(said, "INSERT INTO t VALUES (1)"));
  const std::string answer = bench.proxy.replay(said);
  CHECK(says(answer, "INSERT 0 1"));
  CHECK(bench.database.run_sql("SELECT i, count(*) FROM t GROUP BY i ORDER BY i") == "1|2\n2|1");
  // Also when it had not said that it is done.
  CHECK(says(bench.proxy.replay(said.substr(0, said.size() - 5)), "INSERT 0 1"));
  CHECK(bench.rows() == "4");
}

}  // namespace
}  // namespace popcut::testing::fault_proxy_test
