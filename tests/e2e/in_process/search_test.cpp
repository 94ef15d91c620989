// SPDX-License-Identifier: MIT
// Searches in a worker process, as popcutd has them made.
#include <atomic>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/planning/search/search_steps.hpp"
#include "daemon/planning/search/search_words.hpp"
#include "daemon/planning/search/thumbnail.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/planner_bench.hpp"
#include "tests/support/value.hpp"

namespace search_test {

using namespace popcut;
using namespace popcut::testing;
using daemon::CardSearchRequest;
using nlohmann::json;
using Kind = PlanningTask::Kind;

namespace {

constexpr const char* kModel =
    "sha256-0000000000000000000000000000000000000000000000000000000000000000";

struct SearchBench {
  Outcomes outcomes;
  std::unique_ptr<daemon::Planner> planner;

  explicit SearchBench(const PlanningLimits& limits = {}) {
    planner = daemon::make_planner(limits, worker_program());
  }
  static PlanningTask task(const std::string& mesh, CardSearchRequest request = {}) {
    request.model = kModel;
    request.name = "hall";
    PlanningTask task;
    task.kind = Kind::Search;
    task.design_text = mesh;
    task.options = {{planning::kSearchWords, planning::search_words(request)}};
    return task;
  }
  Result<PlanningOutcome> run(PlanningTask task) {
    const std::string name = std::to_string(++count_);
    planner->start(std::move(task), outcomes.slot(name));
    return outcomes.wait(name);
  }
  void refused(const std::string& mesh, const CardSearchRequest& request, const std::string& part) {
    const auto outcome = run(task(mesh, request));
    REQUIRE_FALSE(outcome);
    CHECK_THAT(message(outcome.error()), Catch::Contains(part));
    CHECK(message(outcome.error()).find(kModel) == std::string::npos);
  }

 private:
  int count_{};
};

CardSearchRequest small() {
  CardSearchRequest request;
  request.style = "facets";
  request.up = "z";
  request.mat = "100x100";
  request.effort = daemon::kLeastEffort;
  return request;
}

std::string hall(bool hole = false) {
  return testing::obj(testing::box_mesh({0, 0, 0}, {30, 60, 25}, hole));
}

}  // namespace

TEST_CASE("a worker finds the same cards of a model each time and draws each of them",
          "[daemon][planner][search]") {
  SearchBench bench;
  std::atomic<int> told{0};
  PlanningTask task = SearchBench::task(hall(), small());
  task.progress = [&](const daemon::PlanningPhase& phase) {
    CHECK(phase.done <= 1.0);
    ++told;
  };
  const auto first = bench.run(task);
  INFO(why(first));
  REQUIRE(first);
  CHECK(told > 0);
  CHECK(first->assets == std::vector<std::string>{kModel});
  const PlanningFile* const text = file_of(*first, planning::kFrontFile);
  REQUIRE(text);
  const auto front = value(planning::read_front(text->bytes));
  CHECK(planning::front_text(front) == text->bytes);
  REQUIRE_FALSE(front.cards.empty());
  CHECK(first->files.size() == 2 * front.cards.size() + 1);
  double seconds = 0.0, error = 1e9;
  for (std::size_t k = 0; k < front.cards.size(); ++k) {
    const daemon::FoundCardRecord& card = front.cards[k];
    CAPTURE(k, card.spec);
    CHECK(card.seconds >= seconds);
    CHECK(card.error < error);
    seconds = card.seconds, error = card.error;
    CHECK(card.folds > 0);
    const json spec = json::parse(card.spec);
    CHECK(spec["surface"] == json{{"type", "mesh"}, {"file", kModel}});
    CHECK(spec["name"] == "hall");
    const PlanningFile* const png =
        file_of(*first, planning::thumbnail_file(static_cast<int>(k) + 1));
    REQUIRE(png);
    REQUIRE(png->bytes.size() > 24);
    CHECK(png->bytes.starts_with("\x89PNG"));
    CHECK(static_cast<unsigned char>(png->bytes[18]) * 256 +
              static_cast<unsigned char>(png->bytes[19]) ==
          planning::kThumbnailWidth_px);
    const PlanningFile* const shown =
        file_of(*first, planning::lattice_file(static_cast<int>(k) + 1));
    REQUIRE(shown);
    CHECK(shown->bytes.starts_with("PCLB"));
  }
  CHECK(front.cards.back().error < 0.5);  // a hall is what cards are good at
  CHECK(front.recommended >= 1);
  const auto again = value(bench.run(SearchBench::task(hall(), small())));
  REQUIRE(again.files.size() == first->files.size());
  for (const PlanningFile& file : first->files)
    CHECK(file_of(again, file.name)->bytes == file.bytes);
}

TEST_CASE("a worker finds the cards of a GLB as of the same STL", "[daemon][planner][search]") {
  SearchBench bench;
  const TriangleMesh mesh = testing::box_mesh({0, 0, 0}, {30, 60, 25}, false);
  const auto front_of = [&](const std::string& bytes) {
    const auto outcome = bench.run(SearchBench::task(bytes, small()));
    INFO(why(outcome));
    REQUIRE(outcome);
    return file_of(*outcome, planning::kFrontFile)->bytes;
  };
  CHECK(front_of(testing::glb(mesh)) == front_of(testing::binary_stl(mesh)));
  bench.refused(testing::gltf(mesh, "mesh.bin"), small(), "keeps its mesh in mesh.bin beside it");
  bench.refused("\x89PNG\r\n\x1a\n" + std::string(200, '\0'), small(),
                "hall: is a PNG picture; give a 3D model");
}

TEST_CASE("a model with a hole is searched as it is seen and a note says so",
          "[daemon][planner][search]") {
  SearchBench bench;
  const auto outcome = bench.run(SearchBench::task(hall(true), small()));
  INFO(why(outcome));
  REQUIRE(outcome);
  const auto front = value(planning::read_front(file_of(*outcome, planning::kFrontFile)->bytes));
  REQUIRE_FALSE(front.notes.empty());
  CHECK_THAT(front.notes.front(), Catch::Contains("has holes"));
  for (const daemon::FoundCardRecord& card : front.cards) CHECK(card.style == "facets");
}

TEST_CASE("what is no model, or has no card, gives one sentence", "[daemon][planner][search]") {
  SearchBench bench;
  bench.refused("hello", small(), "");
  bench.refused("", small(), "");
  bench.refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", small(), "has no outside");
  std::string many = "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\n";
  for (int k = 0; k < 2'000'001; ++k) many += "f 1 2 3\n";
  bench.refused(many, small(), "at most 2000000 can be searched");
  CardSearchRequest quick = small();
  quick.max_minutes = 0.1;
  bench.refused(hall(), quick, "no card of it is cut within 0.1 minutes");
  CardSearchRequest on = small();
  on.mat = "no such mat";
  bench.refused(hall(), on, "/mat");
}

TEST_CASE(
    "a search in steps knows each candidate again that it wanted and each card that was judged",
    "[daemon][search]") {
  planning::WantedCards wanted;
  wanted.doing = "designing";
  const StyleChoice& any = style_choice("any");
  for (const auto& some :
       {usual_candidates(any, 1), broad_candidates(any, 1, 3), usual_candidates(any, 4)})
    wanted.candidates.insert(wanted.candidates.end(), some.begin(), some.end());
  Candidate& odd = wanted.candidates.emplace_back();
  odd.way = 7, odd.fill = 0.1, odd.hinge_mm3 = 1.0 / 3, odd.layers = 3, odd.kites = true;
  const auto again = value(planning::read_wanted(planning::wanted_text(wanted)));
  CHECK(again.candidates == wanted.candidates);

  std::vector<planning::JudgedCard> cards;
  for (const Candidate& candidate : wanted.candidates) {
    planning::JudgedCard& card = cards.emplace_back();
    card.candidate = candidate;
    card.judged = {std::numeric_limits<double>::infinity(), 0.1, false, true};
    card.why = "why", card.spec = "{}", card.shrunk = 0.9, card.rough = true;
    card.cost = {1.5, {1, 2}, 3, 4, {5, 6, 7, 8, 9, "hard"}, 10};
  }
  std::vector<planning::FinishedCard> finished(2);
  finished[0].candidate = odd, finished[0].why = "why";
  planning::FoundCard& found = finished[1].card.emplace();
  found.spec = "{}", found.cost.seconds = 1.0 / 3, found.figures.cover = 0.5;
  found.printed = {0.1, 0.2, 0.3};
  found.facts = {{1, 2}, 3.5, {{"no_unit", "none", {}, true}}};
  const auto memory = value(planning::read_memory(
      "{\"ways\": null, \"cards\": " + planning::judged_text(cards) +
      ", \"finished\": " + planning::finished_text(finished) + ", \"drawn\": []}"));
  REQUIRE(memory.cards.size() == cards.size());
  for (std::size_t k = 0; k < cards.size(); ++k) {
    const planning::JudgedCard& card = memory.cards[k];
    CHECK(card.candidate == cards[k].candidate);
    CHECK(card.judged.error == cards[k].judged.error);
    CHECK(card.judged.stays);
    CHECK(card.cost.wobble_mm == 10);
    CHECK(card.cost.hands.label == "hard");
  }
  CHECK(planning::judged_text(memory.cards) == planning::judged_text(cards));
  REQUIRE(memory.finished.size() == 2);
  CHECK(memory.finished[0].candidate == odd);
  CHECK_FALSE(memory.finished[0].card);
  CHECK(memory.finished[1].card->error() == found.error());
  CHECK(memory.finished[1].card->facts.warnings.at(0).spoils);
  CHECK(planning::finished_text(memory.finished) == planning::finished_text(finished));
}

TEST_CASE("the words of a search are read back and what is out of range is refused",
          "[daemon][planner][search]") {
  const CardSearchRequest request{.model = kModel,
                                  .name = "a \"vase\"",
                                  .mat = "12x12",
                                  .style = "conformal",
                                  .up = "-y",
                                  .front = "x",
                                  .marks = true,
                                  .max_minutes = 7.5,
                                  .effort = 0.3,
                                  .seed = 5,
                                  .max_folds = 25,
                                  .min_fold_mm = 5,
                                  .label = "medium",
                                  .plain = true};
  const auto read = value(planning::read_search_words(planning::search_words(request)));
  CHECK(planning::search_words(read) == planning::search_words(request));
  const auto refused = [&](const char* name, const json& value) {
    json words = json::parse(planning::search_words(request));
    words[name] = value;
    const auto wrong = planning::read_search_words(words.dump());
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().place == fmt::format("/{}", name));
  };
  refused("effort", 1000);
  refused("effort", 0);
  refused("up", "north");
  refused("style", "origami");
  refused("max_minutes", -1);
  refused("seed", -1);
  refused("max_folds", -1);
  refused("min_fold_mm", 1001);
  refused("label", "hardest");
  refused("plain", 1);
  refused("more", 1);
  CHECK(planning::design_name("models/Utah teapot.v2.obj") == "Utah teapot.v2");
  CHECK(planning::design_name("a\nb.obj") == "model");
  CHECK(planning::design_name("") == "model");
  CHECK(planning::design_name(std::string(500, 'x')) == "model");
}

TEST_CASE("figures that no search makes are refused", "[daemon][planner][search]") {
  daemon::SearchFront front;
  front.cards.push_back(
      {.style = "facets", .settings = "facets of 2 mm", .spec = "{\"popcut\":1}"});
  front.mat_mm = {300, 300};
  const std::string good = planning::front_text(front);
  REQUIRE(planning::read_front(good));
  const auto refused = [&](const char* pointer, const json& value) {
    json wrong = json::parse(good);
    wrong[json::json_pointer(pointer)] = value;
    INFO(pointer);
    CHECK_FALSE(planning::read_front(wrong.dump()));
  };
  refused("/cards", json::array());
  refused("/cards/0/spec", "[1, 2]");
  refused("/cards/0/spec", "{");
  refused("/cards/0/spec", "{\"a\":\"" + std::string(100'000, 'x') + "\"}");
  refused("/cards/0/error", -1);
  refused("/cards/0/seconds", 1e300);
  refused("/cards/0/seconds_range", json{1, -5});
  refused("/cards/0/settings", "two\nlines");
  refused("/cards/0/folds", 1.5);
  refused("/notes", json(200, "a note"));
  refused("/seen_share", 2);
  refused("/recommended", 2);
  refused("/more", 1);
}

TEST_CASE("a long search keeps neither plans nor checks waiting and can be cancelled",
          "[daemon][planner][search]") {
  SearchBench bench;
  CardSearchRequest forever;
  forever.effort = daemon::kMostEffort;
  const std::string teapot = testing::obj(testing::torus(40, 15, 60));
  const auto long_one =
      bench.planner->start(SearchBench::task(teapot, forever), bench.outcomes.slot("search"));
  bench.planner->start(SearchBench::task(teapot, forever), bench.outcomes.slot("waits"));
  PlanningTask plan;
  plan.design_text = text_of_file(source_file("examples/unit.json"));
  for (const Kind kind : {Kind::Plan, Kind::Check}) {
    plan.kind = kind;
    const auto made = bench.run(plan);
    INFO(why(made));
    CHECK(made);
  }
  CHECK(bench.outcomes.order().size() == 2);
  bench.planner->cancel(long_one + 1);
  CHECK(bench.outcomes.wait("waits").error().kind == ErrorKind::Refused);
  bench.planner->cancel(long_one);
  CHECK(bench.outcomes.wait("search").error().kind == ErrorKind::Refused);
}

TEST_CASE("a search that takes more than its limits says what to lower",
          "[daemon][planner][search]") {
  PlanningLimits limits;
  limits.cpu_s = 1;
  SearchBench bench(limits);
  CardSearchRequest forever;
  forever.effort = daemon::kMostEffort;
  bench.refused(testing::obj(testing::torus(40, 15, 60)), forever, "lower `effort`");
}

}  // namespace search_test
