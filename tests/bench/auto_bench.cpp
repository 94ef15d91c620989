// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"

namespace auto_bench {

using namespace popcut::testing;
using nlohmann::json;
using popcut::TriangleMesh;
namespace fs = std::filesystem;

namespace {

// 1. Models.

void add(TriangleMesh& to, const TriangleMesh& more) {
  to.corners.insert(to.corners.end(), more.corners.begin(), more.corners.end());
}

void add_quad(TriangleMesh& to, const Point& a, const Point& b, const Point& c, const Point& d) {
  for (const Point& p : {a, b, c, a, c, d})
    for (const double value : p) to.corners.push_back(static_cast<float>(value));
}

/// A house under a gable roof, its ridge along x or y.
TriangleMesh gabled(const Point& low, const Point& eaves, double ridge, bool along_x) {
  TriangleMesh out = box_mesh(low, eaves, false);
  const double x0 = low[0], x1 = eaves[0], y0 = low[1], y1 = eaves[1], z = eaves[2];
  const double xm = 0.5 * (x0 + x1), ym = 0.5 * (y0 + y1);
  if (along_x) {
    add_quad(out, {x0, y0, z}, {x1, y0, z}, {x1, ym, ridge}, {x0, ym, ridge});
    add_quad(out, {x0, y1, z}, {x0, ym, ridge}, {x1, ym, ridge}, {x1, y1, z});
    add_quad(out, {x1, y0, z}, {x1, y1, z}, {x1, ym, ridge}, {x1, ym, ridge});
    add_quad(out, {x0, y0, z}, {x0, ym, ridge}, {x0, y1, z}, {x0, y1, z});
  } else {
    add_quad(out, {x1, y0, z}, {x1, y1, z}, {xm, y1, ridge}, {xm, y0, ridge});
    add_quad(out, {x0, y0, z}, {xm, y0, ridge}, {xm, y1, ridge}, {x0, y1, z});
    add_quad(out, {x0, y0, z}, {x1, y0, z}, {xm, y0, ridge}, {xm, y0, ridge});
    add_quad(out, {x0, y1, z}, {xm, y1, ridge}, {x1, y1, z}, {x1, y1, z});
  }
  return out;
}

TriangleMesh farm() {
  TriangleMesh out = gabled({0, 0, 0}, {36, 52, 26}, 48, false);
  add(out, gabled({40, 60, 0}, {76, 90, 20}, 38, true));
  add(out, box_mesh({44, 8, 0}, {58, 22, 34}, false));
  return out;
}

/// Letters as boxes in the plane of the wall, y and z from and to.
TriangleMesh letters() {
  constexpr std::array<std::array<double, 4>, 8> kStrokes{{{0, 0, 14, 80},
                                                           {14, 0, 48, 14},
                                                           {14, 33, 42, 47},
                                                           {14, 66, 48, 80},
                                                           {60, 0, 74, 80},
                                                           {74, 66, 108, 80},
                                                           {74, 36, 108, 50},
                                                           {94, 50, 108, 66}}};
  TriangleMesh out;
  for (const auto& s : kStrokes) add(out, box_mesh({0, s[0], s[1]}, {18, s[2], s[3]}, false));
  return out;
}

struct Model {
  std::string name, bytes, colours;  ///< OBJ, MTL
  std::string up{"z"};
};

std::vector<Model> models() {
  std::vector<Model> out;
  // Those that no formula makes: all OBJ files in POPCUT_BENCH_MODELS.
  if (const char* folder = std::getenv("POPCUT_BENCH_MODELS"))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".obj")
        out.push_back({entry.path().stem().string(), text_of_file(entry.path()),
                       text_of_file(fs::path(entry.path()).replace_extension(".mtl"))});
  for (Model& model : out)
    if (model.colours.empty()) model.up = "y";  // of an npm package
  std::sort(out.begin(), out.end(), [](const Model& a, const Model& b) { return a.name < b.name; });
  const auto put = [&](const std::string& name, const TriangleMesh& mesh) {
    out.push_back({name, obj(mesh), {}});
  };
  put("farm", farm());
  put("letters", letters());
  return out;
}

/// What a search found, without the folder that it is in.
json found_with(const CommandBench& bench, const char* threads) {
  const Ran ran = bench.popcut({"auto", "model.obj", "-o", "again", "--mat", "12x12", "--threads",
                                threads, "--effort", "0.2", "--seed", "5", "--json"});
  REQUIRE(ran.exit == 0);
  return json::parse(ran.out);
}

}  // namespace

TEST_CASE("the easy, medium and hard card of a search that look most like their model", "[bench]") {
  fmt::print(
      "model      card    folds  shortest  min by hand  wobble  looks  printed   bare "
      "| found in s, CPU s, MB\n");
  for (const Model& model : models()) {
    const CommandBench bench;
    write_file(bench.temp / "model.obj", model.bytes);
    if (!model.colours.empty()) write_file(bench.temp / (model.name + ".mtl"), model.colours);
    const Ran ran = bench.popcut(
        {"auto", "model.obj", "-o", "out", "--mat", "12x12", "--up", model.up, "--json"});
    if (ran.exit != 0) {
      fmt::print("{:<10} {}", model.name, ran.err);
      continue;
    }
    const json front = json::parse(ran.out);
    std::string rest =
        fmt::format(" | {:.0f}, {:.0f}, {}", ran.wall_s, ran.cpu_s, ran.peak_kb >> 10);
    for (const char* label : {"easy", "medium", "hard"}) {
      // The front is in order of minutes, and each card is more like the model than the one before.
      const json* best = nullptr;
      for (const json& card : front["cards"])
        if (card["label"] == label) best = &card;
      if (best == nullptr) continue;
      const std::string folder = (*best)["folder"];
      const Ran bare = bench.popcut(
          {"compare", "out/" + folder + "/pattern.fold", "model.obj", "--no-cost", "--json"});
      REQUIRE(bare.exit == 0);
      fmt::print("{:<10} {:<7}{:6}{:7.0f} mm{:12.1f}{:6.2f} mm  {:<6}{:8.3f}{:7.3f}{}\n",
                 model.name, label, (*best)["folds"].get<int>(),
                 (*best)["shortest_fold_mm"].get<double>(),
                 (*best)["hand_seconds"].get<double>() / 60.0, (*best)["wobble_mm"].get<double>(),
                 (*best)["printed"]["looks"].get<std::string>(), (*best)["error"].get<double>(),
                 json::parse(bare.out)["error"].get<double>(), std::exchange(rest, ""));
    }
    std::fflush(stdout);
  }
}

TEST_CASE("the same seed finds the same cards with one thread and with two", "[bench]") {
  const CommandBench bench;
  write_file(bench.temp / "model.obj", obj(farm()));
  const json one = found_with(bench, "1"), two = found_with(bench, "2");
  const bool same = one == two;
  fmt::print("farm, seed 5, one thread and two: {} cards, {}\n", one["cards"].size(),
             same ? "the same" : "not the same");
  CHECK(same);
}

}  // namespace auto_bench
