// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
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

TriangleMesh city(unsigned seed) {
  std::mt19937 random(seed);
  const auto whole = [&](int low, int high) {
    return static_cast<double>(low +
                               static_cast<int>(random() % static_cast<unsigned>(high - low + 1)));
  };
  TriangleMesh out;
  for (int row = 0; row < 3; ++row)
    for (int k = 0; k < 4; ++k) {
      const double x = 22.0 * row + whole(0, 4), y = 25.0 * k + whole(0, 4);
      const Point far{x + whole(12, 18), y + whole(14, 21), whole(12, 46) - 6.0 * row};
      add(out, box_mesh({x, y, 0}, {far[0], far[1], std::max(8.0, far[2])}, false));
    }
  return out;
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

TriangleMesh letter(const std::string& which) {
  // Strokes as boxes in the plane of the wall: (y, z) from and to.
  using Stroke = std::array<double, 4>;
  const std::vector<Stroke> strokes =
      which == "E"
          ? std::vector<Stroke>{{0, 0, 14, 80}, {14, 0, 48, 14}, {14, 33, 42, 47}, {14, 66, 48, 80}}
          : std::vector<Stroke>{
                {0, 0, 14, 80}, {14, 66, 48, 80}, {14, 36, 48, 50}, {34, 50, 48, 66}};
  TriangleMesh out;
  for (const Stroke& s : strokes) add(out, box_mesh({0, s[0], s[1]}, {18, s[2], s[3]}, false));
  return out;
}

/// Turned about an upright axis: a radius for each height.
TriangleMesh turned(const std::function<double(double)>& radius, double height) {
  constexpr int kRings = 60, kSectors = 72;
  const auto at = [&](int ring, int sector) {
    const double z = height * ring / kRings, turn = 2 * std::numbers::pi * sector / kSectors;
    const double r = ring == 0 || ring == kRings ? 0.0 : radius(z / height);
    return Point{r * std::cos(turn), r * std::sin(turn), z};
  };
  TriangleMesh out;
  for (int ring = 0; ring < kRings; ++ring)
    for (int s = 0; s < kSectors; ++s)
      add_quad(out, at(ring, s), at(ring, s + 1), at(ring + 1, s + 1), at(ring + 1, s));
  return out;
}

struct Model {
  std::string name, bytes;
};

std::vector<Model> models() {
  std::vector<Model> out;
  // Those that no formula makes: all OBJ files in POPCUT_BENCH_MODELS.
  if (const char* folder = std::getenv("POPCUT_BENCH_MODELS"))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".obj")
        out.push_back({entry.path().stem().string(), text_of_file(entry.path())});
  std::sort(out.begin(), out.end(), [](const Model& a, const Model& b) { return a.name < b.name; });
  const auto put = [&](const std::string& name, const TriangleMesh& mesh) {
    out.push_back({name, obj(mesh)});
  };
  put("city-1", city(1));
  put("city-2", city(2));
  put("house", gabled({0, 0, 0}, {40, 56, 32}, 58, true));
  put("farm", farm());
  put("letter-P", letter("P"));
  put("letter-E", letter("E"));
  put("torus", torus(30, 12, 48));
  put("vase", turned([](double t) { return 20 + 9 * std::sin(7 * t) + 4 * t; }, 90));
  return out;
}

// 2. What each style makes without a search.

struct Made {
  double error{std::numeric_limits<double>::infinity()}, seconds{};
};

/// The spec as it stands, as large as the mat allows, compared as a person would.
std::optional<Made> made_of(const CommandBench& bench, json spec) {
  constexpr double kMat_mm = 300.0;
  bool fits = false;
  for (int k = 0; k < 9; ++k) {
    bench.write("usual.json", spec);
    if (bench.popcut({"design", "usual.json", "-o", "usual", "-q", "--formats", "fold,report"})
            .exit != 0)
      return std::nullopt;
    const json sheet = bench.read_json("usual/report.json")["sheet_mm"];
    const double large = std::max(sheet[0].get<double>(), sheet[1].get<double>());
    fits = large <= kMat_mm;
    if (fits && (large >= 0.97 * kMat_mm || k >= 4)) break;
    const double by = 0.99 * (kMat_mm - 30.0) / (large - 30.0);
    for (const char* name : {"scale_mm", "widths_mm"})
      if (spec.contains(name)) spec[name] = by * spec[name].get<double>();
    if (spec.contains("translate_mm"))
      for (json& shift : spec["translate_mm"]) shift = by * shift.get<double>();
  }
  if (!fits) return std::nullopt;
  const Ran seen = bench.popcut({"compare", "usual/pattern.fold", "model.obj", "--json"});
  if (seen.exit != 0) return std::nullopt;
  const json figures = json::parse(seen.out);
  return Made{figures["error"], figures["cost"].value("seconds", 0.0)};
}

/// A style with its usual settings, standing as 'popcut design --place' proposes.
std::optional<Made> usual(const CommandBench& bench, const std::string& style, double size) {
  const double scale = 90.0 / size;
  json spec{{"popcut", 1},
            {"surface", {{"type", "mesh"}, {"file", "model.obj"}}},
            {"scale_mm", scale},
            {"fit", "nearest"},
            {"lattice", style == "facets" ? "direct" : style},
            {"units_per_slice", 12},
            {"slices", 20},
            {"widths_mm", 4.5}};
  bench.write("place.json", spec);
  const Ran placed = bench.popcut({"design", "place.json", "--place", "whole", "-q"});
  if (placed.exit != 0) return std::nullopt;
  spec = json::parse(placed.out);
  if (style == "facets") {
    for (const char* name : {"lattice", "units_per_slice", "slices", "widths_mm", "fit"})
      spec.erase(name);
    spec["style"] = "facets";
  }
  return made_of(bench, spec);
}

double size_of(const std::string& obj_text) {
  Point low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  std::size_t at = 0;
  while ((at = obj_text.find("v ", at)) != std::string::npos) {
    if (at == 0 || obj_text[at - 1] == '\n') {
      Point p{};
      if (std::sscanf(obj_text.c_str() + at, "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3)
        for (std::size_t i = 0; i < 3; ++i)
          low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
    }
    ++at;
  }
  double size = 0.0;
  for (std::size_t i = 0; i < 3; ++i) size = std::max(size, high[i] - low[i]);
  return size;
}

/// What a search found, without the folder that it is in.
json found_with(const CommandBench& bench, const char* threads) {
  const Ran ran = bench.popcut({"auto", "model.obj", "-o", "again", "--mat", "12x12", "--threads",
                                threads, "--effort", "0.2", "--seed", "5", "--json"});
  REQUIRE(ran.exit == 0);
  return json::parse(ran.out);
}

}  // namespace

TEST_CASE("the best card of a search beside each style with its usual settings", "[bench]") {
  fmt::print(
      "model      error  min | facets  min | lattice  min | of lattice  of best | cards  s  CPU "
      "s\n");
  int no_worse = 0, much_better = 0, count = 0;
  for (const Model& model : models()) {
    const CommandBench bench;
    write_file(bench.temp / "model.obj", model.bytes);
    const Ran ran = bench.popcut({"auto", "model.obj", "-o", "out", "--mat", "12x12", "--json"});
    if (ran.exit != 0) {
      fmt::print("{:<10} {}", model.name, ran.err);
      continue;
    }
    const json front = json::parse(ran.out);
    const double error = front["cards"].back()["error"];
    const double size = size_of(model.bytes);
    Made facets, lattice;
    for (const char* style : {"facets", "auto", "slices", "branching", "levels", "direct"}) {
      const auto made = usual(bench, style, size);
      if (!made || made->seconds > 900.0) continue;
      Made& best = style == std::string("facets") ? facets : lattice;
      if (made->error < best.error) best = *made;
    }
    for (const json& one : front["usual"]) {
      if (!one["made"] || one["seconds"] > 900.0) continue;
      Made& best = one["settings"]["style"] == "facets" ? facets : lattice;
      if (one["error"] < best.error) best = {one["error"], one["seconds"]};
    }
    const double single = std::min(facets.error, lattice.error);
    fmt::print(
        "{:<10} {:.4f} {:4.1f} | {:.4f} {:4.1f} | {:.4f} {:4.1f} | {:10.2f} {:8.2f} | {:5} {:.0f} "
        "{:.0f}\n",
        model.name, error, front["cards"].back()["seconds"].get<double>() / 60.0, facets.error,
        facets.seconds / 60.0, lattice.error, lattice.seconds / 60.0, error / lattice.error,
        error / single, front["cards"].size(), ran.wall_s, ran.cpu_s);
    ++count, no_worse += error <= single + 1e-9, much_better += error <= 0.75 * lattice.error;
    std::fflush(stdout);
  }
  fmt::print("at most that of each style in {} of {}, at least 25 % below the lattice in {}\n",
             no_worse, count, much_better);
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
