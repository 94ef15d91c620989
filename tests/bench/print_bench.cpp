// SPDX-License-Identifier: MIT
// Seconds of the artwork of a sheet of 12 x 12 inches at 300 dots an inch.
#include <ctime>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/design/patches.hpp"
#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/plan.hpp"
#include "daemon/pictures/artwork_pages.hpp"
#include "tests/support/painted_shell.hpp"
#include "tests/support/value.hpp"

namespace print_bench {

using namespace popcut;
using popcut::testing::PaintedShell;

namespace {

/// Of the processor, since one thread does all of it.
class Watch {
 public:
  /// Seconds since it was made, or asked before.
  double lap_s() {
    const std::clock_t now = std::clock(), begun = std::exchange(begun_, now);
    return static_cast<double>(now - begun) / CLOCKS_PER_SEC;
  }

 private:
  std::clock_t begun_{std::clock()};
};

Plan planned(const Pattern& pattern) {
  const auto machine = find_machine("cameo3");
  const auto material = find_material("paper-220");
  REQUIRE(machine);
  REQUIRE(material);
  PlanOptions options;
  options.mat = "12x12";
  options.marks = true;
  options.place.at = PagePoint{16, 16};
  auto made = testing::value(plan(linework_from_pattern(pattern), *machine, *material, options));
  CAPTURE(pattern.width_mm, pattern.wall_mm + pattern.ground_mm);
  REQUIRE(made.sheets.size() == 1);
  return made;
}

void report(const char* style, const std::string& spec_text) {
  PaintedShell shell = testing::painted_shells()[1];
  shell.along = 120, shell.around = 180;  // 43,000 triangles
  const std::string obj = shell.obj();
  const auto spec = testing::value(parse_design_spec(spec_text));
  Watch watch;
  const auto made = testing::value(design_assembly(spec, {{"shell.obj", obj}}));
  const Pattern* const part = &made.parts.front().pattern;
  const double design_s = watch.lap_s();
  const Plan plan = planned(*part);
  const double plan_s = watch.lap_s();
  auto mesh = testing::value(read_colour_mesh("shell.obj", obj, shell.files()));
  const ColourMesh model = model_on_sheet(std::move(mesh), spec.placement, made.parts.front());
  const double read_s = watch.lap_s();
  for (const PrintMode mode : {PrintMode::View, PrintMode::Surface}) {
    (void)watch.lap_s();
    ArtworkOptions how;
    how.mode = mode;
    const auto artwork = testing::value(design_artwork({&part, 1}, {&model, 1}, nullptr, how));
    const double artwork_s = watch.lap_s();
    const auto pdf = testing::value(artwork_sheet_pdf(artwork, "", plan, 0, {}));
    const double page_s = watch.lap_s();
    WARN(
        fmt::format("{:<7} {:<7} {:>6} faces, {:>4.1f} Mpx: design {:.2f} s, plan {:.2f} s, model "
                    "{:.2f} s, artwork {:.2f} s, page {:.2f} s, {:.1f} MB: {:.2f} s a sheet",
                    style, mode == PrintMode::View ? "view" : "surface", part->faces(),
                    1e-6 * static_cast<double>(artwork.frame.pixels()), design_s, plan_s, read_s,
                    artwork_s, page_s, 1e-6 * static_cast<double>(pdf.size()),
                    design_s + plan_s + read_s + artwork_s + page_s));
  }
}

}  // namespace

TEST_CASE("seconds of a printed sheet of 12 x 12 inches at 300 dots an inch", "[bench]") {
  report("lattice", PaintedShell::spec(12, 40, 94));
  report("facets", PaintedShell::facet_spec(88));
}

}  // namespace print_bench
