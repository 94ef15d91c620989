// SPDX-License-Identifier: MIT
// Seconds of books by their number of cards, by how fine these are, and of facets; and of the fit
// of a whole book.
#include <cmath>
#include <ctime>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/book_fit.hpp"
#include "core/design/patches.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/value.hpp"

namespace books_bench {

using namespace popcut;

namespace {

/// Of the processor, all threads.
double cpu_s_of(const auto& work) {
  const std::clock_t begun = std::clock();
  work();
  return static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
}

/// An egg beside the spine: no card is like another.
constexpr const char* kEgg =
    R"({"type": "implicit", "f": "((x - 4)/34)^2 + ((y - 45)/48)^2 + ((z - 2)/30)^2 - 1"})";

std::string lattice_spec(int cards, int units, int slices) {
  return fmt::format(
      R"({{"popcut": 1, "name": "egg", "surface": {}, "units_per_slice": {}, "slices": {},
          "widths_mm": {}, "min_panel_mm": {}, "book": {{"cards": {}}}}})",
      kEgg, units, slices, 90.0 / slices, 4.0 / units, cards);
}

std::string facet_spec(double strip_mm) {
  return fmt::format(
      R"({{"popcut": 1, "name": "torus", "style": "facets",
          "surface": {{"type": "mesh", "file": "torus.obj"}}, "rotate_deg": [90, 0, 0],
          "min_panel_mm": {0}, "facets": {{"strip_mm": {0}, "pitch_mm": 4}},
          "book": {{"cards": 4}}}})",
      strip_mm);
}

struct Measured {
  std::size_t faces{};
  double sheet_mm2{}, design_s{}, fit_s{};
};

Measured measured(const std::string& text, const SurfaceAssets& assets = {}) {
  const auto spec = testing::value(parse_design_spec(text));
  std::optional<Result<PatchAssembly>> made;
  Measured out;
  out.design_s = cpu_s_of([&] { made = design_assembly(spec, assets); });
  if (!*made) FAIL(message(made->error()));
  const PatchAssembly& book = **made;
  REQUIRE(book.book);
  for (const Design& card : book.parts) {
    out.faces += card.pattern.faces();
    out.sheet_mm2 += card.pattern.width_mm * (card.pattern.wall_mm + card.pattern.ground_mm);
  }
  out.fit_s = cpu_s_of([&] { REQUIRE(book_fit(book)); });
  return out;
}

}  // namespace

TEST_CASE("processor seconds of a book by its cards", "[bench]") {
  for (const int cards : {3, 4, 6, 8, 12}) {
    const Measured m = measured(lattice_spec(cards, 10, 60));
    fmt::print(
        "{:>2} cards of 10 units x 60 slices: {:>6} faces, design {:.3f} s ({:.1f} ms a card), fit "
        "{:.2f} s\n",
        cards, m.faces, m.design_s, 1e3 * m.design_s / cards, m.fit_s);
  }
}

TEST_CASE("processor seconds of a book of four cards by how fine it is", "[bench]") {
  for (const auto& [units, slices] :
       {std::pair{5, 30}, {10, 60}, {20, 120}, {40, 240}, {80, 480}}) {
    const Measured m = measured(lattice_spec(4, units, slices));
    fmt::print(
        "{:>3} units x {:>3} slices: {:>7} faces, design {:.3f} s ({:.2f} us a unit), fit {:.2f} "
        "s\n",
        units, slices, m.faces, m.design_s, 1e6 * m.design_s / (4.0 * units * slices), m.fit_s);
  }
}

TEST_CASE("processor seconds of a book of facets by the points of its sheets", "[bench]") {
  const SurfaceAssets assets{{"torus.obj", testing::obj(testing::torus(45, 20, 64))}};
  for (const double strip_mm : {4.0, 2.0, 1.0, 0.5}) {
    const Measured m = measured(facet_spec(strip_mm), assets);
    const double points = m.sheet_mm2 / (strip_mm * 0.5);
    fmt::print(
        "strips of {:>3} mm: {:>8.0f} points, {:>5} faces, design {:.2f} s ({:.2f} us a point), "
        "fit {:.2f} s\n",
        strip_mm, points, m.faces, m.design_s, 1e6 * m.design_s / points, m.fit_s);
  }
}

}  // namespace books_bench
