// SPDX-License-Identifier: MIT
// Sessions are never more than what they came from; what is kept does not follow a clock's jumps.
#include <filesystem>

#include <unistd.h>

#include <catch2/catch.hpp>

#include "daemon/digest/digest.hpp"
#include "daemon/store/schema.hpp"
#include "tests/support/service_bench.hpp"

namespace service_access_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using popcut::testing::write_text;

namespace {

constexpr std::int64_t kHour_ms = 3'600'000;
constexpr std::int64_t kDay_ms = 24 * kHour_ms;
constexpr std::int64_t kYear_ms = 366 * kDay_ms;
constexpr uid_t kUser = 4242;
constexpr gid_t kGroup = 4343;

// A service, and people who open pages.
class Pages : public ServiceBench {
 public:
  explicit Pages() : ServiceBench(false) {
    options.users.groups[kGroup] = Role::Operator;
    REQUIRE(start().empty());
  }
  NewToken token(Role role, std::optional<int> lifetime_s = {}) {
    return on([&](LiveService& s) {
      return s.access.create_token(admin, "lab", role, lifetime_s).value();
    });
  }
  std::optional<Principal> who(const std::string& text) {
    return on([&](LiveService& s) { return s.access.authenticate(text); });
  }
  std::string word(const Principal& whose) {
    return on([&](LiveService& s) { return s.access.create_one_shot(whose).value(); });
  }
  Answer<NewToken> open(const std::string& one) {
    return on([&](LiveService& s) { return s.access.open_session(one); });
  }
  NewToken page(const Principal& whose) { return open(word(whose)).value(); }
  NewToken page(const NewToken& from) { return page(who(from.text).value()); }
  std::vector<SessionRecord> sessions(const Principal& whose) {
    return on([&](LiveService& s) { return s.access.sessions(whose); });
  }
  void set_users(LocalUsers users) {
    options.users = users;  // of a later start
    on([&](LiveService& s) { s.retune({.users = users}); });
  }
  static Principal local() {
    return {
        .name = "uid:4242" + machine(), .role = Role::Operator, .user = LocalUser{kUser, {kGroup}}};
  }
  void tick() {
    on([](LiveService& s) { s.tick(); });
  }
  void restart() {
    stop();
    REQUIRE(start().empty());
  }
};

}  // namespace

TEST_CASE("a session ends with the token that it came from", "[daemon][service]") {
  Pages bench;
  const NewToken brief = bench.token(Role::Operator, 60);
  const NewToken open_ended = bench.token(Role::Operator);
  const NewToken of_brief = bench.page(brief);
  const NewToken of_open = bench.page(open_ended);
  const NewToken second = bench.page(of_open);
  CHECK(*of_brief.record.expires <= *brief.record.expires);
  CHECK(bench.who(of_brief.text)->role == Role::Operator);
  CHECK(bench.who(of_brief.text)->name == "token:" + brief.record.id);
  int changes = 0;
  bench.on([&](LiveService& s) { s.access.on_access_change([&] { ++changes; }); });

  SECTION("when it expires, however much the session is used") {
    bench.skew_ms = 59'000;
    CHECK(bench.who(of_brief.text));
    bench.skew_ms = 61'000;
    CHECK_FALSE(bench.who(of_brief.text));
    CHECK(bench.who(of_open.text));
  }
  SECTION("when it is deleted, at once, also after a restart") {
    const std::string late = bench.word(bench.who(open_ended.text).value());
    const std::string later = bench.word(bench.who(second.text).value());
    REQUIRE(bench.on(
        [&](LiveService& s) { return s.access.delete_token(bench.admin, open_ended.record.id); }));
    CHECK(changes > 0);
    CHECK_FALSE(bench.who(of_open.text));
    CHECK_FALSE(bench.who(second.text));
    // A word that was made before opens nothing.
    CHECK(bench.open(late).error().kind == ProblemKind::Unauthenticated);
    CHECK(bench.open(later).error().kind == ProblemKind::Unauthenticated);
    bench.restart();
    CHECK_FALSE(bench.who(of_open.text));
    CHECK_FALSE(bench.who(second.text));
    CHECK(bench.who(of_brief.text));
  }
}

TEST_CASE("a session of a user of the socket has the role that the user has now",
          "[daemon][service]") {
  Pages bench;
  const NewToken page = bench.page(Pages::local());
  const NewToken of_page = bench.page(page);
  const std::string late = bench.word(Pages::local());
  REQUIRE(bench.who(page.text));
  CHECK(bench.who(page.text)->role == Role::Operator);
  LocalUsers users;
  users.groups[kGroup] = Role::Viewer;
  bench.set_users(users);
  CHECK(bench.who(page.text)->role == Role::Viewer);
  CHECK(bench.who(of_page.text)->role == Role::Viewer);
  CHECK(bench.sessions(bench.admin).front().role == Role::Viewer);
  SECTION("over a restart") {
    bench.restart();
    CHECK(bench.who(page.text)->role == Role::Viewer);
    bench.stop();
    bench.options.users = {};
    REQUIRE(bench.start().empty());
    CHECK_FALSE(bench.who(page.text));
  }
  SECTION("and ends for good when the user has none") {
    bench.set_users({});
    CHECK_FALSE(bench.who(page.text));
    CHECK_FALSE(bench.who(of_page.text));
    CHECK(bench.open(late).error().kind == ProblemKind::Unauthenticated);
    bench.set_users(users);
    CHECK_FALSE(bench.who(page.text));
  }
}

TEST_CASE("a session makes no session that outlives it", "[daemon][service]") {
  Pages bench;
  const NewToken page = bench.page(Pages::local());
  NewToken last = page;
  // Each is made by the one before, and used all the time.
  for (int hour = 0; hour < 7 * 24 - 1; hour += 8) {
    bench.skew_ms = hour * kHour_ms;
    REQUIRE(bench.who(page.text));
    last = bench.page(last);
  }
  REQUIRE(bench.who(last.text));
  bench.skew_ms = 7 * kDay_ms + 1000;
  CHECK_FALSE(bench.who(last.text));
  CHECK_FALSE(bench.who(page.text));
}

TEST_CASE("sessions are listed and ended by an admin and by those whose they are",
          "[daemon][service]") {
  Pages bench;
  const NewToken token = bench.token(Role::Submitter);
  const NewToken page = bench.page(token);
  const NewToken from_page = bench.page(page);
  const NewToken other = bench.page(Pages::local());
  const Principal owner = bench.who(page.text).value();
  CHECK(bench.sessions(bench.admin).size() == 3);
  const auto own = bench.sessions(owner);
  REQUIRE(own.size() == 2);
  CHECK(own[0].root == "token:" + token.record.id);
  CHECK(own[0].via.empty());
  CHECK(own[1].via == page.record.id);
  CHECK(own[1].ends <= own[0].ends);
  CHECK(own[0].role == Role::Submitter);
  const auto end = [&](const Principal& who, const std::string& id) {
    return bench.on([&](LiveService& s) { return s.access.end_session(who, id); });
  };
  CHECK(end(owner, other.record.id).error().kind == ProblemKind::NotFound);
  CHECK(bench.who(other.text));
  REQUIRE(end(owner, page.record.id));
  CHECK_FALSE(bench.who(page.text));
  CHECK_FALSE(bench.who(from_page.text));  // it came through that one
  CHECK(bench.who(token.text));
  REQUIRE(end(bench.admin, other.record.id));
  CHECK_FALSE(bench.who(other.text));
  CHECK(bench.sessions(bench.admin).empty());
  // One closes itself, and nothing else.
  const NewToken one = bench.page(token), two = bench.page(token);
  REQUIRE(bench.on(
      [&](LiveService& s) { return s.access.close_session(*s.access.authenticate(one.text)); }));
  CHECK_FALSE(bench.who(one.text));
  CHECK(bench.who(two.text));
  CHECK(bench.who(token.text));
  CHECK(bench.on([&](LiveService& s) {
    return s.access.close_session(Pages::local()).error().kind;
  }) == ProblemKind::NotFound);
}

TEST_CASE("nobody takes the one-time words or the sessions of others", "[daemon][service]") {
  Pages bench;
  const std::string mine = bench.word(Pages::local());
  std::vector<std::string> flood;
  const NewToken token = bench.token(Role::Viewer);
  const Principal viewer = bench.who(token.text).value();
  for (int i = 0; i < 150; ++i) flood.push_back(bench.word(viewer));
  CHECK(bench.open(mine));  // it was not pushed out, and none was refused
  CHECK_FALSE(bench.open(flood.front()));
  CHECK(bench.open(flood.back()));
  // Many principals: whoever has most gives room.
  std::vector<std::string> words;
  for (int i = 0; i < 110; ++i) {
    Principal one = Pages::local();
    one.name = "uid:" + std::to_string(i) + ServiceBench::machine();
    words.push_back(bench.word(one));
  }
  CHECK(bench.open(words.back()));
  // So many sessions of one, no more; the others' stay.
  const NewToken kept = bench.page(Pages::local());
  for (int i = 0; i < 40; ++i) CHECK(bench.page(token).text.size() == 73);
  CHECK(bench.sessions(viewer).size() == 32);
  CHECK(bench.who(kept.text));
}

TEST_CASE("a clock that is wrong by years for a moment deletes nothing",
          "[alone][daemon][service][clock]") {
  Pages bench;
  const NewToken token = bench.token(Role::Operator, 3600);
  const NewToken page = bench.page(token);
  bench.tick();
  const auto rows = [&](const std::string& table) {
    return bench.on([&](LiveService&) {
      return bench.store().database().number("SELECT count(*) FROM " + table);
    });
  };
  int effects = 0;
  const auto make = [&] {
    return bench.on([&](LiveService& s) {
      return s.operations.once(bench.tutor, {"key-0123456789abcdef", "same"}, [&] {
        ++effects;
        return Rendered{.status = 201, .body = "made"};
      });
    });
  };
  REQUIRE(make());
  REQUIRE(bench.add_design("one"));
  REQUIRE(bench.add_design("two"));
  const auto before = std::tuple(rows("token"), rows("session"), rows("event"), rows("idem"));
  const auto years = GENERATE(1, 60, -1, -40);
  CAPTURE(years);
  bench.skew_ms = years * kYear_ms;
  for (int i = 0; i < 5; ++i) {
    bench.monotonic_skew_ms += 1000;
    bench.tick();
  }
  if (years > 0) CHECK_FALSE(bench.who(token.text));  // it is refused as long as the clock says so
  REQUIRE(bench.add_design("while it was wrong"));
  CHECK(make()->replayed);
  SECTION("also over a restart") {
    bench.restart();
    bench.tick();
  }
  SECTION("in one run") {}
  bench.skew_ms = bench.monotonic_skew_ms;
  for (int i = 0; i < 5; ++i) {
    bench.monotonic_skew_ms += 1000;
    bench.skew_ms += 1000;
    bench.tick();
  }
  CHECK(bench.who(token.text));
  CHECK(bench.who(page.text));
  CHECK(make()->replayed);
  CHECK(effects == 1);
  CHECK(rows("token") == std::get<0>(before));
  CHECK(rows("session") == std::get<1>(before));
  CHECK(rows("event") > std::get<2>(before));
  CHECK(rows("idem") == std::get<3>(before));
}

TEST_CASE("a clock that was set right is believed after a day and what is old goes then",
          "[alone][daemon][service][clock]") {
  Pages bench;
  const NewToken token = bench.token(Role::Operator, 3600);
  for (const char* name : {"one", "two", "three"}) REQUIRE(bench.add_design(name));
  bench.tick();
  const auto rows = [&](const std::string& table) {
    return bench.on([&](LiveService&) {
      return bench.store().database().number("SELECT count(*) FROM " + table);
    });
  };
  bench.skew_ms = kYear_ms;  // it is a year later indeed
  const auto run = [&](int hours) {
    for (int i = 0; i < hours; ++i) {
      bench.monotonic_skew_ms += kHour_ms;
      bench.skew_ms += kHour_ms;
      bench.tick();
    }
  };
  run(23);
  CHECK(rows("event") > 1);
  CHECK(rows("token") == 1);
  SECTION("in one run") {}
  SECTION("over nights when it is off") {
    bench.stop();
    bench.skew_ms += 16 * kHour_ms;
    REQUIRE(bench.start().empty());
  }
  run(3);
  CHECK(rows("event") == 1);  // the last one stays
  CHECK(rows("token") == 0);
}

TEST_CASE("events of a clock that was years ahead go when the right one is believed",
          "[alone][daemon][service][clock]") {
  ServiceBench bench(false);
  bench.skew_ms = 10 * kYear_ms;
  REQUIRE(bench.start() == "");
  const auto tick = [&] { bench.on([](LiveService& s) { s.tick(); }); };
  for (const char* name : {"one", "two", "three"}) REQUIRE(bench.add_design(name));
  const auto first = [&] {
    return bench.on([](LiveService& s) { return s.operations.first_event(); });
  };
  const std::int64_t last = bench.on([](LiveService& s) { return s.operations.last_event(); });
  bench.skew_ms = 0;
  REQUIRE(bench.add_design("four"));
  tick();
  CHECK(first() <= last);
  for (int hour = 0; hour < 26; ++hour) {
    bench.monotonic_skew_ms += kHour_ms;
    bench.skew_ms += kHour_ms;
    tick();
  }
  CHECK(first() > last);
}

TEST_CASE("a computer that was asleep forgets what is old without waiting",
          "[daemon][service][clock]") {
  Pages bench;
  for (const char* name : {"one", "two", "three"}) REQUIRE(bench.add_design(name));
  bench.tick();
  for (int day = 0; day < 32; ++day) {  // asleep most of the day: the monotonic clock stands still
    bench.skew_ms += 20 * kHour_ms;
    bench.tick();
    bench.skew_ms += 4 * kHour_ms;
    bench.monotonic_skew_ms += 4 * kHour_ms;
    bench.tick();
  }
  bench.tick();
  CHECK(bench.on([&](LiveService&) {
    return bench.store().database().number("SELECT count(*) FROM event");
  }) == 1);
}

TEST_CASE("assets are listed with the designs that refer to them and removed when none does",
          "[daemon][service]") {
  Pages bench;
  const auto upload = [&](const std::string& text, const Principal& who, const std::string& name) {
    const std::string path = bench.folder() + "/incoming/" + text;
    write_text(path, text);
    return bench.on([&](LiveService& s) {
      return s.designs
          .add_asset(who,
                     {.path = path, .sha256 = sha256_hex(text), .bytes = text.size(), .name = name})
          .value();
    });
  };
  const Asset mesh = upload("mesh", bench.student, "vase.obj");
  const Asset grid = upload("grid", bench.other_student, "");
  CHECK(upload("mesh", bench.other_student, "other").name == "other");
  // The fake planner finds no assets: the design's row says what a planner would.
  const Design design = bench.add_design("a spec").value();
  bench.on([&](LiveService&) {
    Database& db = bench.store().database();
    db.run("DELETE FROM design WHERE id=?", design.id);
    db.insert("design(id, name, kind, owner, bytes, created, assets, media_type)", design.id,
              "vase", "spec", bench.student.name, 6, 1, "[\"" + mesh.id + "\"]",
              "application/json");
  });
  const auto listed = [&](int limit, const std::string& cursor) {
    return bench.on([&](LiveService& s) { return s.designs.assets(bench.admin, {limit, cursor}); });
  };
  const Page<Asset> all = listed(50, "");
  REQUIRE(all.items.size() == 2);
  const Asset& first = all.items[all.items[0].id == mesh.id ? 0 : 1];
  CHECK(first.name == "vase.obj");
  CHECK(first.owner == bench.student.name);
  CHECK(first.bytes == 4);
  CHECK(first.designs == std::vector<std::string>{design.id});
  CHECK(first.designs_total == 1);
  const Page<Asset> page = listed(1, "");
  CHECK(page.next_cursor == all.items[0].id);
  CHECK(listed(1, page.next_cursor).items.front().id == all.items[1].id);

  const auto remove = [&](const Principal& who, const std::string& id) {
    return bench.on([&](LiveService& s) { return s.designs.remove_asset(who, id); });
  };
  const std::string file = bench.folder() + "/assets/" + mesh.id;
  const Answer<void> used = remove(bench.admin, mesh.id);
  CHECK(used.error().kind == ProblemKind::StateConflict);
  CHECK(used.error().detail.find(design.id) != std::string::npos);
  CHECK(std::filesystem::exists(file));
  CHECK(remove(bench.student, grid.id).error().kind == ProblemKind::Forbidden);
  CHECK(remove(bench.admin, "sha256-" + std::string(64, '0')).error().kind ==
        ProblemKind::NotFound);
  REQUIRE(bench.on([&](LiveService& s) { return s.designs.remove(bench.student, design.id); }));
  REQUIRE(remove(bench.other_student, mesh.id));
  REQUIRE(remove(bench.student, mesh.id));
  CHECK_FALSE(std::filesystem::exists(file));
  REQUIRE(remove(bench.tutor, grid.id));
  CHECK(listed(50, "").items.empty());
}

TEST_CASE("a service in a year beyond 2262 keeps right times", "[daemon][service][clock]") {
  Pages bench;
  bench.stop();
  bench.options.wall_ms = [] { return TimeMs{10'000'000'000'000}; };  // 2286-11-20T17:46:40Z
  REQUIRE(bench.start().empty());
  const NewToken token = bench.token(Role::Operator, 60);
  CHECK(token.record.created == 10'000'000'000'000);
  CHECK(*token.record.expires == 10'000'000'060'000);
  CHECK(bench.who(token.text));
  CHECK(bench.add_design("late")->created == 10'000'000'000'000);
}

TEST_CASE("a session that opens one more than there may be is not the one that goes",
          "[daemon][service]") {
  Pages bench;
  const NewToken parent = bench.page(Pages::local());
  bench.skew_ms = 1000;
  // The parent is the first of these to expire.
  std::vector<NewToken> others;
  for (int k = 1; k < 32; ++k) others.push_back(bench.page(Pages::local()));
  const Answer<NewToken> child = bench.open(bench.word(bench.who(parent.text).value()));
  REQUIRE(child);
  CHECK(bench.who(child->text));
  CHECK(bench.who(parent.text));
  CHECK_FALSE(bench.who(others.front().text));
  CHECK(bench.sessions(Pages::local()).size() == 32);
}

TEST_CASE("sessions that come from one another are limited and none of them goes",
          "[daemon][service]") {
  Pages bench;
  std::vector<NewToken> chain{bench.page(Pages::local())};
  for (int k = 1; k < 32; ++k) chain.push_back(bench.page(chain.back()));
  const Answer<NewToken> more = bench.open(bench.word(bench.who(chain.back().text).value()));
  REQUIRE_FALSE(more);
  CHECK(more.error().kind == ProblemKind::QueueFull);
  CHECK(bench.who(chain.front().text));
  CHECK(bench.who(chain.back().text));
}

TEST_CASE("a one-time code is used up only when its session is stored",
          "[alone][daemon][service]") {
  Pages bench;
  const std::string word = bench.word(Pages::local());
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  sql("CREATE TRIGGER no_session BEFORE INSERT ON session BEGIN SELECT raise(ABORT, 'no'); END");
  CHECK_FALSE(bench.open(word));
  sql("DROP TRIGGER no_session");
  CHECK(bench.open(word));
  CHECK_FALSE(bench.open(word));
}

TEST_CASE("keys of requests move with the clock or not at all", "[alone][daemon][service][clock]") {
  Pages bench;
  bench.on([&](LiveService& s) {
    REQUIRE(s.operations.once(bench.tutor, {"key-0123456789abcdef", "same"},
                              [] { return Rendered{.status = 201, .body = "made"}; }));
  });
  bench.tick();
  const auto expires = [&] {
    return bench.on([&](LiveService&) {
      return bench.store().database().number("SELECT max(expires) FROM idem");
    });
  };
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  const std::int64_t before = expires();
  sql("CREATE TRIGGER no_clock BEFORE INSERT ON calendar BEGIN SELECT raise(ABORT, 'no'); END");
  bench.skew_ms = kYear_ms;
  for (int hour = 0; hour < 26; ++hour) {
    bench.monotonic_skew_ms += kHour_ms;
    bench.skew_ms += kHour_ms;
    bench.tick();
  }
  CHECK(expires() == before);
  sql("DROP TRIGGER no_clock");
  bench.tick();
  const std::int64_t moved = expires() - before;
  CHECK(moved > kYear_ms - kHour_ms);
  CHECK(moved < kYear_ms + kHour_ms);
}

}  // namespace service_access_test
