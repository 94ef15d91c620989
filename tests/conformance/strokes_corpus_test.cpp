// SPDX-License-Identifier: MIT
// Drawings made by the corpus' generator, which is not part of the repository: where it is absent
// the cases say so and pass.
#include <catch2/catch.hpp>

#include "core/drawing/clean.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "tests/support/corpus.hpp"
#include "tests/support/euler_count.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/value.hpp"

namespace strokes_corpus_test {

using namespace popcut;
using namespace popcut::testing;

TEST_CASE("lifts equal the Euler minimum on every file of the corpus", "[core][plan][euler]") {
  const auto files = corpus();
  if (files.empty()) WARN("skipped: no generator of drawings, or no Python with numpy");
  for (const auto& file : files) {
    CAPTURE(file.filename().string());
    const auto work = value(linework_from_svg(text_of(file), SvgProfile::Plain));
    const LineWork cleaned = clean(work);
    EulerCount count(work, kSnapTolerance);
    double drawn = count.edges_mm(), kept = 0.0;
    for (const DrawnLine& line : cleaned.lines) kept += length(cleaned.points_of(line));
    CAPTURE(drawn, kept);
    // Of the graph that is left, each operation's strokes are as few as Euler asks for.
    EulerCount left(cleaned, 0.001);
    CHECK(cleaned.lines.size() == left.strokes());
    // That graph is the drawing's, but for what lies on other lines to 0.01 mm: of 100 000 random
    // strokes some parts do, and taking them away joins the strokes beside them.
    if (kept >= drawn - 1.0)
      CHECK(cleaned.lines.size() == count.strokes());
    else
      CHECK(cleaned.lines.size() <= count.strokes());
    // Nothing is lost and nothing is made up.
    CHECK(kept <= drawn + 1.0);
    CHECK(kept >= drawn * 0.9995 - 1.0);
  }
}

}  // namespace strokes_corpus_test
