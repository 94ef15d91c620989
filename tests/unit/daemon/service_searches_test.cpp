// SPDX-License-Identifier: MIT
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "tests/support/service_bench.hpp"

namespace service_searches_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using popcut::testing::write_text;

namespace {

namespace fs = std::filesystem;

std::string add_model(ServiceBench& bench, const std::string& bytes,
                      const std::string& name = "vase.obj") {
  return bench
      .on([&](LiveService& s) {
        const std::string path = bench.folder() + "/incoming/asset";
        write_text(path, bytes);
        return s.designs.add_asset(bench.student, {path, sha256_hex(bytes), bytes.size(), name});
      })
      .value()
      .id;
}

Answer<SearchRecord> ask(ServiceBench& bench, CardSearchRequest request,
                         std::optional<Principal> who = {}) {
  return bench.on(
      [&](LiveService& s) { return s.searches.request(who.value_or(bench.student), request); });
}

Answer<SearchRecord> find(ServiceBench& bench, const std::string& id) {
  return bench.on([&](LiveService& s) { return s.searches.find(bench.student, id); });
}

bool comes_to(ServiceBench& bench, const std::string& id, SearchState state) {
  return bench.wait([&] { return find(bench, id).value().state == state; });
}

Answer<void> remove(ServiceBench& bench, const Principal& who, const std::string& id) {
  return bench.on([&](LiveService& s) { return s.searches.remove(who, id); });
}

Answer<Design> pick(ServiceBench& bench, const std::string& id, int card,
                    const std::string& name = "") {
  return bench.told<Design>(
      [&](LiveService& s, auto done) { s.searches.pick(bench.student, id, card, name, done); });
}

}  // namespace

TEST_CASE("a search finds cards for a model and each becomes a design", "[daemon][service]") {
  ServiceBench bench;
  const std::string model = add_model(bench, "vase");
  const SearchRecord asked = ask(bench, {.model = model, .mat = "12x12", .effort = 0.1}).value();
  CHECK(asked.owner == bench.student.name);
  CHECK(asked.request.machine == "cameo3");
  CHECK(asked.request.material == "paper-220");
  CHECK(asked.request.name == "vase");
  REQUIRE(comes_to(bench, asked.id, SearchState::Found));
  CHECK(bench.planner.last_task().options.at("search").find("\"effort\":0.1") != std::string::npos);
  const SearchRecord found = find(bench, asked.id).value();
  REQUIRE(found.front.cards.size() == 2);
  CHECK(found.front.cards[1].seconds == 120);
  CHECK(found.front.cards[1].error < found.front.cards[0].error);
  CHECK(found.front.seen_share == 0.5);
  CHECK(found.doing.empty());
  const auto picture = [&](int card) {
    return bench.on([&](LiveService& s) { return s.searches.picture(asked.id, card); });
  };
  CHECK(read_whole(picture(2).value(), 100).value() == "picture of card 2");
  for (const int card : {0, 3}) CHECK(picture(card).error().kind == ProblemKind::NotFound);

  const Design design = pick(bench, asked.id, 2).value();
  CHECK(design.is_new);
  CHECK(design.name == "vase");
  CHECK(design.id == "sha256-" + sha256_hex(found.front.cards[1].spec));
  CHECK_FALSE(pick(bench, asked.id, 2, "another name")->is_new);
  CHECK(pick(bench, asked.id, 1, "small vase")->name == "small vase");
  CHECK(pick(bench, asked.id, 3).error().kind == ProblemKind::NotFound);
  CHECK(fs::is_empty(bench.folder() + "/incoming"));
  CHECK(remove(bench, bench.other_student, asked.id).error().kind == ProblemKind::Forbidden);
  CHECK(remove(bench, bench.student, asked.id));
  CHECK(find(bench, asked.id).error().kind == ProblemKind::NotFound);
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/searches"); }));
  CHECK(bench.on([&](LiveService& s) { return s.designs.find(bench.student, design.id); }));
}

TEST_CASE("the same search is made once and another seed is another search", "[daemon][service]") {
  ServiceBench bench;
  const std::string model = add_model(bench, "vase");
  const std::string first = ask(bench, {.model = model})->id;
  CHECK(ask(bench, {.model = model}, bench.other_student)->id == first);
  CHECK(ask(bench, {.model = model, .seed = 2})->id != first);
  CHECK(ask(bench, {.model = model, .material = "card-300"})->id != first);
  REQUIRE(comes_to(bench, first, SearchState::Found));
  CHECK(ask(bench, {.model = model})->id == first);
}

TEST_CASE("books, a front, marks and limits of folding are kept with a search",
          "[daemon][service]") {
  ServiceBench bench;
  const std::string model = add_model(bench, "slow");
  const std::string usual = ask(bench, {.model = model})->id;
  REQUIRE(bench.wait([&] { return bench.planner.last_task().options.contains("search"); }));
  const std::string book = ask(bench, {.model = model, .cards = 4, .marks = true})->id;
  const std::string house = ask(bench, {.model = model, .up = "z", .front = "-y"})->id;
  const CardSearchRequest easy{
      .model = model, .max_folds = 20, .min_fold_mm = 6.5, .label = "easy", .plain = true};
  const std::string hands = ask(bench, easy)->id;
  CHECK(std::set{usual, book, house, hands}.size() == 4);
  bench.crash();
  bench.planner.release();
  REQUIRE(bench.start() == "");
  for (const std::string& id : {usual, book, house, hands})
    REQUIRE(comes_to(bench, id, SearchState::Found));
  CHECK(find(bench, usual)->request.cards == 1);
  CHECK(find(bench, book)->request.cards == 4);
  CHECK(find(bench, book)->request.marks);
  CHECK(find(bench, house)->request.front == "-y");
  const CardSearchRequest kept = find(bench, hands)->request;
  CHECK(kept.max_folds == 20);
  CHECK(kept.min_fold_mm == 6.5);
  CHECK(kept.label == "easy");
  CHECK(kept.plain);
  CHECK(find(bench, usual)->request.label == "any");
  CHECK(find(bench, hands)->front.recommended == 1);
  CHECK(ask(bench, {.model = model, .cards = 4, .marks = true})->id == book);
}

TEST_CASE("a search that fails says why and is made again when it is asked for again",
          "[daemon][service]") {
  ServiceBench bench;
  const std::string model = add_model(bench, "bad");
  const std::string first = ask(bench, {.model = model})->id;
  REQUIRE(comes_to(bench, first, SearchState::Failed));
  CHECK(find(bench, first)->error.find("is not known") != std::string::npos);
  CHECK(pick(bench, first, 1).error().kind == ProblemKind::StateConflict);
  CHECK(ask(bench, {.model = model})->id != first);
}

TEST_CASE("a search is refused for what is no asset or no option", "[daemon][service]") {
  ServiceBench bench;
  const std::string model = add_model(bench, "vase");
  const std::string none = "sha256-" + std::string(64, 'a');
  CHECK(ask(bench, {.model = none}).error().kind == ProblemKind::NotFound);
  CHECK(ask(bench, {.model = model}, bench.viewer).error().kind == ProblemKind::Forbidden);
  const auto pointer = [&](const CardSearchRequest& request) {
    const auto refused = ask(bench, request);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().kind == ProblemKind::Validation);
    return refused.error().errors.at(0).pointer;
  };
  CHECK(pointer({.model = model, .mat = "no-such-mat"}) == "/mat");
  CHECK(pointer({.model = model, .machine = "cameo33"}) == "/machine");
  CHECK(pointer({.model = model, .material = "paper-22"}) == "/material");
  CHECK(pointer({.model = model, .device = "sim:nowhere"}) == "/device");
  CHECK(pointer({.model = model, .machine = "cricut-maker"}) == "/machine");
  CHECK(pointer({.model = model, .machine = "hpgl-generic", .mat = "300x300", .marks = true}) ==
        "/marks");
  CHECK(pointer({.model = model, .mat = "25x25", .marks = true}) == "/mat");
  CHECK(pointer({.model = model, .cards = 2}) == "/cards");
  CHECK(pointer({.model = model, .style = "facets", .cards = 6}) == "/style");
  CHECK(pointer({.model = model, .front = "y", .cards = 4}) == "/front");
  CHECK(pointer({.model = model, .up = "z", .front = "-z"}) == "/front");
}

TEST_CASE("a search that waits or runs can be deleted and the next begins", "[daemon][service]") {
  ServiceBench bench;
  const std::string running = ask(bench, {.model = add_model(bench, "slow 1")})->id;
  const std::string waiting = ask(bench, {.model = add_model(bench, "slow 2")})->id;
  const std::string last = ask(bench, {.model = add_model(bench, "quick")})->id;
  REQUIRE(bench.wait([&] { return bench.planner.started == 1; }));
  CHECK(find(bench, running)->doing == "reading the model");
  CHECK(find(bench, waiting)->doing.empty());
  CHECK(remove(bench, bench.student, waiting));
  CHECK(remove(bench, bench.tutor, running));
  CHECK(bench.planner.cancelled == 1);
  CHECK(comes_to(bench, last, SearchState::Found));
  CHECK(bench.planner.started == 2);
  CHECK_FALSE(fs::exists(bench.folder() + "/searches/" + running));
}

TEST_CASE("searches of one person do not keep another waiting and their number is limited",
          "[daemon][service]") {
  ServiceBench bench(false);
  bench.options.searches_each = 3;
  REQUIRE(bench.start() == "");
  std::vector<std::string> own;
  for (const char* model : {"slow 1", "slow 2", "slow 3"})
    own.push_back(ask(bench, {.model = add_model(bench, model)})->id);
  const std::string more = add_model(bench, "more");
  const auto refused = ask(bench, {.model = more});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ProblemKind::QueueFull);
  CHECK(refused.error().retry_after_s == 60);
  const std::string other = ask(bench, {.model = more}, bench.other_student)->id;
  CHECK(remove(bench, bench.student, own[0]));
  REQUIRE(comes_to(bench, other, SearchState::Found));
  CHECK(find(bench, own[2])->state == SearchState::Pending);
}

TEST_CASE("a search goes on after a restart and after a crash", "[daemon][service]") {
  ServiceBench bench;
  const std::string found = ask(bench, {.model = add_model(bench, "vase")})->id;
  REQUIRE(comes_to(bench, found, SearchState::Found));
  const std::string waiting = ask(bench, {.model = add_model(bench, "slow")})->id;
  REQUIRE(bench.wait([&] { return bench.planner.started == 2; }));
  bench.crash();
  bench.planner.release();
  REQUIRE(bench.start() == "");
  CHECK(find(bench, found)->front.cards.size() == 2);
  CHECK(comes_to(bench, waiting, SearchState::Found));
  bench.stop();
  REQUIRE(bench.start() == "");
  CHECK(find(bench, waiting)->front.cards.size() == 2);
}

TEST_CASE("all searches are listed page by page without their cards", "[daemon][service]") {
  ServiceBench bench;
  const std::string found = ask(bench, {.model = add_model(bench, "vase")})->id;
  REQUIRE(comes_to(bench, found, SearchState::Found));
  const std::string failed = ask(bench, {.model = add_model(bench, "bad")}, bench.tutor)->id;
  REQUIRE(comes_to(bench, failed, SearchState::Failed));
  const auto listed = [&](const PageRequest& request) {
    return bench.on([&](LiveService& s) { return s.searches.list(bench.admin, request); });
  };
  const Page<SearchRecord> first = listed({1, ""});
  REQUIRE(first.items.size() == 1);
  CHECK(first.items[0].id == found);
  CHECK(first.items[0].owner == bench.student.name);
  CHECK(first.items[0].state == SearchState::Found);
  CHECK(first.items[0].front.cards.empty());
  CHECK(first.next_cursor == found);
  const Page<SearchRecord> rest = listed({50, first.next_cursor});
  REQUIRE(rest.items.size() == 1);
  CHECK(rest.items[0].id == failed);
  CHECK(rest.items[0].owner == bench.tutor.name);
  CHECK(rest.items[0].error.find("is not known") != std::string::npos);
  CHECK(rest.next_cursor.empty());
}

TEST_CASE("removing a model removes its searches", "[daemon][service]") {
  ServiceBench bench;
  const std::string model = add_model(bench, "vase");
  const std::string search = ask(bench, {.model = model})->id;
  REQUIRE(comes_to(bench, search, SearchState::Found));
  REQUIRE(bench.on([&](LiveService& s) { return s.designs.remove_asset(bench.student, model); }));
  CHECK(find(bench, search).error().kind == ProblemKind::NotFound);
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/searches"); }));
}

TEST_CASE("a search whose failure cannot be stored yet holds up nobody",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string first = ask(bench, {.model = add_model(bench, "slow")})->id;
  REQUIRE(bench.wait([&] { return bench.planner.started == 1; }));
  const std::string second = ask(bench, {.model = add_model(bench, "vase")})->id;
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  sql("UPDATE search SET begun=10 WHERE begun=0; CREATE TRIGGER no_failure BEFORE UPDATE ON search "
      "WHEN new.state='failed' BEGIN SELECT raise(ABORT, 'not now'); END");
  bench.planner.release();
  CHECK(comes_to(bench, first, SearchState::Found));
  CHECK(find(bench, second)->state == SearchState::Pending);
  sql("DROP TRIGGER no_failure");
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(comes_to(bench, second, SearchState::Failed));
}

TEST_CASE("a search whose model is gone fails and holds up no other", "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string first = ask(bench, {.model = add_model(bench, "slow")})->id;
  REQUIRE(bench.wait([&] { return bench.planner.started == 1; }));
  const std::string model = add_model(bench, "vase");
  const std::string second = ask(bench, {.model = model})->id;
  const std::string third = ask(bench, {.model = add_model(bench, "jug")})->id;
  // As after the salvage of a damaged database.
  bench.on(
      [&](LiveService&) { bench.store().database().run("DELETE FROM asset WHERE id=?", model); });
  bench.planner.release();
  CHECK(comes_to(bench, first, SearchState::Found));
  CHECK(comes_to(bench, third, SearchState::Found));
  CHECK(find(bench, second)->state == SearchState::Failed);
  CHECK(find(bench, second)->error == "its model was deleted");
}

TEST_CASE("a search that cannot be stored at once is stored later and not made again",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string id = ask(bench, {.model = add_model(bench, "slow")})->id;
  REQUIRE(bench.wait([&] { return bench.planner.started == 1; }));
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  sql("CREATE TRIGGER none_found BEFORE UPDATE ON search WHEN new.state='found' BEGIN "
      "SELECT raise(ABORT, 'not now'); END");
  bench.planner.release();
  REQUIRE(bench.wait([&] {
    return bench.thread().turns(ServiceThread::Lane::Asking).longest().contains("search ended");
  }));
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(find(bench, id)->state == SearchState::Pending);
  sql("DROP TRIGGER none_found");
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(comes_to(bench, id, SearchState::Found));
  CHECK(bench.planner.started == 1);
}

}  // namespace service_searches_test
