// SPDX-License-Identifier: MIT
// Tablets that are let in by a code: once, in time, and with no more than whoever let them in has.
#include <algorithm>
#include <set>

#include <unistd.h>

#include <catch2/catch.hpp>

#include "daemon/store/schema.hpp"
#include "tests/support/service_bench.hpp"

namespace service_pairing_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::test::ServiceBench;

namespace {

constexpr std::int64_t kMinute_ms = 60'000;
constexpr std::int64_t kDay_ms = 24 * 60 * kMinute_ms;
constexpr uid_t kUser = 4242;
constexpr gid_t kGroup = 4343;

class Tablets : public ServiceBench {
 public:
  Tablets() : ServiceBench(false) {
    options.users.groups[kGroup] = Role::Operator;
    REQUIRE(start().empty());
  }
  Answer<NewPairing> ask(const std::string& name = "tablet by the window",
                         const std::string& from = "10.0.0.1") {
    return on([&](LiveService& s) { return s.access.ask_pairing(name, from); });
  }
  Answer<AllowedPairing> allow(const Principal& who, const std::string& code, Role role) {
    return on([&](LiveService& s) { return s.access.allow_pairing(who, code, role); });
  }
  Answer<std::optional<NewToken>> collect(const std::string& secret) {
    return on([&](LiveService& s) { return s.access.collect_pairing(secret); });
  }
  std::optional<Principal> who(const std::string& text) {
    return on([&](LiveService& s) { return s.access.authenticate(text); });
  }
  NewToken token(Role role) {
    return on(
        [&](LiveService& s) { return s.access.create_token(admin, "lab", role, {}).value(); });
  }
  // A tablet that `who` let in.
  NewToken tablet(const Principal& whose, Role role, const std::string& name = "tablet") {
    const NewPairing asked = ask(name).value();
    REQUIRE(allow(whose, asked.code, role));
    return collect(asked.secret).value().value();
  }
  void pass(std::int64_t ms) {
    monotonic_skew_ms += ms;
    skew_ms += ms;
  }
  static Principal local() {
    return {
        .name = "uid:4242" + machine(), .role = Role::Operator, .user = LocalUser{kUser, {kGroup}}};
  }
};

bool is_gone(const Answer<std::optional<NewToken>>& answer) {
  return !answer && answer.error().kind == ProblemKind::NotFound;
}

}  // namespace

TEST_CASE("a tablet gets a session once a person has typed its code, and once",
          "[daemon][service][pairing]") {
  Tablets bench;
  const NewToken lab = bench.token(Role::Operator);
  const Principal ana = bench.who(lab.text).value();
  const NewPairing asked = bench.ask().value();
  CHECK(asked.code.size() == 6);
  CHECK(asked.code.find_first_not_of("ABCDEFGHJKMNPQRSTUVWXYZ23456789") == std::string::npos);
  CHECK(asked.secret.size() == 43);
  CHECK(asked.expires > bench.options.wall_ms());
  for (int i = 0; i < 3; ++i) {
    const auto waiting = bench.collect(asked.secret);
    REQUIRE(waiting);
    CHECK_FALSE(waiting->has_value());
  }
  const AllowedPairing allowed = bench.allow(ana, asked.code, Role::Viewer).value();
  CHECK(allowed.name == "tablet by the window");
  CHECK(allowed.role == Role::Viewer);
  // The code is used, also for its own tablet.
  CHECK(bench.allow(ana, asked.code, Role::Operator).error().kind == ProblemKind::NotFound);
  const NewToken session = bench.collect(asked.secret).value().value();
  CHECK(session.record.role == Role::Viewer);
  const Principal tablet = bench.who(session.text).value();
  CHECK(tablet.name == ana.name);
  CHECK(tablet.role == Role::Viewer);
  CHECK(is_gone(bench.collect(asked.secret)));
  const auto record =
      bench.on([&](LiveService& s) { return s.access.session_of(tablet.credential); });
  REQUIRE(record);
  CHECK(record->name == "tablet by the window");
  CHECK(record->root == ana.name);
  CHECK_FALSE(bench.on([&](LiveService& s) { return s.access.session_of(ana.credential); }));
}

TEST_CASE("a code is taken as people type it and no other is", "[daemon][service][pairing]") {
  Tablets bench;
  const auto typed = [&](const std::function<std::string(std::string)>& how) {
    const NewPairing asked = bench.ask().value();
    return bench.allow(bench.admin, how(asked.code), Role::Viewer).has_value();
  };
  CHECK(typed([](std::string code) { return code; }));
  CHECK(typed([](std::string code) {
    for (char& c : code)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return code;
  }));
  CHECK(typed([](const std::string& code) { return code.substr(0, 3) + " - " + code.substr(3); }));
  for (const char* wrong : {"", "A", "AAAAAAA", "' OR 1=1", "\xF0\x9F\x98\x80", "------"})
    CHECK_FALSE(typed([&](const std::string&) { return std::string(wrong); }));
  CHECK_FALSE(typed([](std::string code) {
    code.back() = code.back() == 'A' ? 'B' : 'A';
    return code;
  }));
  CHECK_FALSE(typed([](const std::string& code) { return code + "A"; }));
  CHECK(is_gone(bench.collect("")));
  CHECK(is_gone(bench.collect("nonsense")));
}

TEST_CASE("a code and what comes of it last five minutes each", "[daemon][service][pairing]") {
  Tablets bench;
  const NewPairing late = bench.ask().value();
  bench.pass(5 * kMinute_ms - 1000);
  CHECK(bench.collect(late.secret).has_value());
  bench.pass(2000);
  CHECK(bench.allow(bench.admin, late.code, Role::Viewer).error().kind == ProblemKind::NotFound);
  CHECK(is_gone(bench.collect(late.secret)));
  const NewPairing asked = bench.ask().value();
  bench.pass(4 * kMinute_ms);
  REQUIRE(bench.allow(Tablets::local(), asked.code, Role::Viewer));
  bench.pass(4 * kMinute_ms);  // it comes for its session a little later
  CHECK(bench.collect(asked.secret).value().has_value());
  const NewPairing left = bench.ask().value();
  REQUIRE(bench.allow(Tablets::local(), left.code, Role::Viewer));
  bench.pass(6 * kMinute_ms);
  CHECK(is_gone(bench.collect(left.secret)));
  // The wall's clock has nothing to do with it.
  const NewPairing jumped = bench.ask().value();
  bench.skew_ms += 365 * kDay_ms;
  CHECK(bench.collect(jumped.secret).has_value());
}

TEST_CASE("a tablet is never more than whoever let it in, then or later",
          "[daemon][service][pairing]") {
  Tablets bench;
  for (const Role own : {Role::Viewer, Role::Submitter, Role::Operator, Role::Admin}) {
    const Principal who = bench.who(bench.token(own).text).value();
    for (const Role wanted : {Role::Viewer, Role::Submitter, Role::Operator, Role::Admin}) {
      CAPTURE(name_of(own), name_of(wanted));
      const NewPairing asked = bench.ask().value();
      const auto allowed = bench.allow(who, asked.code, wanted);
      CHECK(allowed.has_value() == (wanted <= own));
      if (!allowed) {
        CHECK(allowed.error().kind == ProblemKind::Forbidden);
        // The code waits for somebody who may.
        REQUIRE(bench.allow(who, asked.code, own));
      }
      CHECK(bench.collect(asked.secret).value()->record.role == std::min(own, wanted));
    }
  }
  // A tablet lets in others, and those are no more than it.
  const NewToken lab = bench.token(Role::Admin);
  const NewToken first = bench.tablet(bench.who(lab.text).value(), Role::Submitter);
  const Principal tablet = bench.who(first.text).value();
  CHECK(bench.allow(tablet, bench.ask()->code, Role::Operator).error().kind ==
        ProblemKind::Forbidden);
  const NewToken second = bench.tablet(tablet, Role::Submitter);
  CHECK(bench.who(second.text)->role == Role::Submitter);
  // Neither by a page that it opens.
  const NewToken page = bench.on([&](LiveService& s) {
    return s.access.open_session(s.access.create_one_shot(tablet).value()).value();
  });
  CHECK(page.record.role == Role::Submitter);
  CHECK(bench.who(page.text)->role == Role::Submitter);
  CHECK(bench
            .on([&](LiveService& s) {
              return s.access.create_token(bench.who(page.text).value(), "x", Role::Viewer, {});
            })
            .error()
            .kind == ProblemKind::Forbidden);
}

TEST_CASE("a tablet follows the role of the user who let it in, down and not up",
          "[daemon][service][pairing]") {
  Tablets bench;
  const NewToken low = bench.tablet(Tablets::local(), Role::Submitter);
  const NewToken high = bench.tablet(Tablets::local(), Role::Operator);
  const auto set = [&](std::optional<Role> role) {
    LocalUsers users;
    if (role) users.groups[kGroup] = *role;
    bench.options.users = users;
    bench.on([&](LiveService& s) { s.retune({.users = users}); });
  };
  set(Role::Viewer);
  CHECK(bench.who(low.text)->role == Role::Viewer);
  CHECK(bench.who(high.text)->role == Role::Viewer);
  set(Role::Admin);
  CHECK(bench.who(low.text)->role == Role::Submitter);
  CHECK(bench.who(high.text)->role == Role::Operator);
  bench.stop();
  REQUIRE(bench.start().empty());
  CHECK(bench.who(low.text)->role == Role::Submitter);
  set(std::nullopt);
  CHECK_FALSE(bench.who(low.text));
  CHECK_FALSE(bench.who(high.text));
  // Lowered between the code and the session: what counts is what the user may then.
  set(Role::Operator);
  const NewPairing asked = bench.ask().value();
  REQUIRE(bench.allow(Tablets::local(), asked.code, Role::Operator));
  set(Role::Viewer);
  CHECK(bench.collect(asked.secret).value()->record.role == Role::Viewer);
}

TEST_CASE("a tablet ends with its root and with the page that let it in",
          "[daemon][service][pairing]") {
  Tablets bench;
  const NewToken lab = bench.token(Role::Operator);
  const Principal owner = bench.who(lab.text).value();
  const NewToken of_token = bench.tablet(owner, Role::Viewer);
  const NewToken page = bench.on([&](LiveService& s) {
    return s.access.open_session(s.access.create_one_shot(owner).value()).value();
  });
  const NewToken of_page = bench.tablet(bench.who(page.text).value(), Role::Viewer);
  const NewPairing waiting = bench.ask().value();
  REQUIRE(bench.allow(bench.who(page.text).value(), waiting.code, Role::Viewer));
  int ended = 0;
  bench.on([&](LiveService& s) { s.access.on_access_change([&] { ++ended; }); });
  REQUIRE(bench.on([&](LiveService& s) {
    return s.access.close_session(s.access.authenticate(page.text).value());
  }));
  CHECK_FALSE(bench.who(of_page.text));
  CHECK(is_gone(bench.collect(waiting.secret)));
  CHECK(bench.who(of_token.text));
  CHECK(ended == 1);  // its streams are looked at again
  const NewPairing too_late = bench.ask().value();
  REQUIRE(bench.allow(owner, too_late.code, Role::Viewer));
  REQUIRE(
      bench.on([&](LiveService& s) { return s.access.delete_token(bench.admin, lab.record.id); }));
  CHECK_FALSE(bench.who(of_token.text));
  CHECK(is_gone(bench.collect(too_late.secret)));
  // Nobody sees in a tablet that ended more than that it did.
  CHECK(bench.on([&](LiveService& s) { return s.access.sessions(bench.admin); }).empty());
}

TEST_CASE("a tablet that waits does not outlive popcutd and one that has its session does",
          "[daemon][service][pairing]") {
  Tablets bench;
  const NewToken tablet = bench.tablet(Tablets::local(), Role::Viewer);
  const NewPairing asked = bench.ask().value();
  const NewPairing allowed = bench.ask().value();
  REQUIRE(bench.allow(Tablets::local(), allowed.code, Role::Viewer));
  const bool crashes = GENERATE(false, true);
  if (crashes)
    bench.crash();
  else
    bench.stop();
  REQUIRE(bench.start().empty());
  CHECK(is_gone(bench.collect(asked.secret)));
  CHECK(is_gone(bench.collect(allowed.secret)));
  CHECK(bench.allow(Tablets::local(), asked.code, Role::Viewer).error().kind ==
        ProblemKind::NotFound);
  REQUIRE(bench.who(tablet.text));
  CHECK(bench.who(tablet.text)->role == Role::Viewer);
}

TEST_CASE("twenty tablets wait and no more, and no two show the same code",
          "[daemon][service][pairing]") {
  Tablets bench;
  std::set<std::string> codes, secrets;
  std::string first;
  for (int i = 0; i < 20; ++i) {
    const NewPairing asked = bench.ask("tablet", "10.0.0." + std::to_string(i)).value();
    if (i == 0) first = asked.code;
    codes.insert(asked.code);
    secrets.insert(asked.secret);
  }
  CHECK(codes.size() == 20);
  CHECK(secrets.size() == 20);
  const auto full = bench.ask("tablet", "10.0.1.1");
  REQUIRE_FALSE(full);
  CHECK(full.error().kind == ProblemKind::Unavailable);
  CHECK(full.error().retry_after_s);
  // Those that are there go on.
  CHECK(bench.allow(Tablets::local(), first, Role::Viewer));
  CHECK_FALSE(bench.ask("tablet", "10.0.1.1"));  // it has not come for its session
  bench.pass(6 * kMinute_ms);
  CHECK(bench.ask());
  for (const std::string& name : {std::string(), std::string(481, 'x')})
    CHECK(bench.ask(name).error().kind == ProblemKind::Validation);
}

TEST_CASE("who asks for codes again and again keeps nobody else out",
          "[daemon][service][pairing]") {
  Tablets bench;
  const NewPairing ana = bench.ask("tablet of Ana", "10.0.0.1").value();
  const NewPairing let_in = bench.ask("let in", "10.0.0.9").value();
  REQUIRE(bench.allow(Tablets::local(), let_in.code, Role::Viewer));
  NewPairing flood = bench.ask("flood", "10.0.0.9").value();
  const NewPairing oldest = flood;
  for (int i = 0; i < 100; ++i) {
    const auto next = bench.ask("flood", "10.0.0.9");
    REQUIRE(next);
    flood = *next;
  }
  // A tablet elsewhere, and one more, find room; of who asked so often the oldest codes ended.
  const NewPairing ben = bench.ask("tablet of Ben", "10.0.0.2").value();
  CHECK(is_gone(bench.collect(oldest.secret)));
  for (const NewPairing& one : {ana, ben, flood}) {
    CHECK_FALSE(bench.collect(one.secret).value());
    CHECK(bench.allow(Tablets::local(), one.code, Role::Viewer));
    CHECK(bench.collect(one.secret).value());
  }
  CHECK(bench.collect(let_in.secret).value());
}

TEST_CASE("whatever a tablet calls itself is its name and nothing else",
          "[daemon][service][pairing]") {
  Tablets bench;
  const std::string hostile = "<img src=x onerror=alert(1)>'; DROP TABLE session; --\xE2\x80\xAE";
  const NewToken tablet = bench.tablet(Tablets::local(), Role::Viewer, hostile);
  CHECK(bench.on([&](LiveService& s) { return s.access.sessions(bench.admin); }).at(0).name ==
        hostile);
  CHECK(bench.who(tablet.text));
}

}  // namespace service_pairing_test
