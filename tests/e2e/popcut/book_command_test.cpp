// SPDX-License-Identifier: MIT
#include <filesystem>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"

namespace book_command_test {

using namespace popcut::testing;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

using Bench = CommandBench;

/// A book of a ball that stands beside the spine.
json ball_spec(int cards) {
  return json::parse(
      R"({"popcut":1,"name":"ball","surface":{"type":"mesh","file":"ball.stl"},"rotate_deg":[0,0,0],
          "translate_mm":[6,38,0],"units_per_slice":5,"slices":14,"widths_mm":6,
          "book":{"cards":)" +
      std::to_string(cards) + "}}");
}

void write_ball(const Bench& bench, int cards) {
  write_file(bench.temp / "ball.stl",
             popcut::testing::binary_stl(popcut::testing::icosphere(40, 3)));
  bench.write("ball.json", ball_spec(cards));
}

}  // namespace

TEST_CASE("a book is designed, verified, compared, planned and opened by its folder",
          "[cli][e2e][book]") {
  const Bench bench;
  write_ball(bench, 4);
  const Ran made = bench.popcut(
      {"design", "ball.json", "-o", "out", "--formats", "fold,svg,glb,picture,report"});
  CAPTURE(made.err);
  REQUIRE(made.exit == 0);
  CHECK(says(made.err, "a book of 4 cards, each open to 90 degrees"));
  for (const char* file : {"book.json", "book.glb", "book.svg", "card-01/pattern.fold",
                           "card-04/pattern.svg", "card-04/report.json"})
    CHECK(fs::exists(bench.temp / ("out/" + std::string(file))));
  const json book = bench.read_json("out/book.json");
  CHECK(book.at("degrees_of_freedom") == json({1, 1, 1, 1}));
  CHECK(book.at("fit").at("share_within").at("5_percent") > 0.94);
  CHECK(book.at("fit").at("target_to_structure_mean_share") < 0.017);
  CHECK(book.at("closed_mm") < book.at("page_mm").at(0));

  const Ran verified = bench.popcut({"verify", "out", "--json"});
  REQUIRE(verified.exit == 0);
  const json report = json::parse(verified.out);
  CHECK(report.at("ok") == true);
  REQUIRE(report.at("cards").size() == 4);
  for (const json& card : report.at("cards")) CHECK(card.at("degrees_of_freedom") == 1);
  CHECK(bench.popcut({"verify", "out/book.json", "-q"}).exit == 0);

  // By its folder, by its cards, and against the design: the same model in the same place.
  const Ran by_folder = bench.popcut({"compare", "out", "ball.stl", "--no-cost", "--json"});
  CAPTURE(by_folder.err);
  REQUIRE(by_folder.exit == 0);
  const Ran by_cards =
      bench.popcut({"compare", "out/card-01/pattern.fold", "out/card-02/pattern.fold",
                    "out/card-03/pattern.fold", "out/card-04/pattern.fold", "ball.stl", "--no-cost",
                    "--around", "--json"});
  REQUIRE(by_cards.exit == 0);
  const Ran by_spec = bench.popcut({"compare", "out", "ball.json", "--no-cost", "--json"});
  CAPTURE(by_spec.err);
  REQUIRE(by_spec.exit == 0);
  const double error = json::parse(by_folder.out).at("error");
  CHECK(json::parse(by_cards.out).at("error") == error);
  CHECK(json::parse(by_spec.out).at("error") == Approx(error).margin(0.01));
  CHECK(error < 0.6);
  // A card in the wrong place is farther off.
  const Ran mixed = bench.popcut({"compare", "out/card-03/pattern.fold", "out/card-04/pattern.fold",
                                  "out/card-01/pattern.fold", "out/card-02/pattern.fold",
                                  "ball.stl", "--move", "6,54.5,0", "--no-cost", "--json"});
  REQUIRE(mixed.exit == 0);
  CHECK(json::parse(mixed.out).at("error") > error + 0.05);

  const Ran planned = bench.popcut({"plan", "out", "-o", "sheets", "--json"});
  REQUIRE(planned.exit == 0);
  const json plan = json::parse(planned.out);
  CHECK(plan.at("layout").at("pieces") == 4);
  CHECK(plan.at("layout").at("tabs") == 0);
  // Each card is named with the sheet that it is on, once, and lies inside the sheet.
  std::string names;
  for (std::size_t k = 0; k < plan.at("sheets").size(); ++k) {
    const json& sheet = plan.at("sheets")[k];
    CHECK(sheet.at("parts").size() == sheet.at("pieces").size());
    for (const json& part : sheet.at("parts")) {
      const std::string name = part.at("name");
      names += name + ";";
      CHECK(says(planned.err, name));
      CHECK(part.at("box")[0].get<double>() >= -1e-6);
      CHECK(part.at("box")[3].get<double>() <= sheet.at("area_mm")[1].get<double>() + 1e-6);
      CHECK(part.at("box")[2].get<double>() - part.at("box")[0].get<double>() > 50);
    }
  }
  for (const char* card : {"card 1;", "card 2;", "card 3;", "card 4;"}) CHECK(says(names, card));
  const Ran from_spec = bench.popcut({"plan", "ball.json", "-o", "sheets", "--json"});
  REQUIRE(from_spec.exit == 0);
  double cut = 0.0, cut_of_spec = 0.0;
  for (const json& sheet : plan.at("sheets")) cut += sheet.at("cut_mm").get<double>();
  const json plan_of_spec = json::parse(from_spec.out);
  for (const json& sheet : plan_of_spec.at("sheets"))
    cut_of_spec += sheet.at("cut_mm").get<double>();
  CHECK(cut == Approx(cut_of_spec).epsilon(1e-3));

  CHECK(bench.popcut({"deploy", "out", "-o", "poses", "--frames", "3", "--glb", "-q"}).exit == 0);
  CHECK(fs::exists(bench.temp / "poses/psi_003.stl"));
  CHECK(fs::exists(bench.temp / "poses/book.glb"));
}

TEST_CASE("what a book folder cannot be used for is said in one line", "[cli][e2e][book]") {
  const Bench bench;
  write_ball(bench, 3);
  REQUIRE(
      bench.popcut({"design", "ball.json", "-o", "out", "--formats", "fold,report", "-q"}).exit ==
      0);
  fs::create_directory(bench.temp / "empty");
  for (const char* command : {"verify", "compare", "deploy", "plan"}) {
    std::vector<std::string> arguments{command, "empty"};
    if (arguments[0] == "compare") arguments.emplace_back("ball.stl");
    if (arguments[0] == "deploy" || arguments[0] == "plan")
      arguments.insert(arguments.end(), {"-o", "x"});
    check_refused_at(bench.popcut(arguments), 3, "empty: is a folder without book.json");
  }
  // A folder of one card, and one of several cards that are no book, say which file to give.
  check_refused_at(
      bench.popcut({"verify", "out/card-01"}), 3,
      "out/card-01: is the folder of one card; give its pattern, out/card-01/pattern.fold");
  fs::create_directory(bench.temp / "cards");
  fs::copy(bench.temp / "out/card-01", bench.temp / "cards/card-01");
  check_refused_at(bench.popcut({"verify", "cards"}), 3,
                   "cards: holds single cards, not a book; give the pattern.fold of one of them");
  check_refused_at(bench.popcut({"deploy", "out", "-o", "x", "--poster"}), 2,
                   "--poster: is for one");
  check_refused_at(bench.popcut({"deploy", "out", "-o", "x", "--to-psi", "pi"}), 2,
                   "--to-psi: opens");
  check_refused_at(bench.popcut({"verify", "out", "--target", "ball.json"}), 2,
                   "--target: is for one");
  check_refused_at(bench.popcut({"verify", "out", "--dof", "2"}), 2, "--dof: is 2");
  check_refused_at(bench.popcut({"compare", "out", "ball.stl", "--psi", "1"}), 2,
                   "--psi: is for one");
  check_refused_at(bench.popcut({"design", "ball.json", "--place", "whole"}), 3,
                   "ball.json: /book");

  json book = bench.read_json("out/book.json");
  const auto refused = [&](const json& changed, const std::string& place) {
    bench.write("out/book.json", changed);
    check_refused_at(bench.popcut({"verify", "out"}), 3, "out/book.json: " + place);
  };
  json changed = book;
  changed["card"][1]["folder"] = "../../etc";
  refused(changed, "/card/1/folder: leads out");
  changed = book;
  changed["card"] = json::array();
  refused(changed, "/card: has 0 cards");
  changed["card"] = json::array({7});
  refused(changed, "/card/0/folder: is missing");
  changed.erase("card");
  refused(changed, "/card: is not a list");
  changed = book;
  changed["popcut_book"] = 2;
  refused(changed, "/popcut_book: is not 1");
  bench.write("out/book.json", book);
  fs::remove(bench.temp / "out/card-02/pattern.fold");
  check_refused_at(bench.popcut({"verify", "out"}), 3, "out/card-02/pattern.fold: cannot be read");
  write_file(bench.temp / "out/card-02/pattern.fold", "{}");
  check_refused(bench.popcut({"verify", "out"}), 3, "card-02");
  CHECK_FALSE(fs::exists(bench.temp / "x"));
}

TEST_CASE("a book of facets is designed, verified and compared with its design",
          "[cli][e2e][book]") {
  const Bench bench;
  bench.write("house.json", json::parse(
                                R"j({"popcut":1,"style":"facets","surface":{"type":"implicit",
          "f":"max(max(abs(x-4)-30,abs(z)-25),abs(y-20)-15)"},
          "facets":{"length_mm":40,"pitch_mm":5,"strip_mm":5},"book":{"cards":4}})j"));
  const Ran made =
      bench.popcut({"design", "house.json", "-o", "out", "--formats", "fold,report", "-q"});
  CAPTURE(made.err);
  REQUIRE(made.exit == 0);
  CHECK(bench.popcut({"verify", "out", "-q"}).exit == 0);
  const Ran seen = bench.popcut({"compare", "out", "house.json", "--no-cost", "--json"});
  CAPTURE(seen.err);
  REQUIRE(seen.exit == 0);
  CHECK(json::parse(seen.out).at("error") < 0.3);
}

TEST_CASE("verify refuses a book whose cards do not belong together", "[cli][e2e][book]") {
  const Bench bench;
  write_ball(bench, 3);
  REQUIRE(
      bench.popcut({"design", "ball.json", "-o", "three", "--formats", "fold,report", "-q"}).exit ==
      0);
  write_ball(bench, 4);
  REQUIRE(
      bench.popcut({"design", "ball.json", "-o", "four", "--formats", "fold,report", "-q"}).exit ==
      0);
  fs::copy_file(bench.temp / "three/card-01/pattern.fold", bench.temp / "four/card-02/pattern.fold",
                fs::copy_options::overwrite_existing);
  const Ran ran = bench.popcut({"verify", "four"});
  CHECK(ran.exit == 6);
  CHECK(says(ran.out, "FAILED  around"));
  CHECK(says(ran.out, "FAILED  seams"));
  CHECK(says(ran.out, "ok      apart"));
}

}  // namespace book_command_test
