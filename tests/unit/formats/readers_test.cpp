// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>
#include <catch2/catch.hpp>

#include "core/design/spec/spec.hpp"
#include "core/formats/csv/segments_reader.hpp"
#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/fold/crease_pattern.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_transform.hpp"
#include "core/model/height_grid.hpp"
#include "tests/support/growth.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/value.hpp"

namespace readers_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

std::string svg(
    const std::string& inner,
    const std::string& head = R"x(width="100mm" height="100mm" viewBox="0 0 100 100")x") {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"i\" " + head + ">" + inner +
         "</svg>";
}

Result<SvgLines> parse_svg_path(std::string_view data, double tolerance, std::size_t most_points) {
  SvgLines lines;
  return read_svg_path(data, tolerance, most_points, lines).map([&] { return lines; });
}

LineWork read(const std::string& text, SvgProfile profile = SvgProfile::Popcut) {
  const auto work = linework_from_svg(text, profile);
  INFO((work ? "" : message(work.error())));
  REQUIRE(work);
  return *work;
}

std::string place_of(const std::string& text) {
  const auto work = linework_from_fold(text);
  REQUIRE_FALSE(work);
  return work.error().place;
}

}  // namespace

TEST_CASE("path data is read with all its commands", "[core][formats][svg]") {
  const auto lines =
      value(parse_svg_path("M0,0h10v10H0z m20 20 5 0 0 5 M1 1L.5.5-1-1", 0.01, 1000));
  REQUIRE(lines.size() == 3);
  CHECK(lines[0].size() == 5);
  CHECK(lines[0].front() == lines[0].back());
  CHECK(lines[1][2] == PagePoint{25, 25});
  CHECK(lines[2][1] == PagePoint{0.5, 0.5});
  CHECK(lines[2][2] == PagePoint{-1, -1});
  for (const char* wrong : {"L1 1", "M", "M1", "M1 1L", "M1 1 x", "M1 1L1,,1", "M1 1A1 1 0 2 0 3 3",
                            "Z", "M1 1Z1 1", "Minf 1", "M1e999 1"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_svg_path(wrong, 0.01, 1000));
  }
  CHECK_FALSE(parse_svg_path("M0 0C0 1000 1000 1000 1000 0", 1e-9, 1000));
}

TEST_CASE("curves stay within tolerance of their chords", "[core][formats][svg]") {
  const double r = 50;
  const auto circle =
      value(parse_svg_path("M50 0A50 50 0 0 1 -50 0 50 50 0 01 50,0", 0.02, 100000));
  const auto& points = circle[0];
  for (std::size_t i = 1; i < points.size(); ++i) {
    const PagePoint middle{(points[i - 1].x + points[i].x) / 2,
                           (points[i - 1].y + points[i].y) / 2};
    CHECK(std::hypot(points[i].x, points[i].y) == Approx(r));
    CHECK(r - std::hypot(middle.x, middle.y) <= 0.02 + 1e-9);
  }
  CHECK(length(points) == Approx(2 * M_PI * r).epsilon(1e-3));
  CHECK(turning(points) > 0);  // sweep 1: clockwise on a page with y down
  const auto bezier =
      parse_svg_path("M0 0C0 40 60 40 60 0S120-40 120 0Q140 40 160 0T200 0", 0.02, 100000);
  REQUIRE(bezier);
  CHECK((*bezier)[0].back() == PagePoint{200, 0});
  // The S part is the C part turned by half a turn about (60, 0).
  double low = 0, high = 0;
  for (const PagePoint& p : (*bezier)[0]) {
    if (p.x <= 60) high = std::max(high, p.y);
    if (p.x > 60 && p.x <= 120) low = std::min(low, p.y);
  }
  CHECK(high == Approx(30).epsilon(1e-3));
  CHECK(low == Approx(-30).epsilon(1e-3));
}

TEST_CASE("transforms are applied from the inside out", "[core][formats][svg]") {
  const auto t = value(parse_svg_transform("translate(10,20) rotate(90) scale(2 3)"));
  const PagePoint p = t({1, 1});
  CHECK(p.x == Approx(7));
  CHECK(p.y == Approx(22));
  const PagePoint q = (*parse_svg_transform("rotate(90 5 5)"))({6, 5});
  CHECK(q.x == Approx(5));
  CHECK(q.y == Approx(6));
  CHECK(t.largest_scale() == Approx(3));
  CHECK_FALSE(parse_svg_transform("rotate(90"));
  CHECK_FALSE(parse_svg_transform("scale(1 2 3)"));
  CHECK_FALSE(parse_svg_transform("sqew(1)"));
}

TEST_CASE("shapes are converted to millimetres", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<g stroke="black" transform="translate(5 5)">
      <rect x="0" y="0" width="10" height="20"/><circle cx="50" cy="50" r="10"/>
      <line x1="0" y1="0" x2="3" y2="4"/><polyline points="0,0 1,0 1,1"/>
      <polygon points="0 0 4 0 4 3"/><ellipse cx="9" cy="9" rx="3" ry="2"/></g>)x"));
  REQUIRE(work.lines.size() == 6);
  CHECK(length(work.points_of(work.lines[0])) == Approx(60));
  CHECK(work.points_of(work.lines[0])[0] == PagePoint{5, 5});
  CHECK(length(work.points_of(work.lines[1])) == Approx(20 * M_PI).epsilon(2e-3));
  CHECK(length(work.points_of(work.lines[2])) == Approx(5));
  CHECK(length(work.points_of(work.lines[3])) == Approx(2));
  CHECK(length(work.points_of(work.lines[4])) == Approx(12));
  CHECK(work.warnings.empty());
  CHECK(work.points_of(work.lines[1]).front() == work.points_of(work.lines[1]).back());
  const LineWork pixels = read(svg("<path stroke='red' d='M0 0H96'/>", "width='200' height='100'"));
  CHECK(length(pixels.points) == Approx(25.4));
  CHECK(pixels.warnings.size() == 1);
  const LineWork inches =
      read(svg("<path stroke='red' d='M0 0H10'/>", "width='2in' height='1in' viewBox='0 0 20 10'"));
  CHECK(length(inches.points) == Approx(25.4));
  const LineWork round = read(svg("<rect stroke='red' width='20' height='10' rx='2'/>"));
  CHECK(length(round.points) == Approx(60 - 16 + 4 * M_PI).epsilon(2e-3));
}

TEST_CASE("assignments and layers and profiles give a line its meaning", "[core][formats][svg]") {
  const std::string text =
      svg(R"x(<g inkscape:groupmode="layer" inkscape:label="fold-valley" stroke="#000">
      <path d="M0 0H1"/><path d="M0 1H2" data-assignment="M"/><path d="M0 1H2" data-assignment="F"/></g>
      <g stroke="red"><path d="M0 2H4"/><path d="M0 3H5" style="stroke: rgb(0,0,255); fill:none"/>
      <path d="M0 4H6" stroke="#0f0"/><path d="M0 5H7" stroke="none"/><path d="M0 5H7" display="none"/></g>)x");
  const LineWork own = read(text);
  CHECK(total_mm(own, Operation::FoldValley) == Approx(1));
  CHECK(total_mm(own, Operation::FoldMountain) == Approx(2));
  CHECK(total_mm(own, Operation::Cut) == Approx(15));
  const LineWork simulator = read(text, SvgProfile::OrigamiSim);
  CHECK(total_mm(simulator, Operation::FoldMountain) == Approx(2 + 4));
  CHECK(total_mm(simulator, Operation::FoldValley) == Approx(1 + 5));
  CHECK(total_mm(simulator, Operation::Cut) == Approx(6));
  const LineWork plain = read(text, SvgProfile::Plain);
  CHECK(total_mm(plain, Operation::Cut) == Approx(1 + 2 + 2 + 4 + 5 + 6));
}

TEST_CASE("lines dashed by their style are cut as those dashes", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<path d="M0 0H10" stroke="red" stroke-dasharray="2"/>
      <path d="M0 5H10" stroke="red" style="stroke-dasharray:3,1;stroke-dashoffset:1"/>)x"));
  REQUIRE(work.lines.size() == 3 + 3);
  CHECK(total_mm(work, Operation::Cut) == Approx(6 + 2 + 3 + 3));
  CHECK(work.warnings.size() == 1);
  const LineWork fold =
      read(svg(R"x(<path d="M0 0H10" stroke="red" stroke-dasharray="2" data-assignment="M"/>)x"));
  CHECK(total_mm(fold, Operation::FoldMountain) == Approx(10));
  CHECK_FALSE(linework_from_svg(
      svg(R"x(<path d="M0 0H10" stroke="red" stroke-dasharray="1e-9"/>)x"), SvgProfile::Plain));
}

TEST_CASE("elements that cannot be cut are named with their number and place",
          "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<text id="t">hello</text>
      <image/><image/><use href="#a"/><defs><path d="M0 0H9" stroke="red"/></defs>)x"));
  CHECK(work.lines.empty());
  std::string all;
  for (const Warning& warning : work.warnings) all += warning.message + "\n";
  CAPTURE(all);
  CHECK(all.find("1 <text> cannot be read and is left out; at line 1 (id \"t\")") !=
        std::string::npos);
  CHECK(all.find("2 <image> cannot be read and are left out; the first at line 2") !=
        std::string::npos);
  CHECK(all.find("1 <use> of a missing element") != std::string::npos);
}

TEST_CASE("a drawing that cannot be read is refused with line and column", "[core][formats][svg]") {
  const auto wrong =
      linework_from_svg(svg("\n  <path stroke='red' d='M0 0 L5'/>"), SvgProfile::Plain);
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().kind == ErrorKind::Malformed);
  CHECK(wrong.error().place.rfind("line 2, column", 0) == 0);
  for (const std::string& text :
       {std::string(), std::string("hello"), std::string("<svg"), std::string("<html/>"),
        svg("<path stroke='red' d='M0 0H1' transform='scale(1e300)'/>"),
        svg("<rect stroke='red' width='a'/>"), svg("", "viewBox='0 0 0 0'")}) {
    CAPTURE(text);
    CHECK_FALSE(linework_from_svg(text, SvgProfile::Plain));
  }
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<g>";
  for (int i = 0; i < 5000; ++i) deep += "</g>";
  CHECK_FALSE(linework_from_svg(svg(deep), SvgProfile::Plain));
}

TEST_CASE("FOLD vertices are turned onto the page and never mirrored", "[core][formats][fold]") {
  const auto work = value(linework_from_fold(R"x({"frame_unit": "cm",
    "vertices_coords": [[0,0],[3,0],[3,1],[0,1],[1,0],[1,1]],
    "edges_vertices": [[0,4],[4,1],[1,2],[2,5],[5,3],[3,0],[4,5]],
    "edges_assignment": ["B","B","B","B","B","B","M"]})x"));
  CHECK(work.warnings.empty());
  CHECK(count(work, Operation::Outline) == 1);
  CHECK(total_mm(work, Operation::Outline) == Approx(80));
  REQUIRE(count(work, Operation::FoldMountain) == 1);
  const auto fold = work.points_of(work.lines[0]);
  CHECK(fold[0] == PagePoint{0, 10});
  CHECK(fold[1] == PagePoint{10, 10});
}

TEST_CASE("two borders on one line become a slit that is cut once", "[core][formats][fold]") {
  // A 4 x 2 sheet with a slit from (1,1) to (3,1): its sides have vertices 6 and 7 of their own and
  // are divided differently.
  const auto work = value(linework_from_fold(R"x({"frame_unit": "mm",
    "vertices_coords": [[0,0],[40,0],[40,20],[0,20],[10,10],[30,10],[20,10],[25,10]],
    "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[4,6],[6,5],[4,7],[7,5]],
    "edges_assignment": ["B","B","B","B","B","B","B","B"]})x"));
  CHECK(total_mm(work, Operation::Outline) == Approx(120));
  CHECK(total_mm(work, Operation::Cut) >= 20.0 - 1e-9);
  // A hole is a cut and no outline.
  const auto hole = value(linework_from_fold(R"x({"frame_unit": "mm",
    "vertices_coords": [[0,0],[40,0],[40,20],[0,20],[10,5],[30,5],[30,15],[10,15]],
    "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[4,5],[5,6],[6,7],[7,4]],
    "edges_assignment": ["B","B","B","B","B","B","B","B"]})x"));
  CHECK(total_mm(hole, Operation::Outline) == Approx(120));
  CHECK(total_mm(hole, Operation::Cut) == Approx(60));
}

TEST_CASE("FOLD edges keep their meaning", "[core][formats][fold]") {
  const auto work = value(linework_from_fold(
      R"x({"frame_unit": "mm", "vertices_coords": [[0,0],[0,1],[0,3],[0,6],[0,10],[0,15]],
    "edges_vertices": [[0,1],[1,2],[2,3],[3,4],[4,5]],
    "edges_assignment": ["C","F","U","U",null], "edges_foldAngles": [0,0,-90,null,45]})x"));
  CHECK(total_mm(work, Operation::Cut) == Approx(1));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(3));
  CHECK(total_mm(work, Operation::FoldValley) == Approx(5));
  CHECK(work.warnings.size() == 3);
}

TEST_CASE("an invalid FOLD file is refused with its place", "[core][formats][fold]") {
  CHECK(place_of("{") == "line 1, column 1");
  CHECK(place_of("[]") == "/");
  CHECK(place_of(R"x({"vertices_coord": []})x") == "/vertices_coords");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1]]})x") == "/vertices_coords/1");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1,"a"]]})x") == "/vertices_coords/1/1");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,2]]})x") ==
        "/edges_vertices/0/1");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,-1]]})x") ==
        "/edges_vertices/0/1");
  CHECK(
      place_of(
          R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,1]], "edges_assignment": ["Q"]})x") ==
      "/edges_assignment/0");
  CHECK(
      place_of(
          R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,1]], "edges_assignment": []})x") ==
      "/edges_assignment");
  CHECK(place_of(R"x({"vertices_coords": [[0,0,1],[1,1,2]], "edges_vertices": [[0,1]]})x") ==
        "/vertices_coords");
  CHECK(
      place_of(
          R"x({"vertices_coords": [[0,0]], "file_frames": [{"frame_inherit": true, "frame_parent": 7}]})x") ==
      "/file_frames/0/frame_parent");
  CHECK(
      place_of(
          R"x({"frame_unit": "ell", "vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,1]]})x") ==
      "/frame_unit");
  CHECK_FALSE(linework_from_fold(std::string(1'000'000, '[')));
}

TEST_CASE("sample drawings of other programs are read or refused as expected", "[core][formats]") {
  if (sample("fold/fold_simple.fold").empty()) {
    WARN("skipped: the sample drawings are not here");
    return;
  }
  for (const char* name : {"fold_simple", "fold_box", "fold_diagonal-cp", "re_no-faces",
                           "re_panels-6x2-90deg", "re_windmill"}) {
    CAPTURE(name);
    const auto file = read_fold(sample(std::string("fold/") + name + ".fold"));
    INFO((file ? "" : message(file.error())));
    CHECK(file);
  }
  for (const char* name : {"re_invalid-key-names", "re_invalid-mismatch-length"}) {
    CAPTURE(name);
    const auto file = read_fold(sample(std::string("fold/") + name + ".fold"));
    REQUIRE_FALSE(file);
    CHECK_FALSE(file.error().detail.empty());
    CHECK_FALSE(file.error().place.empty());
  }
  const auto panels = value(linework_from_fold(sample("fold/re_panels-6x2-90deg.fold")));
  CHECK(count(panels, Operation::Outline) == 1);
  for (const char* name : {"os_popupSimple", "os_housePopup", "os_miura-ori", "re_hex-box"}) {
    CAPTURE(name);
    const auto work =
        linework_from_svg(sample(std::string("fold/") + name + ".svg"), SvgProfile::OrigamiSim);
    INFO((work ? "" : message(work.error())));
    REQUIRE(work);
    CHECK(work->lines.size() > 10);
    CHECK(total_mm(*work, Operation::FoldValley) > 0);
  }
}

namespace {

// Files that are dear to read if a reader is careless: what is named often, nested, repeated, or
// looked up. Names and numbers differ where a reader may remember what it saw.
std::string page(const std::string& inner) {
  return R"(<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">)" +
         inner + "</svg>";
}
const std::string kStroke = R"(<path d="M1 1h5" stroke="#000"/>)";

std::string in_defs(const std::string& defs, const std::string& shown) {
  return page("<defs>" + defs + "</defs>" + shown);
}

std::string dxf_of(const std::string& entities, const std::string& blocks = "",
                   const std::string& tables = "") {
  const auto section = [](const char* name, const std::string& inner) {
    return inner.empty() ? "" : fmt::format("0\nSECTION\n2\n{}\n{}0\nENDSEC\n", name, inner);
  };
  return "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n" + section("TABLES", tables) +
         section("BLOCKS", blocks) + section("ENTITIES", entities) + "0\nEOF\n";
}
std::string line_on(const std::string& layer) {
  return "0\nLINE\n8\n" + layer + "\n10\n0\n20\n0\n11\n9\n21\n1\n";
}
std::string insert(const std::string& name, const std::string& more = "") {
  return "0\nINSERT\n8\n0\n2\n" + name + "\n10\n0\n20\n0\n" + more;
}
std::string block(const std::string& name, const std::string& inner) {
  return "0\nBLOCK\n2\n" + name + "\n10\n0\n20\n0\n" + inner + "0\nENDBLK\n";
}
std::string grid_of(std::size_t n) {
  return fmt::format("70\n{}\n71\n{}\n44\n0.1\n45\n0.1\n", n, n);
}
std::string nested_blocks(std::size_t n, std::size_t each, const std::string& inner) {
  return times(n,
               [&](std::size_t k) {
                 return block(fmt::format("a{}", k),
                              times(each, insert(fmt::format("a{}", k + 1))));
               }) +
         block(fmt::format("a{}", n), inner);
}

std::string fold_of(const std::string& vertices, const std::string& edges,
                    const std::string& more = "") {
  const auto count = static_cast<std::size_t>(std::count(edges.begin(), edges.end(), '['));
  return R"({"file_spec": 1.1, "vertices_coords": [)" + vertices + R"([90, 0], [90, 90]],
"edges_vertices": [)" +
         edges + R"([0, 1]], "edges_assignment": [)" + times(count, R"("B", )") + R"("B"])" + more +
         "}";
}

std::string gzip_of(const std::string& text) {
  constexpr int kGzip = 16;
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, kGzip + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out(deflateBound(&stream, text.size()), '\0');
  std::string in = text;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

// With a hundredth of the usual limits, what repeats itself reaches them soon.
void read_svg_by(const char* name, const std::string& text) {
  auto profile = find_stroke_profile(name);
  if (!profile) return;
  SvgReadOptions how;
  how.profile = std::move(*profile);
  how.limits.steps /= 100;
  (void)linework_from_svg(text, how);
}
void read_svg(const std::string& text) { read_svg_by("popcut", text); }
void ask_svg(const std::string& text) { read_svg_by("auto", text); }
void read_dxf(const std::string& text) {
  DxfOptions how;
  how.colours = DxfColours::Asked;
  how.most_lines /= 300;
  how.most_points /= 10;
  (void)linework_from_dxf(text, how);
}
void read_fold(const std::string& text) { (void)linework_from_fold(text); }
void read_creases(const std::string& text) {
  if (!is_crease_pattern(text)) return;
  if (const auto fold = fold_of_crease_pattern(text)) (void)linework_from_fold(*fold);
}
void read_spec(const std::string& text) { (void)parse_design_spec(text); }

}  // namespace

TEST_CASE("no drawing takes work or memory out of proportion to its size",
          "[core][formats][dear]") {
  using std::to_string;
  // clang-format off
  const std::vector<DearFile> svg{
      {"svg: groups in groups", 100, [](std::size_t n) { return page(times(n, "<g transform='translate(1)' class='a b'>") + kStroke + times(n, "</g>")); }, read_svg},
      {"svg: use of use", 100, [](std::size_t n) { return in_defs("<g id='a0'>" + kStroke + "</g>" + times(n, [](std::size_t k) { return fmt::format("<g id='a{}'><use href='#a{}'/></g>", k + 1, k); }), fmt::format("<use href='#a{}'/>", n)); }, read_svg},
      {"svg: one thing used often", 1500, [](std::size_t n) { return in_defs("<g id='a'>" + kStroke + "</g>", times(n, "<use href='#a'/>")); }, read_svg},
      {"svg: much used often", 150, [](std::size_t n) { return in_defs("<g id='a'>" + times(n, kStroke) + "</g>", times(n, "<use href='#a'/>")); }, read_svg},
      {"svg: nothing used often", 500, [](std::size_t n) { return in_defs("<g id='a'>" + times(n, "<g/>") + "</g>", times(n, "<use href='#a'/>") + kStroke); }, read_svg},
      {"svg: use of what is missing", 2500, [](std::size_t n) { return page(times(n, [](std::size_t k) { return fmt::format("<use href='#x{}'/>", k); }) + kStroke); }, read_svg},
      {"svg: one id often", 2500, [](std::size_t n) { return in_defs(times(n, "<g id='a'/>"), times(n, "<use href='#a'/>") + kStroke); }, read_svg},
      {"svg: classes of one element", 1000, [](std::size_t n) { return page("<style>" + times(n, [](std::size_t k) { return fmt::format(".c{}{{stroke:#000}}", k); }) + "</style><path d='M1 1h5' class='" + times(n, [](std::size_t k) { return fmt::format("c{} ", k); }) + "'/>"); }, read_svg},
      {"svg: a class for each element", 1000, [](std::size_t n) { return page("<style>" + times(n, [](std::size_t k) { return fmt::format(".c{}{{stroke:#000}}", k); }) + "</style>" + times(n, [](std::size_t k) { return fmt::format("<path d='M1 1h5' class='c{}'/>", k); })); }, read_svg},
      {"svg: rules for all elements", 500, [](std::size_t n) { return page("<style>" + times(n, "*{stroke:#000}path{fill:none}") + "</style>" + times(n, kStroke)); }, read_svg},
      {"svg: selectors of ancestors", 150, [](std::size_t n) { return page("<style>" + times(n, "g g g path{stroke:#000}") + "</style>" + times(50, "<g>") + times(n, kStroke) + times(50, "</g>")); }, read_svg},
      {"svg: a list of selectors", 2500, [](std::size_t n) { return page("<style>" + times(n, [](std::size_t k) { return fmt::format(".c{},", k); }) + "a{stroke:#000}</style>" + times(n, "<path class='c1' d='M1 1h5'/>")); }, read_svg},
      {"svg: one property often", 5000, [](std::size_t n) { return page("<path d='M1 1h5' style='" + times(n, "stroke:#000;") + "'/>"); }, read_svg},
      {"svg: css blocks in blocks", 2500, [](std::size_t n) { return page("<style>" + times(n, "@media x{") + times(n, "}") + "</style>" + kStroke); }, read_svg},
      {"svg: css that is open", 5000, [](std::size_t n) { return page("<style>" + times(n, "a{/*") + "</style>" + kStroke); }, read_svg},
      {"svg: style sheets", 2500, [](std::size_t n) { return page(times(n, "<style>a{}</style>") + kStroke); }, read_svg},
      {"svg: a long dash array", 5000, [](std::size_t n) { return page("<path d='M1 1h50' stroke='#000' stroke-dasharray='" + times(n, "1 ") + "'/>"); }, read_svg},
      {"svg: a dash array for many", 200, [](std::size_t n) { return page("<g stroke-dasharray='" + times(n, "1 ") + "'>" + times(n, "<path d='M1 1h50' stroke='#000'/>") + "</g>"); }, read_svg},
      {"svg: fine dashes", 20, [](std::size_t n) { return page(times(n, "<path d='M1 1h90' stroke='#000' stroke-dasharray='0.01'/>")); }, read_svg},
      {"svg: a long transform", 2500, [](std::size_t n) { return page("<path transform='" + times(n, "translate(0) ") + "' d='M1 1h5' stroke='#000'/>"); }, read_svg},
      {"svg: gradients of gradients", 250, [](std::size_t n) { return in_defs(times(n, [](std::size_t k) { return fmt::format("<linearGradient id='g{}' href='#g{}'/>", k, k + 1); }), times(n, [](std::size_t k) { return fmt::format("<rect x='{}' width='9' height='9' fill='url(#g0)'/>", 10 * k); })); }, read_svg},
      {"svg: patterns of patterns", 150, [](std::size_t n) { return in_defs(times(n, [](std::size_t k) { return fmt::format("<pattern id='g{}'><rect width='9' height='9' fill='url(#g{})'/></pattern>", k, k + 1); }), times(n, [](std::size_t k) { return fmt::format("<rect x='{}' width='9' height='9' fill='url(#g0)'/>", 10 * k); })); }, read_svg},
      {"svg: a clip path of many", 100, [](std::size_t n) { return in_defs("<clipPath id='c'>" + times(n, [](std::size_t k) { return fmt::format("<circle cx='{}' cy='{}' r='9'/>", k % 90, k % 77); }) + "</clipPath>", times(n, [](std::size_t k) { return fmt::format("<path clip-path='url(#c)' d='M0 {}h100' stroke='#000'/>", k % 90); })); }, read_svg},
      {"svg: clip paths of clip paths", 100, [](std::size_t n) { return in_defs(times(n, [](std::size_t k) { return fmt::format("<clipPath id='c{}' clip-path='url(#c{})'><circle cx='50' cy='50' r='30'/></clipPath>", k, k + 1); }), "<path clip-path='url(#c0)' d='M0 50h100' stroke='#000'/>"); }, read_svg},
      {"svg: clipped in clipped", 40, [](std::size_t n) { return in_defs("<clipPath id='c'><circle cx='50' cy='50' r='30'/></clipPath>", times(n, "<g clip-path='url(#c)'>") + kStroke + times(n, "</g>")); }, read_svg},
      {"svg: used in a clip path", 150, [](std::size_t n) { return in_defs("<g id='u'>" + times(n, "<circle cx='50' cy='50' r='30'/>") + "</g><clipPath id='c'><use href='#u'/></clipPath>", times(n, "<path clip-path='url(#c)' d='M0 50h100' stroke='#000'/>")); }, read_svg},
      {"svg: frames in frames", 40, [](std::size_t n) { return page(times(n, "<svg viewBox='0 0 100 100'>") + kStroke + times(n, "</svg>")); }, read_svg},
      {"svg: symbols", 500, [](std::size_t n) { return page(times(n, [](std::size_t k) { return fmt::format("<symbol id='s{}' viewBox='0 0 9 9'>{}</symbol><use href='#s{}'/>", k, kStroke, k); })); }, read_svg},
      {"svg: a long id", 50000, [](std::size_t n) { return page("<path id='" + std::string(n, 'a') + "' d='M1 1h5' stroke='#000'/>"); }, read_svg},
      {"svg: folds of many names", 4000, [](std::size_t n) { return page("<g id='cut'>" + kStroke + "</g>" + times(n, [](std::size_t k) { return fmt::format("<g id='fold-{}'>{}</g>", k, kStroke); })); }, read_svg},
      {"svg: layers that nobody knows", 1500, [](std::size_t n) { return page("<g id='cut'>" + kStroke + "</g>" + times(n, [](std::size_t k) { return fmt::format("<g id='zork{}'>{}</g>", k, kStroke); })); }, read_svg},
      {"svg: names that nobody knows", 10000, [](std::size_t n) { return page("<g id='cut'>" + kStroke + "</g>" + times(n, [](std::size_t k) { return fmt::format("<g id='zwaan{}q'>{}</g>", k, kStroke); })); }, ask_svg},
      {"svg: words of a name", 1000, [](std::size_t n) { return page("<g id='" + times(n, "cutx-foldx ") + "'>" + times(n, [](std::size_t k) { return fmt::format("<g id='g{}'>{}</g>", k, kStroke); }) + "</g>"); }, read_svg},
      {"svg: attributes", 2500, [](std::size_t n) { return page("<path " + times(n, [](std::size_t k) { return fmt::format("a{}='1' ", k); }) + "d='M1 1h5' stroke='#000'/>"); }, read_svg},
      {"svg: one attribute often", 5000, [](std::size_t n) { return page("<path " + times(n, "d='M1 1h5' ") + "stroke='#000'/>"); }, read_svg},
      {"svg: namespaces", 1000, [](std::size_t n) { return page("<g " + times(n, [](std::size_t k) { return fmt::format("xmlns:x{}='http://x/{}' ", k, k); }) + ">" + times(n, [](std::size_t k) { return fmt::format("<x{}:path d='M1 1'/>", k); }) + kStroke + "</g>"); }, read_svg},
      {"svg: entities", 500, [](std::size_t n) { return "<!DOCTYPE svg [" + times(n, [](std::size_t k) { return fmt::format("<!ENTITY e{} 'x'>", k); }) + "]>" + page(times(n, [](std::size_t k) { return fmt::format("<g id='&e{};'/>", k); }) + kStroke); }, read_svg},
      {"svg: a long entity often", 250, [](std::size_t n) { return "<!DOCTYPE svg [<!ENTITY e '" + std::string(n, 'x') + "'>]>" + page(times(n, "<g id='&e;'/>") + kStroke); }, read_svg},
      {"svg: references of letters", 10000, [](std::size_t n) { return page("<g id='" + times(n, "&#65;") + "'/>" + kStroke); }, read_svg},
      {"svg: comments", 5000, [](std::size_t n) { return page(times(n, "<!-- x -->") + kStroke); }, read_svg},
      {"svg: texts and pictures", 2500, [](std::size_t n) { return page(kStroke + times(n, "<text>x</text><image href='x.png' width='1' height='1'/>")); }, read_svg},
      {"svg: arcs", 1500, [](std::size_t n) { return page("<path stroke='#000' d='M0 0" + times(n, "a1 1 0 1 1 0 .1") + "'/>"); }, read_svg},
      {"svg: large circles", 50, [](std::size_t n) { return page(times(n, "<circle r='50000' stroke='#000'/>")); }, read_svg},
      {"svg: curves", 500, [](std::size_t n) { return page("<path stroke='#000' d='M0 0" + times(n, "C0 100 100 100 100 0") + "'/>"); }, read_svg},
      {"svg: subpaths", 5000, [](std::size_t n) { return page("<path stroke='#000' d='" + times(n, "M0 0h1") + "'/>"); }, read_svg},
      {"svg: a fill of many parts", 1000, [](std::size_t n) { return page("<path d='" + times(n, [](std::size_t k) { return fmt::format("M{} {}h1v1z", k % 97, k % 89); }) + "'/>"); }, read_svg},
      {"svg: fills over each other", 50, [](std::size_t n) { return page(times(n, [](std::size_t k) { return fmt::format("<circle cx='{}' cy='50' r='40'/>", 50 + 0.001 * static_cast<double>(k)); })); }, read_svg},
      {"svg: white on black", 500, [](std::size_t n) { return page("<rect x='1' width='98' height='100'/>" + times(n, [](std::size_t k) { return fmt::format("<rect x='{}' y='{}' width='.5' height='.5' fill='#fff'/>", k % 97, k % 89); })); }, read_svg},
      {"svg: a long number", 50000, [](std::size_t n) { return page("<path stroke='#000' d='M0 0h1." + std::string(n, '1') + "'/>"); }, read_svg},
      {"svg: colours", 1500, [](std::size_t n) { return page(times(n, [](std::size_t k) { return fmt::format("<path d='M1 1h5' stroke='#{:06x}'/>", k); })); }, read_svg},
      {"svg: tags that are open", 10000, [](std::size_t n) { return page(kStroke) + times(n, "<g>"); }, read_svg},
      {"svgz: much of nothing", 20, [](std::size_t n) { return gzip_of(page(kStroke + std::string(10000 * n, ' '))); }, read_svg},
      {"svgz: members", 500, [](std::size_t n) { return times(n, gzip_of(" ")); }, read_svg},
  };
  check_growth(svg);
  const std::vector<DearFile> others{
      {"dxf: blocks in blocks", 20, [](std::size_t n) { return dxf_of(insert("a0"), nested_blocks(n, 1, line_on("0"))); }, read_dxf},
      {"dxf: ten of ten of ten", 3, [](std::size_t n) { return dxf_of(insert("a0"), nested_blocks(n, 10, line_on("0"))); }, read_dxf},
      {"dxf: ten of ten of nothing", 3, [](std::size_t n) { return dxf_of(insert("a0") + line_on("0"), nested_blocks(n, 10, "")); }, read_dxf},
      {"dxf: an array of blocks", 100, [](std::size_t n) { return dxf_of(insert("a", grid_of(n)), block("a", line_on("0"))); }, read_dxf},
      {"dxf: arrays of nothing", 30, [](std::size_t n) { return dxf_of(times(n, insert("a", grid_of(n))) + line_on("0"), block("a", "")); }, read_dxf},
      {"dxf: arrays of what is not read", 50, [](std::size_t n) { return dxf_of(times(n, insert("a", grid_of(n))) + line_on("0"), block("a", "0\nPOINT\n8\n0\n10\n0\n20\n0\n")); }, read_dxf},
      {"dxf: blocks that are missing", 1500, [](std::size_t n) { return dxf_of(times(n, [](std::size_t k) { return insert(fmt::format("x{}", k)); }) + line_on("0")); }, read_dxf},
      {"dxf: blocks", 500, [](std::size_t n) { return dxf_of(times(n, [](std::size_t k) { return insert(fmt::format("b{}", k)); }), times(n, [](std::size_t k) { return block(fmt::format("b{}", k), line_on("0")); })); }, read_dxf},
      {"dxf: bulges", 1500, [](std::size_t n) { return dxf_of("0\nLWPOLYLINE\n8\n0\n70\n0\n" + times(n, [](std::size_t k) { return fmt::format("10\n{}\n20\n0\n42\n1000000\n", k % 2); })); }, read_dxf},
      {"dxf: a spline of high degree", 50, [](std::size_t n) { return dxf_of(fmt::format("0\nSPLINE\n8\n0\n70\n8\n71\n{}\n72\n{}\n73\n{}\n", n, 2 * n + 2, n + 1) + times(n + 1, "40\n0\n") + times(n + 1, "40\n1\n") + times(n + 1, [](std::size_t k) { return fmt::format("10\n{}\n20\n{}\n", k % 90, k % 77); })); }, read_dxf},
      {"dxf: a long spline", 500, [](std::size_t n) { return dxf_of(fmt::format("0\nSPLINE\n8\n0\n70\n8\n71\n3\n72\n{}\n73\n{}\n", n + 4, n) + times(n + 4, [](std::size_t k) { return fmt::format("40\n{}\n", k); }) + times(n, [](std::size_t k) { return fmt::format("10\n{}\n20\n{}\n", k % 90, k % 77); })); }, read_dxf},
      {"dxf: layers", 1000, [](std::size_t n) { return dxf_of(times(n, [](std::size_t k) { return line_on(fmt::format("zork{}", k)); }), "", "0\nTABLE\n2\nLAYER\n" + times(n, [](std::size_t k) { return fmt::format("0\nLAYER\n2\nzork{}\n70\n0\n62\n7\n", k); }) + "0\nENDTAB\n"); }, read_dxf},
      {"dxf: a long line type for many", 250, [](std::size_t n) { return dxf_of(times(n, line_on("0\n6\nL")), "", fmt::format("0\nTABLE\n2\nLTYPE\n0\nLTYPE\n2\nL\n70\n0\n73\n{}\n40\n2\n", n) + times(n, "49\n1\n49\n-1\n") + "0\nENDTAB\n"); }, read_dxf},
      {"dxf: ellipses", 150, [](std::size_t n) { return dxf_of(times(n, "0\nELLIPSE\n8\n0\n10\n0\n20\n0\n11\n90\n21\n0\n40\n0.001\n41\n0\n42\n6.28\n")); }, read_dxf},
      {"dxf: large circles", 100, [](std::size_t n) { return dxf_of(times(n, "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n9000\n")); }, read_dxf},
      {"dxf: one group often", 10000, [](std::size_t n) { return dxf_of("0\nLINE\n8\n0\n" + times(n, "10\n0\n") + "20\n0\n11\n9\n21\n1\n"); }, read_dxf},
      {"dxf: a long text", 100000, [](std::size_t n) { return dxf_of("0\nTEXT\n8\n0\n1\n" + std::string(n, 'x') + "\n" + line_on("0")); }, read_dxf},
      {"fold: one edge often", 2500, [](std::size_t n) { return fold_of("[0, 0], ", times(n, "[0, 1], ")); }, read_fold},
      {"fold: edges of one vertex", 500, [](std::size_t n) { return fold_of(times(n, [](std::size_t k) { return fmt::format("[{}, {}], ", k % 100, k / 100); }), times(n, [](std::size_t k) { return fmt::format("[0, {}], ", k + 1); })); }, read_fold},
      {"fold: vertices in one place", 2500, [](std::size_t n) { return fold_of(times(n, "[1, 1], "), times(n, [](std::size_t k) { return fmt::format("[{}, {}], ", k, k + 1); })); }, read_fold},
      {"fold: edges on one line", 250, [](std::size_t n) { return fold_of(times(n, [&](std::size_t k) { return fmt::format("[{}, 0], ", 80.0 * static_cast<double>(k) / static_cast<double>(n)); }), times(n, [n](std::size_t k) { return fmt::format("[{}, {}], ", k, (k + n / 2) % n); })); }, read_fold},
      {"fold: frames that inherit", 500, [](std::size_t n) { return fold_of("", times(n, "[0, 1], "), R"(, "file_frames": [)" + times(n, [](std::size_t k) { return fmt::format(R"({{"frame_parent": {}, "frame_inherit": true}}, )", k); }) + "{}]"); }, read_fold},
      {"fold: a large face", 5000, [](std::size_t n) { return fold_of("", "", R"(, "faces_vertices": [[)" + times(n, "0, 1, ") + "0]]"); }, read_fold},
      {"fold: brackets", 10000, [](std::size_t n) { return R"({"file_spec": 1, "vertices_coords": )" + std::string(n, '['); }, read_fold},
      {"fold: one key often", 2500, [](std::size_t n) { return fold_of("", "", times(n, R"(, "edges_foldAngle": [0])")); }, read_fold},
      {"cp: one line often", 2500, [](std::size_t n) { return times(n, "1 0 0 9 9\n"); }, read_creases},
      {"opx: one line often", 250, [](std::size_t n) { return R"(<?xml version="1.0"?><java><object class="oripa.DataSet"><void property="lines"><array>)" + times(n, R"(<void index="0"><object class="oripa.OriLineProxy"><void property="type"><int>1</int></void><void property="x0"><double>1</double></void><void property="x1"><double>2</double></void><void property="y0"><double>3</double></void><void property="y1"><double>4</double></void></object></void>)") + "</array></void></object></java>"; }, read_creases},
      {"spec: brackets", 10000, [](std::size_t n) { return R"({"popcut": 1, "widths_mm": )" + std::string(n, '['); }, read_spec},
      {"spec: widths", 10000, [](std::size_t n) { return R"({"popcut": 1, "widths_mm": [)" + times(n, "1, ") + "1]}"; }, read_spec},
      {"spec: names that nobody knows", 1000, [](std::size_t n) { return R"({"popcut": 1)" + times(n, [](std::size_t k) { return fmt::format(R"(, "width_m{}": 1)", k); }) + "}"; }, read_spec},
      {"spec: a long formula", 10000, [](std::size_t n) { return R"({"popcut": 1, "surface": {"type": "revolution", "radius": ")" + times(n, "(1+") + R"("}})"; }, read_spec},
      {"csv: panels", 1500, [](std::size_t n) { return "slice,panel,x0,z0,x1,z1,v,width\n" + times(n, "1,1,0,0,1,0,0,1\n"); }, [](const std::string& text) { (void)read_segments_csv(text, SegmentConvention::Popcut); }},
      {"csv: heights", 100, [](std::size_t n) { return times(n, times(n, "1,") + "1\n"); }, [](const std::string& text) { (void)read_height_grid("a.csv", text); }},
      {"csv: a long line", 10000, [](std::size_t n) { return times(n, "1,") + "1\n1,1\n"; }, [](const std::string& text) { (void)read_height_grid("a.csv", text); }},
  };
  // clang-format on
  check_growth(others);
}

}  // namespace readers_test
