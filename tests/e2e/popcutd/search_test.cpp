// SPDX-License-Identifier: MIT
// Cards for a model from a real popcutd: what popcut auto finds, picked, planned and printed; and
// over the end of popcutd.
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"
#include "tests/support/running_daemon.hpp"

namespace search_test {

using namespace popcut::testing;
using popcut::testing::box_mesh;
using popcut::testing::obj;
using Json = nlohmann::json;

namespace {

std::string put(RunningDaemon& desk, const std::string& target, const std::string& bytes,
                const std::string& type = "application/json") {
  const auto made = desk.ask("POST", target, bytes, type);
  INFO(made.body);
  REQUIRE((made.status >= 200 && made.status < 300));
  return Json::parse(made.body).at("id");
}

std::string add_hall(RunningDaemon& desk, double high = 25) {
  return put(desk, "/v1/assets?name=hall.obj", obj(box_mesh({0, 0, 0}, {30, 60, high}, false)),
             "application/octet-stream");
}

Json found(RunningDaemon& desk, const std::string& id) {
  REQUIRE(happens([&] { return desk.get("/v1/searches/" + id)["state"] != "pending"; }, 900));
  return desk.get("/v1/searches/" + id);
}

/// The plan of a design with marks on a mat, once it is made.
std::string planned_with_marks(RunningDaemon& desk, const std::string& design,
                               const std::string& mat) {
  const Json wanted{{"machine", "cameo3"}, {"options", {{"marks", true}, {"mat", mat}}}};
  const std::string plan = put(desk, "/v1/designs/" + design + "/plan", wanted.dump());
  REQUIRE(happens([&] { return desk.get("/v1/plans/" + plan)["state"] != "pending"; }));
  const Json planned = desk.get("/v1/plans/" + plan);
  INFO(planned.dump().substr(0, 800));
  REQUIRE(planned["state"] == "planned");
  return plan;
}

const Json kSmall{{"effort", 0.01}, {"style", "facets"}, {"up", "z"}, {"mat", "150x150"}};

}  // namespace

TEST_CASE("popcutd finds the cards of popcut auto, and a picked one is planned and printed",
          "[popcutd][search]") {
  RunningDaemon desk;
  desk.open();
  const std::string model = add_hall(desk);
  const std::string id = put(desk, "/v1/assets/" + model + "/search", kSmall.dump());
  const Json search = found(desk, id);
  INFO(search.dump().substr(0, 800));
  REQUIRE(search["state"] == "found");
  const std::filesystem::path folder = desk.daemon().folder().path();
  write_file(folder / "hall.obj", obj(box_mesh({0, 0, 0}, {30, 60, 25}, false)));
  const Ran ran = run_program(
      {popcut_program(), "auto", "hall.obj", "--effort", "0.01", "--style", "facets", "--up", "z",
       "--machine", "cameo3", "--mat", "150x150", "-q", "--json", "-o", "cards"},
      folder);
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const Json alone = Json::parse(ran.out);
  REQUIRE(search["cards"].size() == alone["cards"].size());
  for (std::size_t k = 0; k < alone["cards"].size(); ++k)
    for (const char* figure : {"error", "seconds", "folds", "cut_mm", "sheet_mm"})
      CHECK(search["cards"][k][figure] == alone["cards"][k][figure]);
  CHECK(search["tried"]["designed"] == alone["tried"]["designed"]);
  CHECK(fmt::format("card-{:02}", search["recommended"].get<int>()) == alone["recommended"]);

  const std::string of_card = fmt::format("/v1/searches/{}/cards/{}", id, search["cards"].size());
  const auto png = desk.ask("GET", of_card + ".png");
  CHECK(png.status == 200);
  CHECK(png.body.starts_with("\x89PNG"));
  const std::string design = put(desk, of_card + "/design", R"({"name": "my hall"})");
  CHECK(desk.get("/v1/designs/" + design)["name"] == "my hall");
  CHECK(Json::parse(desk.ask("GET", "/v1/designs/" + design + "/content").body) ==
        search["cards"].back()["spec"]);
  const std::string plan = planned_with_marks(desk, design, "12x12");
  const auto page = desk.ask("GET", "/v1/plans/" + plan + "/sheets/1/artwork.pdf?dpi=50");
  CHECK(page.status == 200);
  CHECK(page.body.starts_with("%PDF"));
}

TEST_CASE("popcutd finds the books of popcut auto, and a picked one is planned card by card",
          "[popcutd][search]") {
  RunningDaemon desk;
  desk.open();
  const std::string model = add_hall(desk);
  Json wanted = kSmall;
  wanted["cards"] = 4, wanted["marks"] = true, wanted["mat"] = "150x150";
  const std::string id = put(desk, "/v1/assets/" + model + "/search", wanted.dump());
  const Json search = found(desk, id);
  INFO(search.dump().substr(0, 1200));
  REQUIRE(search["state"] == "found");
  CHECK(search["book"] == Json{{"cards", 4}});
  CHECK(search["marks"] == true);
  CHECK(search["front"] == "any");
  const std::filesystem::path folder = desk.daemon().folder().path();
  write_file(folder / "hall.obj", obj(box_mesh({0, 0, 0}, {30, 60, 25}, false)));
  const Ran ran = run_program({popcut_program(), "auto",   "hall.obj", "--effort", "0.01",
                               "--style",        "facets", "--up",     "z",        "--machine",
                               "cameo3",         "--mat",  "150x150",  "--cards",  "4",
                               "--marks",        "-q",     "--json",   "-o",       "books"},
                              folder);
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const Json alone = Json::parse(ran.out);
  REQUIRE(search["cards"].size() == alone["cards"].size());
  for (std::size_t k = 0; k < alone["cards"].size(); ++k)
    for (const char* figure : {"error", "seconds", "folds", "cut_mm", "sheet_mm", "page_mm"})
      CHECK(search["cards"][k][figure] == alone["cards"][k][figure]);

  const Json& best = search["cards"].back();
  CHECK(best["spec"]["book"]["cards"] == 4);
  const std::string of_book = fmt::format("/v1/searches/{}/cards/{}", id, search["cards"].size());
  CHECK(desk.ask("GET", of_book + ".png").body.starts_with("\x89PNG"));
  const std::string design = put(desk, of_book + "/design", "{}");
  const Json planned = desk.get("/v1/plans/" + planned_with_marks(desk, design, "150x150"));
  CHECK(planned["sheets_total"] == 4);
  const double lines_mm = best["cut_mm"].get<double>() + best["fold_mm"].get<double>();
  CHECK_THAT(planned["length_mm"].get<double>(), Catch::WithinRel(lines_mm, 0.01));
}

TEST_CASE("popcutd turns the model's front out of the card as popcut auto does",
          "[popcutd][search]") {
  RunningDaemon desk;
  desk.open();
  const std::string model = add_hall(desk);
  Json wanted = kSmall;
  wanted["front"] = "-x", wanted["marks"] = true;
  const Json search = found(desk, put(desk, "/v1/assets/" + model + "/search", wanted.dump()));
  INFO(search.dump().substr(0, 1200));
  REQUIRE(search["state"] == "found");
  CHECK(search["book"].is_null());
  const std::filesystem::path folder = desk.daemon().folder().path();
  write_file(folder / "hall.obj", obj(box_mesh({0, 0, 0}, {30, 60, 25}, false)));
  const Ran ran = run_program(
      {popcut_program(), "auto",    "hall.obj", "--effort", "0.01",    "--style",   "facets",
       "--up",           "z",       "--front",  "-x",       "--marks", "--machine", "cameo3",
       "--mat",          "150x150", "-q",       "--json",   "-o",      "cards"},
      folder);
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const Json alone = Json::parse(ran.out);
  REQUIRE(search["cards"].size() == alone["cards"].size());
  for (std::size_t k = 0; k < alone["cards"].size(); ++k) {
    for (const char* figure : {"error", "seconds", "sheet_mm"})
      CHECK(search["cards"][k][figure] == alone["cards"][k][figure]);
    CHECK(search["cards"][k]["page_mm"].is_null());
  }
}

TEST_CASE("a search goes on after popcutd was killed, and is removed with its model",
          "[popcutd][search]") {
  RunningDaemon desk;
  desk.open();
  const std::string model = add_hall(desk), other = add_hall(desk, 40);
  const std::string running =
      put(desk, "/v1/assets/" + model + "/search",
          R"({"effort": 0.02, "style": "facets", "up": "z", "mat": "150x150"})");
  const std::string waiting = put(desk, "/v1/assets/" + other + "/search", kSmall.dump());
  REQUIRE(happens([&] {
    const Json now = desk.get("/v1/searches/" + running);
    return now["state"] != "pending" || !now["progress"].is_null();
  }));
  desk.daemon().signal(SIGKILL);
  (void)desk.daemon().wait();
  desk.open();
  CHECK(found(desk, running)["state"] == "found");
  CHECK(found(desk, waiting)["state"] == "found");
  CHECK(desk.ask("DELETE", "/v1/assets/" + model).status == 204);
  CHECK(desk.ask("GET", "/v1/searches/" + running).status == 404);
  CHECK(desk.ask("DELETE", "/v1/searches/" + waiting).status == 204);
  CHECK(happens([&] { return std::filesystem::is_empty(desk.daemon().state() + "/searches"); }));
}

TEST_CASE("a search is refused with the place of what is wrong", "[popcutd][search]") {
  RunningDaemon desk;
  desk.open();
  const std::string model = add_hall(desk);
  const auto refused = [&](const std::string& body, const std::string& pointer) {
    CAPTURE(body);
    const auto answer = desk.ask("POST", "/v1/assets/" + model + "/search", body);
    CHECK(answer.status == 422);
    CHECK(Json::parse(answer.body)["errors"].at(0)["pointer"] == pointer);
  };
  refused(R"({"effort": 1000})", "/effort");
  refused(R"({"effort": 0})", "/effort");
  refused(R"({"max_minutes": "ten"})", "/max_minutes");
  refused(R"({"max_folds": 0})", "/max_folds");
  refused(R"({"min_fold_mm": -1})", "/min_fold_mm");
  refused(R"({"label": "hardest"})", "/label");
  refused(R"({"plain": "yes"})", "/plain");
  refused(R"({"style": "origami"})", "/style");
  refused(R"({"up": "w"})", "/up");
  refused(R"({"seed": -1})", "/seed");
  refused(R"({"mat": "no-such-mat"})", "/mat");
  refused(R"({"machine": "cameo33"})", "/machine");
  refused(R"({"material": "papyrus"})", "/material");
  refused(R"({"efort": 1})", "/efort");
  refused(R"({"cards": 2})", "/cards");
  refused(R"({"cards": 13})", "/cards");
  refused(R"({"cards": "4"})", "/cards");
  refused(R"({"cards": 6, "style": "facets"})", "/style");
  refused(R"({"cards": 4, "front": "x"})", "/front");
  refused(R"({"up": "z", "front": "-z"})", "/front");
  refused(R"({"front": "w"})", "/front");
  refused(R"({"marks": "yes"})", "/marks");
  refused(R"({"marks": true, "machine": "hpgl-generic", "mat": "300x300"})", "/marks");
  refused(R"({"machine": "cricut-maker"})", "/machine");
  CHECK(desk.ask("POST", "/v1/assets/sha256-0/search", "{}").status == 404);
  const std::string text =
      put(desk, "/v1/assets?name=a.txt", "no mesh at all", "application/octet-stream");
  const std::string failed = put(desk, "/v1/assets/" + text + "/search", "{}");
  const Json why = found(desk, failed);
  CHECK(why["state"] == "failed");
  CHECK_FALSE(why["error"].get<std::string>().empty());
  CHECK(desk.ask("GET", "/v1/searches/" + failed + "/cards/1.png").status == 409);
}

}  // namespace search_test
