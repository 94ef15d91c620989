// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/drawing/planar_graph.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/value.hpp"

namespace fold_samples_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

char letter_of(Operation operation) {
  switch (operation) {
    case Operation::FoldMountain:
      return 'M';
    case Operation::FoldValley:
      return 'V';
    case Operation::Outline:
      return 'B';
    default:
      return 'C';
  }
}

void add(const LineWork& work, bool flat, std::vector<CreaseLine>& out) {
  for (const DrawnLine& line : work.lines) {
    const auto p = work.points_of(line);
    for (std::size_t i = 1; i < p.size(); ++i)
      out.push_back({{p[i - 1], p[i]}, flat ? 'F' : letter_of(line.operation)});
  }
}

/// A drawing in the colours of Origami Simulator, flat creases (yellow) too.
PlanarGraph simulator_graph(const std::string& text) {
  const auto known = linework_from_svg(text, SvgProfile::OrigamiSim);
  const auto all = linework_from_svg(text, SvgProfile::Plain);
  REQUIRE(known);
  REQUIRE(all);
  std::vector<CreaseLine> lines;
  add(*known, false, lines);
  add(*all, true, lines);  // the weakest: it stays where nothing else lies
  const auto graph = planar_graph(lines, 3 * 25.4 / 96);  // three user units
  REQUIRE(graph);
  return *graph;
}

PlanarGraph frame_graph(const FoldFrame& frame) {
  std::vector<CreaseLine> lines;
  for (std::size_t e = 0; e < frame.edges.size(); ++e) {
    const auto &a = frame.vertices[frame.edges[e][0]], &b = frame.vertices[frame.edges[e][1]];
    lines.push_back({{{a[0], a[1]}, {b[0], b[1]}}, frame.assignments[e]});
  }
  return value(planar_graph(lines, 1e-6));
}

/// A graph as a FOLD file, (u, v) = (page y, page x).
std::string fold_text(const PlanarGraph& graph) {
  std::string v, e, a, f;
  const auto comma = [](const std::string& list) { return list.empty() ? "" : ","; };
  for (const PagePoint& p : graph.vertices) v += fmt::format("{}[{},{}]", comma(v), p.y, p.x);
  for (const auto& edge : graph.edges) e += fmt::format("{}[{},{}]", comma(e), edge[0], edge[1]);
  for (const char letter : graph.assignments) a += fmt::format("{}\"{}\"", comma(a), letter);
  for (const auto& face : graph.faces) f += fmt::format("{}[{}]", comma(f), fmt::join(face, ","));
  return fmt::format(R"({{"file_spec":1.2,"frame_unit":"mm","vertices_coords":[{}],)"
                     R"("edges_vertices":[{}],"edges_assignment":[{}],"faces_vertices":[{}]}})",
                     v, e, a, f);
}

bool absent(const char* name) {
  if (!sample(name).empty()) return false;
  WARN("skipped: " << name << " is not here");
  return true;
}

}  // namespace

TEST_CASE("crease patterns of other programs have the known numbers of vertices edges and faces",
          "[conformance][formats][fold]") {
  struct Counted {
    const char* name;
    std::size_t vertices, edges, faces, panels;
  };
  for (const Counted& known : {Counted{"fold/os_popupSimple.svg", 96, 167, 72, 20},
                               Counted{"fold/os_housePopup.svg", 157, 357, 201, 35}}) {
    CAPTURE(known.name);
    if (absent(known.name)) continue;
    const PlanarGraph graph = simulator_graph(sample(known.name));
    CHECK(graph.vertices.size() == known.vertices);
    CHECK(graph.edges.size() == known.edges);
    CHECK(graph.faces.size() == known.faces);
    CHECK(graph.joined("F") == known.panels);
    CHECK(graph.joined("FMVU") == 1);
  }
}

TEST_CASE("splitting the cuts changes neither faces nor pieces", "[conformance][formats][fold]") {
  for (const char* name : {"fold/os_popupSimple.svg", "fold/os_housePopup.svg"}) {
    CAPTURE(name);
    if (absent(name)) continue;
    const PlanarGraph graph = simulator_graph(sample(name));
    const PlanarGraph split = split_cuts(graph);
    REQUIRE(split.faces.size() == graph.faces.size());
    for (std::size_t i = 0; i < split.faces.size(); ++i) {
      REQUIRE(split.faces[i].size() == graph.faces[i].size());
      for (std::size_t c = 0; c < split.faces[i].size(); ++c)
        CHECK(split.vertices[split.faces[i][c]] == graph.vertices[graph.faces[i][c]]);
    }
    CHECK(split.joined("F") == graph.joined("F"));
    CHECK(split.joined("FMVU") == 1);
    CHECK(split.vertices.size() > graph.vertices.size());
    // Written as FOLD and read again, the split form is the same drawing.
    const auto again = linework_from_fold(fold_text(split));
    const auto single = linework_from_fold(fold_text(graph));
    REQUIRE(again);
    REQUIRE(single);
    for (const Operation fold_side : {Operation::FoldMountain, Operation::FoldValley})
      CHECK(total_mm(*again, fold_side) == Approx(total_mm(*single, fold_side)));
    CHECK(total_mm(*again, Operation::Cut) + total_mm(*again, Operation::Outline) ==
          Approx(total_mm(*single, Operation::Cut) + total_mm(*single, Operation::Outline)));
  }
}

TEST_CASE("FOLD samples have the faces that their lines bound", "[conformance][formats][fold]") {
  if (absent("fold/re_panels-6x2-90deg.fold")) return;
  const auto panels = value(read_fold(sample("fold/re_panels-6x2-90deg.fold")));
  REQUIRE(panels.frames.size() == 2);
  const PlanarGraph graph = frame_graph(panels.frames[0]);
  CHECK(graph.vertices.size() == 21);
  CHECK(graph.edges.size() == 32);
  CHECK(graph.faces.size() == 12);
  CHECK(panels.frames[0].fold_angles_deg[11] == -90);
  CHECK(panels.frames[1].folded_form);
  CHECK(panels.frames[1].edges.size() == 32);  // inherited
  CHECK(flat_frame(panels) == panels.frames.data());

  const auto windmill = value(read_fold(sample("fold/re_windmill.fold")));
  CHECK(frame_graph(windmill.frames[0]).faces.size() == windmill.frames[0].faces.size());
  CHECK(windmill.frames[1].faces.size() == windmill.frames[0].faces.size());

  const auto no_faces = value(read_fold(sample("fold/re_no-faces.fold")));
  CHECK(no_faces.frames[0].faces.empty());
  CHECK(frame_graph(no_faces.frames[0]).faces.size() == 3);  // of the four, one edge is missing
  CHECK(no_faces.frames[0].assignments == std::vector<char>(7, 'U'));

  const auto diagonal = value(read_fold(sample("fold/fold_diagonal-cp.fold")));
  CHECK(frame_graph(diagonal.frames[0]).faces.size() == 2);
  CHECK(read_fold(sample("fold/fold_box.fold")));
  const auto simple = linework_from_fold(sample("fold/fold_simple.fold"));
  REQUIRE_FALSE(simple);  // a folded form in space, and no crease pattern
  CHECK(simple.error().place == "/vertices_coords");
}

TEST_CASE("invalid FOLD samples are refused with the place and the valid form",
          "[conformance][formats][fold]") {
  if (absent("fold/re_invalid-key-names.fold")) return;
  const auto names = read_fold(sample("fold/re_invalid-key-names.fold"));
  REQUIRE_FALSE(names);
  CHECK(message(names.error()) ==
        "/vertices_coords: is missing; is \"vertices_coord\" a misspelling of it?");
  const auto lengths = read_fold(sample("fold/re_invalid-mismatch-length.fold"));
  REQUIRE_FALSE(lengths);
  CHECK(
      message(lengths.error()) ==
      "/edges_assignment: has 5 entries, but edges_vertices has 4; both must have the same length");
}

}  // namespace fold_samples_test
