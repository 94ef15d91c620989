// SPDX-License-Identifier: MIT
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/rounds.hpp"

namespace auto_command_test {

using namespace popcut::testing;
using Catch::WithinAbs;
using nlohmann::json;
using popcut::TriangleMesh;
namespace fs = std::filesystem;

namespace {

/// A hall and a tower before it.
TriangleMesh houses() {
  TriangleMesh out = box_mesh({0, 0, 0}, {30, 60, 25}, false);
  const TriangleMesh tower = box_mesh({35, 20, 0}, {50, 35, 45}, false);
  out.corners.insert(out.corners.end(), tower.corners.begin(), tower.corners.end());
  return out;
}

/// The hall alone: its cards are found in a fifth of the time.
TriangleMesh hall() { return box_mesh({0, 0, 0}, {30, 60, 25}, false); }

/// An OBJ whose vertices are red and white, each six of them (two triangles) in turn.
std::string painted(const std::string& model) {
  std::string out;
  std::istringstream lines(model);
  std::size_t vertices = 0;
  for (std::string line; std::getline(lines, line); out += line + '\n')
    if (line.starts_with("v ")) line += ++vertices % 12 < 6 ? " 0.8 0.2 0.1" : " 1 1 0.9";
  return out;
}

struct AutoBench : CommandBench {
  AutoBench() {
    write_file(temp / "houses.obj", painted(obj(houses())));
    write_file(temp / "clay.obj", obj(houses()));
    write_file(temp / "hall.obj", obj(hall()));
  }
  /// Searches for cards of a model into `folder`.
  [[nodiscard]] Ran search(const std::string& model, const std::string& folder,
                           std::vector<std::string> more) const {
    std::vector<std::string> words{"auto", model, "-o", folder, "--effort"};
    words.insert(words.end(), more.begin(), more.end());
    return popcut(words);
  }
};

/// How the cases search that look at words, files and options.
const std::vector<std::string> kUsual{"0.01",    "--style", "facets",        "--up",      "z",
                                      "--front", "-y",      "--marks",       "--machine", "cameo3",
                                      "--mat",   "A4",      "--max-minutes", "5"};

/// One such search for the hall, which several cases look at; its cards are in `out`.
struct FoundHall : AutoBench {
  Ran ran = search("hall.obj", "out", kUsual);
  json front = ran.exit == 0 ? read_json("out/front.json") : json();
  [[nodiscard]] std::string best() const { return "out/" + front["best"].get<std::string>(); }
  [[nodiscard]] std::string recommended() const {
    return "out/" + front["recommended"].get<std::string>();
  }
};

const FoundHall& found_hall() {
  static const FoundHall found;
  INFO(found.ran.err);
  REQUIRE(found.ran.exit == 0);
  REQUIRE_FALSE(found.front["cards"].empty());
  return found;
}

}  // namespace

TEST_CASE("beside cards of one sheet are those of layers and boxes, judged by the same measure",
          "[cli][e2e][auto]") {
  const AutoBench bench;
  const Ran ran = bench.search("hall.obj", "out", {"0.01", "--mat", "A4", "--any-hold"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(ran.out.find("  layers   ") != std::string::npos);
  const json front = bench.read_json("out/front.json");
  REQUIRE(front.contains("layers"));
  const json& layers = front["layers"];
  CHECK(layers["tabs"] == 2 * (layers["pieces"].get<int>() - 1));
  CHECK(layers["hand_seconds"] >= 45 * layers["tabs"].get<int>());
  CHECK(layers["error"] > 0.0);
  CHECK(layers["error"] < 0.6);
  CHECK(bench.popcut({"verify", "out/layers/pattern.fold", "--dof", "1", "-q"}).exit == 0);
  CHECK(bench.read_json("out/layers/spec.json")["style"] == "layers");
  const json report = bench.read_json("out/layers/report.json");
  CHECK(report["printed"]["error"] == layers["error"]);
  CHECK(2 * report["page_mm"][0].get<double>() <= 297.0);
  CHECK(ran.out.find("  boxes    ") != std::string::npos);
  REQUIRE(front.contains("boxes"));
  const json& boxes = front["boxes"];
  CHECK(boxes["tabs"].get<int>() > 0);
  CHECK(boxes["hand_seconds"] >= 45 * boxes["tabs"].get<int>());
  CHECK(boxes["error"] < layers["error"]);  // a hall has four walls and a roof
  CHECK(bench.popcut({"verify", "out/boxes/pattern.fold", "--dof", "1", "-q"}).exit == 0);
  CHECK(2 * bench.read_json("out/boxes/report.json")["page_mm"][0].get<double>() <= 297.0);
  // 'popcut compare' says the same of them.
  for (const std::string style : {"layers", "boxes"}) {
    const std::string folder = "out/" + style;
    const Ran compared = bench.popcut(
        {"compare", folder + "/pattern.fold", folder + "/spec.json", "--printed", "--json"});
    INFO(compared.err);
    REQUIRE(compared.exit == 0);
    const json figures = json::parse(compared.out);
    CHECK(figures["error"] == front[style]["error"]);
    CHECK(figures["printed"] == bench.read_json(folder + "/report.json")["printed"]);
  }
  check_refused(
      bench.popcut({"compare", "out/boxes/pattern.fold", "out/layers/spec.json", "--printed"}), 3,
      "is not the card that this popcut makes");
  check_refused(bench.popcut({"compare", "out/boxes/pattern.fold", "hall.obj", "--printed"}), 3,
                "give the .json that it was designed from");
  check_refused(bench.popcut({"compare", "out/boxes/pattern.fold", "out/boxes/spec.json"}), 3,
                "add --printed");
  // Cards that break a limit are left out, and notes say so.
  const Ran few = bench.search("hall.obj", "few", {"0.01", "--mat", "A4", "--max-folds", "8"});
  REQUIRE(few.exit == 0);
  const std::string notes = bench.read_json("few/front.json")["notes"].dump();
  for (const std::string style : {"layers", "boxes"})
    CHECK(notes.find("popcut left out a card glued from " + style + ": it has") !=
          std::string::npos);
}

TEST_CASE("a model alone becomes a front of cards that are verified, made again and fit the mat",
          "[cli][e2e][auto]") {
  const AutoBench bench;
  const Ran ran = bench.search("houses.obj", "out", {"0.04", "--mat", "12x12", "--json"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const json front = bench.read_json("out/front.json");
  CHECK(json::parse(ran.out) == front);
  REQUIRE_FALSE(front["cards"].empty());
  CHECK(front["best"] == front["cards"].back()["folder"]);
  double error = 1e9, seconds = 0.0, hand_seconds = 0.0;
  for (const json& card : front["cards"]) {
    INFO(card.dump());
    CHECK(card["error"] < error);
    CHECK(card["hand_seconds"] > hand_seconds);
    CHECK(card["seconds"] <= 900.0);
    CHECK(card["wobble_mm"] < 1.05);
    error = card["error"], seconds = card["seconds"], hand_seconds = card["hand_seconds"];
    for (const json& side : card["sheet_mm"]) CHECK(side <= 305.0);
    const std::string folder = "out/" + card["folder"].get<std::string>();
    CHECK(bench.popcut({"verify", folder + "/pattern.fold", "--dof", "1", "-q"}).exit == 0);
    for (const char* file : {"pattern.svg", "pattern.dxf", "cut.svg", "thumbnail.png"})
      CHECK(fs::file_size(bench.temp / folder / file) > 100);
  }
  REQUIRE(front.contains("layers"));
  CHECK(front["layers"]["wobble_mm"] < 1.05);
  // No style with its usual settings is better than the best.
  CHECK(front["usual"].size() >= 7);
  for (const json& usual : front["usual"])
    if (usual["made"]) CHECK(usual["error"] >= error);

  const std::string best = "out/" + front["best"].get<std::string>();
  REQUIRE(bench.popcut({"design", best + "/spec.json", "-o", "again", "-q"}).exit == 0);
  for (const char* file : {"pattern.fold", "pattern.svg", "pattern.dxf", "cut.svg"})
    CHECK(text_of_file(bench.temp / "again" / file) == text_of_file(bench.temp / best / file));
  const Ran compared =
      bench.popcut({"compare", best + "/pattern.fold", "houses.obj", "--printed", "--json"});
  INFO(compared.err);
  REQUIRE(compared.exit == 0);
  const json seen = json::parse(compared.out);
  CHECK_THAT(seen["error"].get<double>(), WithinAbs(error, 1e-6));
  CHECK_THAT(seen["cost"]["seconds"].get<double>(), WithinAbs(seconds, 1e-6));
  // A card is judged in its model's colours.
  const Ran clay = bench.popcut(
      {"compare", best + "/pattern.fold", "clay.obj", "--printed", "--no-cost", "--json"});
  REQUIRE(clay.exit == 0);
  const json bare = json::parse(clay.out)["printed"], own = seen["printed"];
  CHECK(own["cover"] == bare["cover"]);
  CHECK(own["contour"] == bare["contour"]);
  CHECK(std::abs(own["colour"].get<double>() - bare["colour"].get<double>()) > 0.005);
  const std::string picture = text_of_file(bench.temp / "out/front.svg");
  CHECK(std::count(picture.begin(), picture.end(), '\n') > 10);
  CHECK(says(picture, "the best"));
}

TEST_CASE("a candidate that was designed before keeps its spec and its cost", "[cli][e2e][auto]") {
  // A model of few triangles is never made coarse, so its first designs are the last ones. With
  // this seed, a later round draws one of them again.
  const AutoBench bench;
  const Ran ran = bench.search("hall.obj", "out",
                               {"0.25", "--seed", "4", "--mat", "110x110", "--style", "facets"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const json front = bench.read_json("out/front.json");
  REQUIRE_FALSE(front["cards"].empty());
  for (const json& card : front["cards"]) {
    INFO(card.dump());
    CHECK(card["folds"] > 0);
    CHECK(card["seconds"] > 0.0);
    CHECK(bench.read_json("out/" + card["folder"].get<std::string>() + "/spec.json")["style"] ==
          "facets");
  }
}

TEST_CASE("the same seed gives the same cards, whatever the threads", "[cli][e2e][auto]") {
  const AutoBench bench;
  for (const auto& [threads, folder] : {std::pair{"1", "one"}, {"2", "two"}})
    REQUIRE(bench
                .search("hall.obj", folder,
                        {"0.02", "--threads", threads, "--seed", "7", "--mat", "110x110", "--style",
                         "facets", "-q"})
                .exit == 0);
  const auto files = files_below(bench.temp / "one");
  CHECK(files == files_below(bench.temp / "two"));
  for (const std::string& file : files) {
    INFO(file);
    CHECK(text_of_file(bench.temp / "one" / file) == text_of_file(bench.temp / "two" / file));
  }
}

TEST_CASE("a search keeps to the style, the upright axis and the time that it is given",
          "[cli][e2e][auto]") {
  const FoundHall& found = found_hall();
  for (const json& card : found.front["cards"]) {
    CHECK(card["settings"]["style"] == "facets");
    CHECK(card["seconds"] <= 300.0);
    const json spec = found.read_json("out/" + card["folder"].get<std::string>() + "/spec.json");
    CHECK(spec["rotate_deg"][0] == 0.0);
    CHECK(spec["rotate_deg"][1] == 0.0);
  }
  // A small mat makes small cards.
  const AutoBench bench;
  REQUIRE(
      bench
          .search("hall.obj", "out",
                  {"0.01", "--mat", "120x120", "--style", "lattice", "--max-minutes", "3", "-q"})
          .exit == 0);
  const json small = bench.read_json("out/front.json");
  REQUIRE_FALSE(small["cards"].empty());
  for (const json& card : small["cards"]) {
    CHECK(card["settings"]["style"] != "facets");
    CHECK(card["seconds"] <= 180.0);
    for (const json& side : card["sheet_mm"]) CHECK(side <= 120.0);
  }
}

TEST_CASE("a model becomes a front of books that are verified, made again and fit the mat",
          "[cli][e2e][auto]") {
  const auto [cards, style] = GENERATE(std::pair{"4", "facets"}, std::pair{"6", "slices"});
  CAPTURE(cards, style);
  if (std::string_view(cards) == "6" && fewer_rounds()) return;  // as the other, and slower
  const AutoBench bench;
  std::vector<std::string> words{
      "auto",     "houses.obj",    "-o",    "out",   "--cards", cards,  "--style",
      style,      "--max-minutes", "60",    "--mat", "110x110", "--up", "z",
      "--effort", "0.02",          "--json"};
  // Books of slices of this size move by 1.3 mm, and are offered only to whoever asks for them.
  if (std::string_view(style) == "slices") words.emplace_back("--any-hold");
  const Ran ran = bench.popcut(words);
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const json front = bench.read_json("out/front.json");
  CHECK(json::parse(ran.out) == front);
  REQUIRE_FALSE(front["cards"].empty());
  double error = 1e9, hand_seconds = 0.0;
  for (const json& book : front["cards"]) {
    INFO(book.dump());
    CHECK(book["error"] < error);
    CHECK(book["hand_seconds"] > hand_seconds);
    error = book["error"], hand_seconds = book["hand_seconds"];
    CHECK(book["settings"]["cards"] == std::stoi(cards));
    for (const json& side : book["sheet_mm"]) CHECK(side <= 110.0);
    const std::string folder = "out/" + book["folder"].get<std::string>();
    CHECK(says(folder, "book-"));
    CHECK(bench.popcut({"verify", folder, "-q"}).exit == 0);
    CHECK(fs::exists(bench.temp / folder / ("card-0" + std::string(cards)) / "cut.svg"));
    CHECK(bench.read_json(folder + "/spec.json")["book"]["cards"] == std::stoi(cards));
  }
  const std::string best = "out/" + front["best"].get<std::string>();
  REQUIRE(bench.popcut({"design", best + "/spec.json", "-o", "again", "-q"}).exit == 0);
  for (const char* file : {"card-01/pattern.fold", "card-03/pattern.svg", "card-04/cut.svg"})
    CHECK(text_of_file(bench.temp / "again" / file) == text_of_file(bench.temp / best / file));
  const Ran compared = bench.popcut({"compare", best, "houses.obj", "--json"});
  INFO(compared.err);
  REQUIRE(compared.exit == 0);
  const json seen = json::parse(compared.out);
  CHECK_THAT(seen["error"].get<double>(), WithinAbs(error, 1e-6));
}

TEST_CASE("the front of a model faces out of the card, and cards to print fit between the marks",
          "[cli][e2e][auto]") {
  const FoundHall& found = found_hall();
  CHECK(found.front["marks"] == true);
  for (const json& card : found.front["cards"]) {
    const std::string design = "out/" + card["folder"].get<std::string>() + "/spec.json";
    CHECK(found.read_json(design)["rotate_deg"] == json{0.0, 0.0, 90.0});
    const Ran planned = found.popcut({"plan", design, "--marks", "--no-split", "-o", "plan", "-q",
                                      "--machine", "cameo3", "--mat", "A4"});
    INFO(planned.err);
    CHECK(planned.exit == 0);
  }
  // The commands to type next have the same machine and mat.
  CHECK(says(found.ran.out, "popcut print " + found.recommended() +
                                "/spec.json --machine cameo3 --mat A4 -o printed"));
}

TEST_CASE("popcut design takes a model and makes the best card of a short search",
          "[cli][e2e][auto]") {
  const AutoBench bench;
  const Ran ran = bench.popcut({"design", "hall.obj", "-o", "card"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(says(ran.err, "popcut auto hall.obj"));
  CHECK(bench.popcut({"verify", "card/pattern.fold", "--dof", "1", "-q"}).exit == 0);
  const std::string fold = text_of_file(bench.temp / "card/pattern.fold");
  // Its own design makes it again, in the same folder too.
  REQUIRE(bench.popcut({"design", "card/spec.json", "-o", "card", "-q"}).exit == 0);
  CHECK(text_of_file(bench.temp / "card/pattern.fold") == fold);
  CHECK(fs::exists(bench.temp / "card/spec.json"));
  check_refused(bench.popcut({"design", "hall.obj", "--place", "whole"}), 2, "--place");
}

TEST_CASE("a GLB and a glTF with its mesh beside it become the cards of the same OBJ",
          "[cli][e2e][auto]") {
  const FoundHall& found = found_hall();
  const AutoBench bench;
  write_file(bench.temp / "hall.glb", glb(hall()));
  write_file(bench.temp / "hall.gltf", gltf(hall(), "its%20mesh.bin"));
  write_file(bench.temp / "its mesh.bin", corner_bytes(hall()));
  const auto without_name = [](json front) {
    front.erase("model");
    return front;
  };
  for (const char* name : {"hall.glb", "hall.gltf"}) {
    CAPTURE(name);
    const Ran ran = bench.search(name, std::string(name) + ".d", kUsual);
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    const json front = bench.read_json(std::string(name) + ".d/front.json");
    CHECK(without_name(front) == without_name(found.front));
    const std::string best = std::string(name) + ".d/" + front["best"].get<std::string>();
    // What it found is designed again, planned, judged and printed from the same file.
    const std::string fold = text_of_file(bench.temp / best / "pattern.fold");
    REQUIRE(bench.popcut({"design", best + "/spec.json", "-o", "again", "-q"}).exit == 0);
    CHECK(text_of_file(bench.temp / "again/pattern.fold") == fold);
    const Ran compared = bench.popcut({"compare", "again/pattern.fold", name, "--json"});
    INFO(compared.err);
    REQUIRE(compared.exit == 0);
    CHECK(json::parse(compared.out)["placement"]["from"] == "pattern");
    CHECK(bench.popcut({"print", best + "/spec.json", "-o", "printed", "-q"}).exit == 0);
  }
  // Of lattices verify reads the model for itself.
  bench.write("lattice.json", {{"popcut", 1},
                               {"surface", {{"type", "mesh"}, {"file", "hall.gltf"}}},
                               {"fit", "nearest"},
                               {"units_per_slice", 5},
                               {"slices", 8},
                               {"widths_mm", 6}});
  REQUIRE(bench.popcut({"design", "lattice.json", "-o", "lattice", "-q"}).exit == 0);
  const Ran checked =
      bench.popcut({"verify", "lattice/pattern.fold", "--target", "lattice.json", "-q"});
  INFO(checked.err);
  CHECK(checked.exit == 0);
  fs::remove(bench.temp / "its mesh.bin");
  check_refused(bench.popcut({"auto", "hall.gltf", "-o", "never"}), 3,
                "hall.gltf: /buffers/0: is in its mesh.bin, which is not a file");
}

TEST_CASE("a search says in one line what is wrong, and writes nothing", "[cli][e2e][auto]") {
  const AutoBench bench;
  const auto refused = [&](std::vector<std::string> words, int exit, const std::string& part) {
    words.insert(words.begin(), "auto");
    words.insert(words.end(), {"-o", "never", "--effort", "0.02"});
    const Ran ran = bench.popcut(words);
    check_refused(ran, exit, part);
    CHECK(ran.out.empty());
    CHECK_FALSE(fs::exists(bench.temp / "never"));
  };
  refused({"absent.obj"}, 3, "absent.obj: cannot be read");
  write_file(bench.temp / "empty.stl", "");
  refused({"empty.stl"}, 3, "empty.stl");
  write_file(bench.temp / "words.obj", "v 0 0\nf 1 2 3\n");
  refused({"words.obj"}, 3, "words.obj");
  const std::string png = "\x89PNG\r\n\x1a\n" + std::string(500, '\0');
  for (const char* name : {"picture.png", "picture.stl", "picture.glb"}) {
    write_file(bench.temp / name, png);
    refused({name}, 3, fmt::format("{}: is a PNG picture; give a 3D model", name));
  }
  check_refused(bench.popcut({"design", "picture.png", "-o", "never"}), 3,
                "picture.png: is a PNG picture; give a design (.json) or a 3D model");
  check_refused(bench.popcut({"compare", "picture.png", "houses.obj"}), 3,
                "picture.png: is a PNG picture; give a pattern");
  check_refused(bench.popcut({"compare", "houses.obj", "picture.png"}), 3,
                "picture.png: is a PNG picture; give a 3D model");
  write_file(bench.temp / "flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
  refused({"flat.obj"}, 3, "flat.obj: has no outside");
  bench.write("design.json", {{"popcut", 1},
                              {"surface", {{"type", "profile"}, {"z", "40 - x"}}},
                              {"units_per_slice", 3},
                              {"slices", 3},
                              {"widths_mm", 5}});
  refused({"design.json"}, 3, "popcut design design.json");
  refused({"houses.obj", "--machine", "cricut-maker"}, 2, "cutting times");
  refused({"houses.obj", "--machine", "cameo9"}, 2, "cameo9");
  refused({"houses.obj", "--material", "gold"}, 2, "--material");
  refused({"houses.obj", "--mat", "25x25"}, 4, "houses.obj: no card shows it");
  refused({"houses.obj", "--mat", "25x25", "--marks"}, 4,
          "--mat: has no room for a card between registration marks; use a larger one");
  refused({"houses.obj", "--mat", "10x10"}, 4, "--mat: has no room for a card; use a larger one");
  refused({"houses.obj", "--max-minutes", "0.1"}, 4, "the quickest that was found takes");
  refused({"houses.obj", "--style", "origami"}, 2, "--style");
  refused({"houses.obj", "--up", "w"}, 2, "--up");
  refused({"houses.obj", "--cards", "2"}, 2, "--cards");
  refused({"houses.obj", "--cards", "13"}, 2, "give 1, or 3 to 12");
  refused({"houses.obj", "--cards", "4", "--up", "z", "--front", "x"}, 2, "--front: is for cards");
  refused({"houses.obj", "--cards", "6", "--style", "facets"}, 2, "books of 4 cards only");
  refused({"houses.obj", "--up", "z", "--front", "-z"}, 2, "--front: is \"-z\", along the axis");
  refused({"houses.obj", "--marks", "--machine", "hpgl-generic", "--mat", "300x300"}, 3,
          "cannot search for registration marks");
  check_refused(bench.popcut({"auto", "houses.obj"}), 2, "-o DIR is missing");
}

TEST_CASE("a search of more triangles than it takes says how many it takes", "[cli][e2e][auto]") {
  const AutoBench bench;
  std::string bytes(84 + std::size_t{50} * 2'000'001, '\0');
  const std::uint32_t count = 2'000'001;
  std::copy_n(reinterpret_cast<const char*>(&count), sizeof(count), bytes.begin() + 80);
  write_file(bench.temp / "huge.stl", bytes);
  const Ran ran = bench.popcut({"auto", "huge.stl", "-o", "never"});
  check_refused(ran, 3, "huge.stl: has 2000001 triangles; at most 2000000");
  CHECK_FALSE(fs::exists(bench.temp / "never"));
}

TEST_CASE("open and crossing meshes are made, and a note says what they are", "[cli][e2e][auto]") {
  const AutoBench bench;
  TriangleMesh mesh = box_mesh({0, 0, 0}, {30, 60, 25}, true);
  const TriangleMesh tower = box_mesh({20, 20, 5}, {40, 35, 45}, false);
  mesh.corners.insert(mesh.corners.end(), tower.corners.begin(), tower.corners.end());
  for (float& metres : mesh.corners) metres *= 0.001F;
  write_file(bench.temp / "torn.stl", binary_stl(mesh));
  const Ran ran =
      bench.search("torn.stl", "out", {"0.01", "--style", "facets", "--mat", "100x100"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(says(ran.out, "the model has holes (4 edges have one triangle only)"));
  CHECK(says(ran.out, "  sized    one unit of the file is "));
  CHECK(says(ran.out, "parts of the model run through each other ("));
  CHECK(bench.read_json("out/front.json")["notes"].size() == 2);
}

TEST_CASE("Ctrl-C ends a search, and leaves nothing behind", "[cli][e2e][auto]") {
  const AutoBench bench;
  const std::string model = bench.path("houses.obj"), folder = bench.path("stopped");
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    execl(popcut_program(), "popcut", "auto", model.c_str(), "-o", folder.c_str(), "--effort", "50",
          "-q", static_cast<char*>(nullptr));
    _exit(127);
  }
  // The folder is locked once the signal is heard.
  for (int k = 0; k < 400 && !fs::exists(folder); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
  CHECK(fs::exists(folder));
  CHECK(kill(child, SIGINT) == 0);
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGINT);
  CHECK_FALSE(fs::exists(folder));
}

}  // namespace auto_command_test
