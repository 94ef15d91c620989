// SPDX-License-Identifier: MIT
// Drawings: lines without faces, from SVG or a FOLD file that lists none.
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/verify/sheet/planar.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"
#include "tests/support/verify_drafts.hpp"

namespace verify_drawing_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// A drawing on a page, x to the right and y down.
class Drawing {
 public:
  Drawing& line(Operation operation, std::initializer_list<PagePoint> points) {
    work_.append(operation, std::vector<PagePoint>(points));
    return *this;
  }
  [[nodiscard]] VerifyReport verified() const {
    VerifyOptions options;
    options.page = true;
    const auto report = verify_fold(fold_from_linework(work_), options);
    if (!report) FAIL("not read: " << message(report.error()));
    return *report;
  }

 private:
  LineWork work_;
};

/// A card of 50 x 80 with a box of 30 x 25 x 20: the spine at y = 40, lines only.
Drawing box_drawing() {
  Drawing drawing;
  drawing.line(Operation::Outline, {{0, 0}, {50, 0}, {50, 80}, {0, 80}, {0, 0}})
      .line(Operation::FoldValley, {{0, 40}, {10, 40}})
      .line(Operation::FoldValley, {{40, 40}, {50, 40}})
      .line(Operation::Cut, {{10, 20}, {10, 65}})
      .line(Operation::Cut, {{40, 20}, {40, 65}})
      .line(Operation::FoldValley, {{10, 20}, {40, 20}})
      .line(Operation::FoldMountain, {{10, 45}, {40, 45}})
      .line(Operation::FoldValley, {{10, 65}, {40, 65}});
  return drawing;
}

const std::filesystem::path kSamples = popcut::testing::source_file("../shared/data/fold");

}  // namespace

TEST_CASE("lines on a page become a sheet and the sheet opens", "[core][verify]") {
  const VerifyReport report = box_drawing().verified();
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(report.faces == 4);
  CHECK(report.hinges == 4);
  CHECK(report.slits == 2);
  CHECK(report.degrees_of_freedom == 1U);
  CHECK(report.area_mm2 == Approx(4000.0));
  CHECK(report.sheet_u_mm == Approx(80.0));
  CHECK(report.crossing_method == "exact");
}

TEST_CASE("lines that cross or touch without a vertex are split there", "[core][verify]") {
  Drawing drawing;
  // The spine is drawn across the whole sheet, the box's slits over its ends.
  drawing.line(Operation::Outline, {{0, 0}, {50, 0}, {50, 80}, {0, 80}, {0, 0}})
      .line(Operation::FoldMountain, {{-5, 30}, {55, 30}})
      .line(Operation::FoldValley, {{20, 0}, {20, 80}});
  const VerifyReport report = drawing.verified();
  INFO(verify_text(report));
  CHECK(report.fold_faces == 4);
  CHECK(passes(report, "isometry"));
  CHECK(has(verify_text(report), "3 crossings of lines became vertices"));
  // The mountain's ends reach out of the sheet.
  CHECK(has(failures(report, "faces"), "the line near x -2.50, y 30.00 mm: the mountain fold"));
}

TEST_CASE("ends that miss each other by a little are joined and the report says by how much",
          "[core][verify]") {
  Drawing drawing;
  drawing.line(Operation::Outline, {{0, 0}, {50.02, 0}, {50, 80}, {0, 80.03}, {0, 0.02}})
      .line(Operation::Outline, {{0, 0.02}, {0.01, 0}})
      .line(Operation::FoldValley, {{0.04, 40}, {49.95, 40}});
  const VerifyReport report = drawing.verified();
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(report.faces == 2);
  CHECK(report.degrees_of_freedom == 1U);
  CHECK(has(verify_text(report), "line ends that did not quite meet were moved by up to"));
}

TEST_CASE("a fold drawn as a row of dashes is one fold", "[core][verify]") {
  Drawing drawing;
  drawing.line(Operation::Outline, {{0, 0}, {50, 0}, {50, 80}, {0, 80}, {0, 0}});
  const auto dashes = [&](Operation operation, double y, double from, double to) {
    for (double x = from + 0.5; x + 1.5 <= to; x += 2.5)
      drawing.line(operation, {{x, y}, {x + 1.5, y}});
  };
  drawing.line(Operation::Cut, {{10, 20}, {10, 65}}).line(Operation::Cut, {{40, 20}, {40, 65}});
  dashes(Operation::FoldValley, 40, 0, 10);
  dashes(Operation::FoldValley, 40, 40, 50);
  dashes(Operation::FoldValley, 20, 10, 40);
  dashes(Operation::FoldMountain, 45, 10, 40);
  dashes(Operation::FoldValley, 65, 10, 40);
  const VerifyReport report = drawing.verified();
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(report.faces == 4);
  CHECK(report.hinges == 4);
  CHECK(report.degrees_of_freedom == 1U);
  CHECK(has(verify_text(report), "folds are drawn as dashes: "));
}

TEST_CASE("windows fall out and loose slits inside a panel belong to it", "[core][verify]") {
  Drawing drawing = box_drawing();
  drawing
      .line(Operation::Cut, {{20, 5}, {30, 5}, {30, 15}, {20, 15}, {20, 5}})  // in the wall
      .line(Operation::Cut, {{22, 30}, {28, 30}})                             // in the box
      .line(Operation::Cut, {{60, 10}, {70, 10}});                            // beside the sheet
  const VerifyReport report = drawing.verified();
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(report.faces == 4);
  CHECK(report.holes == 1);
  CHECK(report.area_mm2 == Approx(3900.0));
  CHECK(report.degrees_of_freedom == 1U);
  CHECK(has(verify_text(report), "1 areas surrounded by cuts fall out"));
  CHECK(has(verify_text(report), "1 cuts outside the sheet are ignored"));
}

TEST_CASE("a piece with folds inside a closed cut is reported as cut off", "[core][verify]") {
  Drawing drawing = box_drawing();
  drawing.line(Operation::Cut, {{20, 2}, {30, 2}, {30, 18}, {20, 18}, {20, 2}})
      .line(Operation::FoldValley, {{20, 10}, {30, 10}});
  const VerifyReport report = drawing.verified();
  INFO(verify_text(report));
  CHECK(report.pieces == 2);
  CHECK(has(failures(report, "pieces"), "the face near x 25.00"));
}

TEST_CASE("a FOLD file without faces gets those that its lines enclose", "[core][verify]") {
  FoldDraft draft = draft_of(CylinderCard{.levels = 3, .slices = 3});
  const VerifyReport listed = verified(draft, {.degrees_of_freedom = 1});
  draft.faces.clear();
  draft.poses.clear();
  const VerifyReport traced = verified(draft, {.degrees_of_freedom = 1});
  INFO(verify_text(traced));
  CHECK(traced.ok());
  CHECK(traced.faces == listed.faces);
  CHECK(traced.hinges == listed.hinges);
  CHECK(traced.area_mm2 == Approx(listed.area_mm2));
  CHECK(traced.slits == listed.slits);
}

TEST_CASE("a drawing in which all lines cross is handled in finite time", "[core][verify]") {
  LineWork work;
  for (int k = 0; k < 500; ++k) {
    const double at = 0.3 * k;
    const double to = 0.3 * ((k * 37) % 500);
    work.append(Operation::Cut, std::vector<PagePoint>{{0.0, at}, {150.0, to}});
    work.append(Operation::Cut, std::vector<PagePoint>{{at, 0.0}, {to, 150.0}});
  }
  const auto report = verify_fold(fold_from_linework(work));
  REQUIRE_FALSE(report);
  CHECK(exit_code(report.error().kind) == 3);
  INFO(message(report.error()));
  CHECK(has(message(report.error()), "too many lines cross"));
}

TEST_CASE("drawings of other programs have the known numbers of panels", "[core][verify]") {
  if (!std::filesystem::exists(kSamples)) {
    WARN("skipped: no sample files beside the source");
    return;
  }
  struct Known {
    const char* name;
    std::size_t panels, faces;
    bool judged;  ///< crossings: not on one of the many motions of a net of 30 freedoms
  };
  for (const Known& known :
       {Known{"os_popupSimple.svg", 20, 20, true}, Known{"os_housePopup.svg", 35, 35, true},
        Known{"os_miura-ori.svg", 156, 156, true}, Known{"re_hex-box.svg", 31, 31, false}}) {
    CAPTURE(known.name);
    std::ifstream in(kSamples / known.name);
    std::ostringstream text;
    text << in.rdbuf();
    const auto work = value(linework_from_svg(text.str(), SvgProfile::OrigamiSim));
    VerifyOptions options;
    options.page = true;
    const auto report = value(verify_fold(fold_from_linework(work), options));
    INFO(verify_text(report));
    CHECK(report.faces == known.panels);
    CHECK(report.pieces == 1);
    CHECK(report.ok());
    CHECK(report.crossing_method.empty() != known.judged);
    CHECK(report.opening->reached_psi_rad == Approx(1.1));
  }
}

}  // namespace verify_drawing_test
