// SPDX-License-Identifier: MIT
// Facets on forty shapes: what becomes of them, and how long it takes; and seconds by the size of
// the sheet.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/compare/comparison.hpp"
#include "core/design/design.hpp"
#include "core/design/facet_design.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/timing.hpp"
#include "tests/support/value.hpp"

namespace facets_bench {

using namespace popcut;
using nlohmann::json;
using testing::uniform;
using testing::whole;

namespace {

struct Shape {
  std::string name;
  json surface;
  double length_mm{};  ///< of a formula
  SurfaceAssets assets{};
  json more = json::object();
};

/// The solid that any of `parts` fills.
std::string any_of(const std::vector<std::string>& parts) {
  std::string out = parts.front();
  for (std::size_t k = 1; k < parts.size(); ++k) out = fmt::format("min({}, {})", out, parts[k]);
  return out;
}

Shape formula(std::string name, const std::string& f, double length_mm) {
  return {std::move(name), {{"type", "implicit"}, {"f", f}}, length_mm};
}

Shape city(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::string> boxes;
  const int count = whole(random, 4, 9);
  for (int k = 0; k < count; ++k) {
    const double x = uniform(random, 10, 60), z = uniform(random, 10, 70),
                 middle = uniform(random, 10, 90), half = uniform(random, 4, 12);
    boxes.push_back(fmt::format("max(max(x - {:.3g}, abs(y - {:.3g}) - {:.3g}), z - {:.3g})", x,
                                middle, half, z));
  }
  return formula(fmt::format("city {}", seed), any_of(boxes), 100);
}

Shape house(unsigned seed) {
  std::mt19937 random(seed);
  const double depth = uniform(random, 25, 50), half = uniform(random, 20, 38),
               eave = uniform(random, 20, 40), pitch = uniform(random, 0.5, 1.2),
               sill = uniform(random, 8, 14);
  const double ridge = eave + pitch * half;
  return formula(
      fmt::format("house {}", seed),
      fmt::format("max(max(max(x - {0:.4g}, abs(y - 45) - {1:.4g}), z + {2:.4g} * abs(y - 45) - "
                  "{3:.4g}), -max(max(abs(abs(y - 45) - {4:.4g}) - 5, abs(z - {5:.4g}) - 6), "
                  "{6:.4g} - x))",
                  depth, half, pitch, ridge, 0.5 * half, sill + 6, depth - 8),
      90);
}

Shape word(const std::string& text) {
  return {text, {{"type", "text"}, {"text", text}, {"height", 50}, {"depth", 20}}};
}

/// A drawing of one closed line, its corners in polar coordinates.
template <typename Radius>
Shape drawn(const std::string& name, int corners, const Radius& radius,
            const std::string& more = "") {
  std::string path;
  for (int k = 0; k < corners; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / corners;
    path += fmt::format("{}{:.4f} {:.4f}", k == 0 ? "M" : "L", 50 + radius(k) * std::sin(turn),
                        50 - radius(k) * std::cos(turn));
  }
  const std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 "
      "100'><path d='{}z{}'/></svg>",
      path, more);
  return {
      name, {{"type", "outline"}, {"file", "drawn.svg"}, {"depth", 20}}, 0, {{"drawn.svg", svg}}};
}

std::vector<Shape> forty() {
  std::vector<Shape> out;
  for (unsigned seed = 1; seed <= 8; ++seed) out.push_back(city(seed));
  for (unsigned seed = 1; seed <= 8; ++seed) out.push_back(house(seed));
  for (const char* text : {"P", "A", "R", "B", "8", "&", "Ann", "POPCUT"})
    out.push_back(word(text));
  out.push_back(formula("ball in the corner", "x^2 + (y - 50)^2 + z^2 - 45^2", 100));
  out.push_back(formula("ball on the ground", "(x - 32)^2 + (y - 40)^2 + (z - 32)^2 - 30^2", 80));
  out.push_back(formula("cone", "sqrt((x - 35)^2 + (y - 40)^2) - 0.5 * (60 - z)", 80));
  out.push_back(formula("tower", "max(sqrt((x - 30)^2 + (y - 35)^2) - 22, z - 60)", 70));
  out.push_back(formula("pyramid", "max(abs(x - 40), abs(y - 40)) - 0.7 * (55 - z)", 80));
  out.push_back(formula("ring", "(sqrt((y - 45)^2 + (z - 40)^2) - 28)^2 + (x - 20)^2 - 10^2", 90));
  out.push_back(formula(
      "heart",
      "max(((y/30 - 1.2)^2 + (z/30 - 1.05)^2 - 1)^3 - (y/30 - 1.2)^2 * (z/30 - 1.05)^3, x - 22)",
      72));
  out.push_back(formula("stairs", "max(z - 10 * floor(6 - x / 10), abs(y - 30) - 25)", 60));
  out.push_back(formula(
      "arch", "max(max(max(x - 25, abs(y - 45) - 38), z - 60), 24 - sqrt((y - 45)^2 + z^2))", 90));
  out.push_back(formula("dome on a drum",
                        "max(sqrt((x - 32)^2 + (y - 40)^2) - 28, z - 25 - sqrt(max(0, 28^2 - (x - "
                        "32)^2 - (y - 40)^2)))",
                        80));
  out.push_back(drawn("star", 10, [](int k) { return k % 2 == 0 ? 45.0 : 18.0; }));
  out.push_back(drawn(
      "gear", 48, [](int k) { return k % 4 < 2 ? 45.0 : 36.0; }, "M40 40v20h20v-20z"));
  out.push_back(drawn(
      "leaf", 60, [](int k) { return 28.0 + 14.0 * std::cos(4.0 * std::numbers::pi * k / 60); }));
  out.push_back(drawn("shield", 4, [](int k) { return k == 2 ? 48.0 : 36.0; }));
  out.push_back(drawn(
      "flower", 90, [](int k) { return 34.0 + 9.0 * std::cos(10.0 * std::numbers::pi * k / 90); },
      "M44 44v12h12v-12z"));
  // The Utah teapot, where it is.
  std::ifstream file(testing::source_file("../shared/data/meshes/teapot.obj"));
  if (file) {
    const std::string obj{std::istreambuf_iterator<char>(file), {}};
    out.push_back({"teapot",
                   {{"type", "mesh"}, {"file", "teapot.obj"}},
                   0,
                   {{"teapot.obj", obj}},
                   {{"scale_mm", 16}, {"rotate_deg", {90, 0, 90}}, {"translate_mm", {32, 0, 0}}}});
  } else {
    WARN("skipped: no teapot.obj beside the repository");
  }
  return out;
}

/// All faces but wall and ground at the designed opening, (x, v, z), for `likeness`.
std::vector<float> opened(const Pattern& pattern) {
  const auto places = posed_vertices(pattern, pattern.design_psi_rad);
  std::vector<Vec2> sheet;
  for (const PatternVertex& p : pattern.vertices) sheet.emplace_back(p.v, -pattern.u(p));
  std::vector<float> out;
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    triangles.clear();
    std::vector<std::uint32_t> face(pattern.face(f).begin(), pattern.face(f).end());
    if (twice_area(sheet, face) < 0.0) std::reverse(face.begin(), face.end());
    if (!triangulate(sheet, face, triangles)) continue;
    for (const Triangle& t : triangles)
      for (const std::uint32_t corner : t)
        for (const double x : places[corner]) out.push_back(static_cast<float>(x));
  }
  return out;
}

std::optional<likeness::Figures> likeness_of(const DesignSpec& spec, const Shape& shape,
                                             const Design& design) {
  const auto target = facet_target(spec, shape.assets);
  if (!target) return std::nullopt;
  std::vector<float> model(target->soup.corners.begin(), target->soup.corners.end());
  for (std::size_t k = 1; k < model.size(); k += 3)
    model[k] += static_cast<float>(spec.card->margin_mm - target->from_mm);
  likeness::Buffers buffers;
  return likeness::Target(model, {likeness::cone_views(), 256, likeness::Corner{}})
      .measure(opened(design.pattern), buffers);
}

json spec_of(const Shape& shape, double strip_mm) {
  json facets = {{"strip_mm", strip_mm}, {"pitch_mm", strip_mm}};
  if (shape.length_mm > 0.0) facets["length_mm"] = shape.length_mm;
  json out = {{"popcut", 1},       {"name", shape.name},
              {"style", "facets"}, {"surface", shape.surface},
              {"facets", facets},  {"card", {{"margin_mm", 10}}}};
  out.update(shape.more);
  return out;
}

}  // namespace

TEST_CASE("forty shapes as facets", "[bench]") {
  std::string table =
      fmt::format("{:<20} {:>7} {:>8} {:>8} {:>10} {:>7} {:>7} {:>7} {:>7}\n", "shape", "patches",
                  "depth mm", "95 % mm", "contour mm", "cover", "/ least", "freedom", "s");
  int slow = 0;
  std::vector<double> means, seconds_of_all;
  for (const Shape& shape : forty()) {
    CAPTURE(shape.name);
    const auto spec = testing::value(parse_design_spec(spec_of(shape, 2.0).dump()));
    std::optional<Result<Design>> made;
    const double seconds = testing::seconds_of([&] { made = design(spec, shape.assets); });
    if (!*made) FAIL(message(made->error()));
    const Design& card = **made;
    std::ostringstream fold;
    REQUIRE(write_fold(card.pattern, {}, fold));
    VerifyOptions how;
    how.degrees_of_freedom = 1;
    const auto report = testing::value(verify_fold(fold.str(), how));
    CHECK(report.ok());
    const FacetFigures& f = *card.report.facets;
    const auto seen = testing::value(likeness_of(spec, shape, card));
    table += fmt::format(
        "{:<20} {:>7} {:>8.2f} {:>8.2f} {:>10.2f} {:>6.0f}% {:>7.2f} {:>7} {:>7.2f}\n", shape.name,
        f.patches, f.depth_mean_mm, f.depth_p95_mm, seen.contour_mm, 100.0 * seen.cover,
        f.over_least, report.degrees_of_freedom.value_or(0), seconds);
    means.push_back(f.depth_mean_mm);
    seconds_of_all.push_back(seconds);
    slow += seconds > 2.0 ? 1 : 0;
  }
  std::sort(means.begin(), means.end());
  std::sort(seconds_of_all.begin(), seconds_of_all.end());
  fmt::print(
      "{}{}", table,
      fmt::format("{} shapes; median depth {:.2f} mm, median {:.2f} s, {} over 2 s\n", means.size(),
                  means[means.size() / 2], seconds_of_all[seconds_of_all.size() / 2], slow));
}

TEST_CASE("seconds of facets by the points of the sheet", "[bench]") {
  const Shape shape = house(1);
  std::string table;
  for (const double strip_mm : {16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25}) {
    json asked = spec_of(shape, strip_mm);
    asked["min_panel_mm"] = 0.25;
    asked["scale_mm"] = 3.0;
    asked["facets"]["pitch_mm"] = 4.0;
    asked["facets"]["length_mm"] = 270.0;
    const auto spec = testing::value(parse_design_spec(asked.dump()));
    std::optional<Result<Design>> made;
    const double seconds = testing::seconds_of([&] { made = design(spec, shape.assets); });
    if (!*made) FAIL(message(made->error()));
    const Design& card = **made;
    const double points =
        card.pattern.width_mm * (card.pattern.wall_mm + card.pattern.ground_mm) / (strip_mm * 0.5);
    table += fmt::format(
        "strips of {:>4} mm: {:>8.0f} points, {:>4} patches, {:.2f} s, {:.2f} us a point\n",
        strip_mm, points, card.report.facets->patches, seconds, 1e6 * seconds / points);
  }
  fmt::print("{}", table);
}

}  // namespace facets_bench
