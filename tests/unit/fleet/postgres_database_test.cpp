// SPDX-License-Identifier: MIT
// What popcutd's own connection to a fleet's database promises its callers.
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/fleet/postgres_database.hpp"
#include "tests/support/fault_proxy.hpp"
#include "tests/support/fleet_sql.hpp"
#include "tests/support/needs_postgres.hpp"
#include "tests/support/postgres_server.hpp"

namespace popcut::testing::postgres_database_test {

using namespace popcut::daemon;

namespace {

/// A table of numbers, each once, and a connection that is counted.
struct Bench {
  PostgresServer server{};
  FaultProxy proxy{server.socket()};
  PostgresDatabase watcher{{.url = server.url()}};
  PostgresDatabase database{{.url = proxy.url()}};
  Bench() {
    watcher.script("CREATE SCHEMA popcut; CREATE TABLE popcut.one(n bigint PRIMARY KEY, t text)");
  }
  std::int64_t stored() { return watcher.number("SELECT count(*) FROM one"); }
  void put(std::int64_t n) { database.insert_later("one(n, t)", n, "it's \\ \"so\""); }
  FaultKind fault_of(const std::function<void()>& work) {
    try {
      work();
    } catch (const StoreFault& fault) {
      return fault.kind();
    }
    FAIL("nothing was thrown");
    return FaultKind::Other;
  }
};

}  // namespace

TEST_CASE("what is for later runs in its turn, and all of it with the commit", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  {
    Transaction all(bench.database);
    for (int n = 1; n <= 3; ++n) bench.put(n);
    CHECK(bench.stored() == 0);
    // The next statement sees what was put off before it.
    CHECK(bench.database.number("SELECT count(*) FROM one") == 3);
    CHECK(bench.database.run("UPDATE one SET t='two' WHERE n=?", 2) == 1);
    bench.put(4);
    bench.database.later("UPDATE one SET t=? WHERE n=?", nullptr, 4);
    all.commit();
  }
  CHECK(bench.stored() == 4);
  CHECK(bench.watcher.number("SELECT count(*) FROM one WHERE t IS NULL") == 1);
  Rows first = bench.watcher.rows("SELECT t FROM one WHERE n=1");
  REQUIRE(first.next());
  CHECK(first.text(0) == "it's \\ \"so\"");
  // Outside a transaction it is not put off.
  bench.put(5);
  CHECK(bench.stored() == 5);
}

TEST_CASE("a transaction of statements for later is one way to the server and back", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  bench.put(100);  // the server learns the statement
  const std::size_t before = bench.proxy.turns();
  Transaction all(bench.database);
  for (int n = 1; n <= 20; ++n) bench.put(n);
  all.commit();
  CHECK(bench.proxy.turns() == before + 1);  // 22, with each statement alone
  CHECK(bench.stored() == 21);
}

TEST_CASE("a fault of a statement for later undoes all, wherever it comes to light", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  bench.put(1);
  SECTION("at the commit") {
    CHECK(bench.fault_of([&] {
      Transaction all(bench.database);
      bench.put(2);
      bench.put(1);
      all.commit();
    }) == FaultKind::Constraint);
  }
  SECTION("at the next statement, after which nothing is sent any more") {
    CHECK(bench.fault_of([&] {
      Transaction all(bench.database);
      bench.put(2);
      bench.put(1);
      CHECK(bench.fault_of([&] { (void)bench.database.number("SELECT count(*) FROM one"); }) ==
            FaultKind::Constraint);
      CHECK(bench.fault_of([&] { bench.put(3); }) == FaultKind::Other);
      CHECK(bench.fault_of([&] { (void)bench.database.run("DELETE FROM one"); }) ==
            FaultKind::Other);
      all.commit();
    }) == FaultKind::Other);
  }
  SECTION("with a statement that the server does not understand") {
    CHECK(bench.fault_of([&] {
      Transaction all(bench.database);
      bench.put(2);
      CHECK(bench.fault_of([&] { bench.database.later("DELETE FROM nowhere"); }) ==
            FaultKind::Other);
      all.commit();
    }) == FaultKind::Other);
  }
  CHECK_FALSE(bench.database.in_transaction());
  CHECK(bench.stored() == 1);
  // Nothing is left open at the server: no lock, no half transaction.
  CHECK(bench.watcher.number("SELECT count(*) FROM pg_stat_activity WHERE state LIKE 'idle in%'") ==
        0);
  {
    Transaction all(bench.database);
    bench.put(2);
    all.commit();
  }
  CHECK(bench.stored() == 2);
}

TEST_CASE("what is undone takes what was for later with it", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  {
    const Transaction never(bench.database);
    bench.put(1);
  }
  {
    Transaction all(bench.database);
    bench.put(2);
    {
      const Transaction part(bench.database);
      bench.put(3);
    }
    {
      Transaction part(bench.database);
      bench.put(4);
      part.commit();
    }
    {
      const Transaction part(bench.database);
      bench.put(2);  // not twice, but it is never sent
    }
    all.commit();
  }
  {
    Transaction nothing(bench.database);
    nothing.commit();
  }
  CHECK(bench.stored() == 2);
  CHECK(bench.watcher.number("SELECT sum(n) FROM one") == 6);
}

TEST_CASE("more than one message holds goes before the commit", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  const std::string much(100'000, 'x');
  Transaction all(bench.database);
  for (int n = 0; n < 20; ++n) bench.database.insert_later("one(n, t)", n, much);
  all.commit();
  CHECK(bench.watcher.number("SELECT sum(length(t)) FROM one") == 2'000'000);
}

TEST_CASE("a statement that could not be prepared leaves its name to no other", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  bench.put(1);
  PostgresDatabase holder({.url = bench.server.url()});
  {
    const Transaction all(holder);
    holder.script("LOCK TABLE popcut.one");
    CHECK(bench.fault_of([&] { (void)bench.database.number("SELECT count(*) FROM one"); }) ==
          FaultKind::Again);
    CHECK(bench.fault_of([&] { (void)bench.database.number("SELECT max(n) FROM one"); }) ==
          FaultKind::Again);
  }
  CHECK(bench.database.number("SELECT sum(n) FROM one") == 1);
  CHECK(bench.database.number("SELECT count(*) FROM one") == 1);
  CHECK(bench.database.number("SELECT max(n) FROM one") == 1);
}

TEST_CASE("a column of another type is no end of all statements", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  bench.put(1);
  const auto text = [&] {
    Rows rows = bench.database.rows("SELECT t FROM one WHERE n=?", 1);
    REQUIRE(rows.next());
    return rows.text(0);
  };
  const std::string before = text();
  bench.watcher.script("ALTER TABLE popcut.one ALTER t TYPE varchar(50)");
  CHECK(bench.fault_of([&] { (void)text(); }) == FaultKind::Away);
  while (!bench.database.is_there()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(text() == before);
}

TEST_CASE("text is UTF-8 whatever the database gives to others", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  bench.watcher.script("ALTER DATABASE postgres SET client_encoding='LATIN1'");
  PostgresDatabase later({.url = bench.server.url()});
  later.insert("one(n, t)", 1, "Süß ✂");
  Rows rows = later.rows("SELECT t, length(t) FROM one");
  REQUIRE(rows.next());
  CHECK(rows.text(0) == "Süß ✂");
  CHECK(rows.integer(1) == 5);
}

TEST_CASE("a connection that listens to a database that hangs still ends", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  auto ear =
      std::make_unique<PostgresDatabase>(PostgresDatabase::Options{.url = bench.proxy.url()});
  REQUIRE(ear->listen("popcut", 0.01, [](const std::string&) {}));
  bench.proxy.hold();
  ear.reset();  // it once waited for as long as the database hung
  bench.proxy.pass();
  CHECK(bench.stored() == 0);
}

TEST_CASE("a connection that is lost says whether a commit is in doubt", "[fleet]") {
  NEEDS_POSTGRES();
  Bench bench;
  bench.put(1);
  const auto lost_at = [&](const std::string& text, FaultProxy::Lost lost, int n) {
    while (!bench.database.is_there()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return bench.fault_of([&] {
      Transaction all(bench.database);
      bench.put(n);
      (void)bench.database.number("SELECT count(*) FROM one");
      bench.put(n + 1);
      bench.proxy.cut_at(text, lost);
      all.commit();
    });
  };
  CHECK(lost_at("COMMIT", FaultProxy::Lost::Request, 10) == FaultKind::InDoubt);
  CHECK(bench.stored() == 1);
  CHECK(lost_at("COMMIT", FaultProxy::Lost::Answer, 20) == FaultKind::InDoubt);
  for (int times = 0; times < 100 && bench.stored() != 3; ++times)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  CHECK(bench.stored() == 3);
  // Before the commit nothing is in doubt, also if the BEGIN never went.
  while (!bench.database.is_there()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(bench.fault_of([&] {
    Transaction all(bench.database);
    bench.put(30);
    bench.proxy.cut_all();
    (void)bench.database.number("SELECT count(*) FROM one");
  }) == FaultKind::Away);
  CHECK_FALSE(bench.database.in_transaction());
  CHECK(bench.stored() == 3);
}

}  // namespace popcut::testing::postgres_database_test
