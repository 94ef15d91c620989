// SPDX-License-Identifier: MIT
#include <sstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace dxf_ezdxf_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

using Points = std::vector<PagePoint>;

double farthest(std::span<const PagePoint> points, std::span<const PagePoint> line) {
  double far = 0.0;
  for (const PagePoint& p : points) {
    double near = 1e300;
    for (std::size_t i = 1; i < line.size(); ++i)
      near = std::min(near, distance_to(p, line[i - 1], line[i]));
    far = std::max(far, near);
  }
  return far;
}

/// Points on every chord, so that what bulges between corners is seen, too.
Points densely(std::span<const PagePoint> line) {
  Points out;
  for (std::size_t i = 1; i < line.size(); ++i)
    for (int k = 0; k <= 4; ++k)
      out.push_back({line[i - 1].x + k / 4.0 * (line[i].x - line[i - 1].x),
                     line[i - 1].y + k / 4.0 * (line[i].y - line[i - 1].y)});
  return out;
}

}  // namespace

TEST_CASE("every entity of every DXF version lies where ezdxf has it",
          "[conformance][formats][dxf]") {
  const std::string version = GENERATE("R12", "R2000", "R2010", "R2018");
  CAPTURE(version);
  const popcut::testing::TempFolder folder;
  const auto made = popcut::testing::run_program(
      {"/usr/bin/python3", popcut::testing::source_file("tests/support/make_dxf.py"), version,
       (folder / "all.dxf").string()},
      folder.path());
  if (made.exit == 127 || made.out.rfind("skip", 0) == 0) {
    WARN("skipped: python3-ezdxf is not installed");
    return;
  }
  CAPTURE(made.err);
  REQUIRE(made.exit == 0);
  const auto read = linework_from_dxf(popcut::testing::text_of_file(folder / "all.dxf"));
  INFO((read ? "" : message(read.error())));
  REQUIRE(read);
  const auto binary = linework_from_dxf(popcut::testing::text_of_file(folder / "all.dxf.binary"));
  INFO((binary ? "" : message(binary.error())));
  REQUIRE(binary);
  CHECK(binary->points == read->points);
  const auto theirs = nlohmann::json::parse(made.out);
  REQUIRE(read->lines.size() == theirs.size());
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    CAPTURE(i, theirs[i]["layer"].get<std::string>(), theirs[i]["type"].get<std::string>());
    Points other;
    for (const auto& p : theirs[i]["points"])
      other.push_back({p[0].get<double>(), -p[1].get<double>()});
    const auto own = read->points_of(read->lines[i]);
    // Our chords keep within 0.02 mm, theirs within 0.001 mm of curves that are themselves off
    // by 0.0003 of the radius for arcs of polylines.
    CHECK(farthest(densely(own), other) <= 0.025);
    CHECK(farthest(densely(other), own) <= 0.025);
    CHECK(closed(own) == (distance(other.front(), other.back()) < 1e-9 && other.size() > 2));
    CHECK(length(own) == Approx(length(other)).epsilon(4e-3));
  }
}

TEST_CASE("ezdxf reads the DXF of a sheet without a complaint, in mm and at the same lengths",
          "[conformance][formats][dxf]") {
  LineWork work;
  const Points ring{{5, 5}, {95, 5}, {95, 75}, {5, 75}, {5, 5}};
  work.append(Operation::Draw, Points{{1, 1}, {4, 5}});
  for (int i = 0; i < 9; ++i)
    work.append(Operation::FoldValley, Points{{10 + 2.5 * i, 40}, {11.5 + 2.5 * i, 40}});
  work.append(Operation::Cut, Points{{20, 20}, {30, 20}, {30, 32.5}});
  work.append(Operation::Outline, ring);
  const popcut::testing::TempFolder folder;
  std::ostringstream dxf;
  write_sheet_dxf(work, {100, 80}, dxf);
  popcut::testing::write_file(folder / "sheet.dxf", dxf.str());
  const auto seen = popcut::testing::run_program({"/usr/bin/python3", "-c", R"py(
import json, sys
try:
    import ezdxf
except ImportError:
    print("skip"); sys.exit(0)
document = ezdxf.readfile(sys.argv[1])
mm, order = {}, []
for one in document.modelspace():
    line = [one.dxf.start, one.dxf.end] if one.dxftype() == "LINE" else [v.dxf.location for v in one.vertices]
    if one.dxftype() != "LINE" and one.is_closed:
        line.append(line[0])
    layer = one.dxf.layer
    mm[layer] = mm.get(layer, 0) + sum((b - a).magnitude for a, b in zip(line, line[1:]))
    if layer not in order:
        order.append(layer)
print(json.dumps({"errors": len(document.audit().errors), "units": document.units, "mm": mm, "order": order}))
)py",
                                                  (folder / "sheet.dxf").string()},
                                                 folder.path());
  if (seen.exit == 127 || seen.out.rfind("skip", 0) == 0) {
    WARN("skipped: python3-ezdxf is not installed");
    return;
  }
  CAPTURE(seen.err);
  REQUIRE(seen.exit == 0);
  const auto theirs = nlohmann::json::parse(seen.out);
  CHECK(theirs["errors"] == 0);
  CHECK(theirs["units"] == 4);
  CHECK(theirs["order"] == nlohmann::json::array({"DRAW", "FOLD", "CUT"}));
  CHECK(theirs["mm"]["DRAW"].get<double>() == Approx(5));
  CHECK(theirs["mm"]["FOLD"].get<double>() == Approx(13.5));
  CHECK(theirs["mm"]["CUT"].get<double>() == Approx(22.5 + 320));
}

}  // namespace dxf_ezdxf_test
