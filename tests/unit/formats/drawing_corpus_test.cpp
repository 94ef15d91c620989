// SPDX-License-Identifier: MIT
// A hundred drawings written for this test, one feature each. What each holds is worked out by hand
// from the rules of SVG 1.1 and 2, DXF and FOLD: total length of cuts (with outlines), of mountain
// and valley folds, and the box around all lines, in mm.
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/svg_drafts.hpp"

namespace drawing_corpus_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

constexpr double kPi = std::numbers::pi;

struct Row {
  const char* name;
  std::string drawing;
  double cut_mm{}, mountain_mm{}, valley_mm{};
  std::array<double, 4> box{};  ///< left, top, right, bottom
};

void check(const Row& row, const LineWork& work) {
  INFO(row.name << ": " << row.drawing);
  const double cut = total_mm(work, Operation::Cut) + total_mm(work, Operation::Outline);
  CHECK(cut == Approx(row.cut_mm).margin(0.06));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(row.mountain_mm).margin(0.06));
  CHECK(total_mm(work, Operation::FoldValley) == Approx(row.valley_mm).margin(0.06));
  const Box box = bounds(work);
  CHECK(box.x0 == Approx(row.box[0]).margin(0.03));
  CHECK(box.y0 == Approx(row.box[1]).margin(0.03));
  CHECK(box.x1 == Approx(row.box[2]).margin(0.03));
  CHECK(box.y1 == Approx(row.box[3]).margin(0.03));
}

/// A body on the usual page, all of its shapes stroked and not filled.
std::string on_page(const std::string& body) {
  return svg("<g fill='none' stroke='#000'>" + body + "</g>");
}
std::string path(const std::string& d) { return on_page("<path d='" + d + "'/>"); }
std::string named(const std::string& attributes) {
  return svg("<g fill='none' stroke='#000'><path " + attributes + " d='M10 10H30'/></g>");
}
std::string page(const std::string& head) {
  return svg("<path fill='none' stroke='#000' d='M10 10H30V20'/>", head);
}

std::vector<Row> svg_rows() {
  const double rounded = 60 - 16 + 4 * kPi;
  return {
      // Shapes.
      {"line", on_page("<line x1='10' y1='10' x2='40' y2='50'/>"), 50, 0, 0, {10, 10, 40, 50}},
      {"line at its default ends", on_page("<line x2='30' y2='40'/>"), 50, 0, 0, {0, 0, 30, 40}},
      {"polyline", on_page("<polyline points='0,0 3,4 3,9'/>"), 10, 0, 0, {0, 0, 3, 9}},
      {"polygon closes", on_page("<polygon points='0 0 30 0 30 40'/>"), 120, 0, 0, {0, 0, 30, 40}},
      {"rect", on_page("<rect x='5' y='6' width='20' height='10'/>"), 60, 0, 0, {5, 6, 25, 16}},
      {"rect with rx",
       on_page("<rect width='20' height='10' rx='2'/>"),
       rounded,
       0,
       0,
       {0, 0, 20, 10}},
      {"rect with ry",
       on_page("<rect width='20' height='10' ry='2'/>"),
       rounded,
       0,
       0,
       {0, 0, 20, 10}},
      {"rect with rx too large",
       on_page("<rect width='20' height='20' rx='90'/>"),
       20 * kPi,
       0,
       0,
       {0, 0, 20, 20}},
      {"circle", on_page("<circle cx='50' cy='40' r='10'/>"), 20 * kPi, 0, 0, {40, 30, 60, 50}},
      {"ellipse",
       on_page("<ellipse cx='50' cy='40' rx='10' ry='5'/>"),
       48.442,
       0,
       0,
       {40, 35, 60, 45}},
      {"rect of no width is nothing",
       on_page("<rect width='0' height='9'/><line x2='5'/>"),
       5,
       0,
       0,
       {0, 0, 5, 0}},
      {"circle in percent",
       on_page("<circle cx='50%' cy='50%' r='10%'/>"),
       20 * kPi,
       0,
       0,
       {40, 40, 60, 60}},
      // Paths.
      {"M L Z", path("M0 0 L30 0 L30 40 Z"), 120, 0, 0, {0, 0, 30, 40}},
      {"H and V", path("M10 10H30V20"), 30, 0, 0, {10, 10, 30, 20}},
      {"small letters",
       path("m10 10l20 0l0 10z"),
       20 + 10 + std::sqrt(500),
       0,
       0,
       {10, 10, 30, 20}},
      {"further pairs after m are lines", path("m10 10 20 0 0 10"), 30, 0, 0, {10, 10, 30, 20}},
      {"h and v", path("m10 10h20v10h-5"), 35, 0, 0, {10, 10, 30, 20}},
      {"cubic that is straight", path("M0 0C10 0 20 0 30 0"), 30, 0, 0, {0, 0, 30, 0}},
      {"cubic quarter circle",
       path("M20 0C20 11.0457 11.0457 20 0 20"),
       10 * kPi,
       0,
       0,
       {0, 0, 20, 20}},
      {"small cubic", path("M20 0c0 11.0457 -8.9543 20 -20 20"), 10 * kPi, 0, 0, {0, 0, 20, 20}},
      {"S mirrors the handle",
       path("M0 0C0 10 20 10 20 0S40 -10 40 0"),
       2 * 27.8931,
       0,
       0,
       {0, -7.5, 40, 7.5}},
      {"quadratic", path("M0 0Q10 20 20 0"), 29.5789, 0, 0, {0, 0, 20, 10}},
      {"T mirrors the handle", path("M0 0Q10 20 20 0T40 0"), 2 * 29.5789, 0, 0, {0, -10, 40, 10}},
      {"arc half", path("M10 20A10 10 0 0 1 30 20"), 10 * kPi, 0, 0, {10, 10, 30, 20}},
      {"arc half the other way",
       path("M10 20A10 10 0 0 0 30 20"),
       10 * kPi,
       0,
       0,
       {10, 20, 30, 30}},
      {"arc large", path("M20 10A10 10 0 1 1 10 20"), 15 * kPi, 0, 0, {10, 10, 30, 30}},
      {"arc too small grows", path("M10 20A1 1 0 0 1 30 20"), 10 * kPi, 0, 0, {10, 10, 30, 20}},
      {"arc of no radius is a line", path("M10 20A0 5 0 0 1 30 20"), 20, 0, 0, {10, 20, 30, 20}},
      {"arc flags without blanks", path("M10 20a10 10 0 0120 0"), 10 * kPi, 0, 0, {10, 10, 30, 20}},
      {"numbers without blanks",
       path("M10-10.5.5-5"),
       std::hypot(9.5, 5.5),
       0,
       0,
       {0.5, -10.5, 10, -5}},
      {"exponents", path("M1e1 10L3E1 10"), 20, 0, 0, {10, 10, 30, 10}},
      {"two parts", path("M0 0H10M0 5H20"), 30, 0, 0, {0, 0, 20, 5}},
      {"a part after z begins at its start",
       path("M10 10h10v10zl-5 0"),
       20 + std::sqrt(200) + 5,
       0,
       0,
       {5, 10, 20, 20}},
      // Transforms.
      {"translate",
       on_page("<path transform='translate(5,6)' d='M0 0H20'/>"),
       20,
       0,
       0,
       {5, 6, 25, 6}},
      {"translate by one",
       on_page("<path transform='translate(5)' d='M0 0H20'/>"),
       20,
       0,
       0,
       {5, 0, 25, 0}},
      {"scale", on_page("<path transform='scale(2,3)' d='M1 1H11V6'/>"), 35, 0, 0, {2, 3, 22, 18}},
      {"rotate",
       on_page("<path transform='rotate(90)' d='M10 -20H30'/>"),
       20,
       0,
       0,
       {20, 10, 20, 30}},
      {"rotate about",
       on_page("<path transform='rotate(180 20 20)' d='M10 10H30'/>"),
       20,
       0,
       0,
       {10, 30, 30, 30}},
      {"skewX",
       on_page("<path transform='skewX(45)' d='M0 0V10'/>"),
       std::sqrt(200),
       0,
       0,
       {0, 0, 10, 10}},
      {"skewY",
       on_page("<path transform='skewY(45)' d='M0 0H10'/>"),
       std::sqrt(200),
       0,
       0,
       {0, 0, 10, 10}},
      {"matrix",
       on_page("<path transform='matrix(0 1 -1 0 30 0)' d='M0 0H20'/>"),
       20,
       0,
       0,
       {30, 0, 30, 20}},
      {"a list, the last first",
       on_page("<path transform='translate(10) scale(2)' d='M0 0H10'/>"),
       20,
       0,
       0,
       {10, 0, 30, 0}},
      {"groups multiply",
       on_page("<g transform='scale(2)'><g transform='translate(3 4)'><path d='M0 0H5'/></g></g>"),
       10,
       0,
       0,
       {6, 8, 16, 8}},
      {"transform-origin",
       on_page("<path style='transform-origin:20px 10px' transform='rotate(90)' d='M10 10H30'/>"),
       20,
       0,
       0,
       {20, 0, 20, 20}},
      {"transform-origin as attribute",
       on_page("<path transform-origin='10 10' transform='scale(2)' d='M10 10H30'/>"),
       40,
       0,
       0,
       {10, 10, 50, 10}},
      // Pages.
      {"viewBox twice as large",
       page("width='200mm' height='200mm' viewBox='0 0 100 100'"),
       60,
       0,
       0,
       {20, 20, 60, 40}},
      {"viewBox with an origin",
       page("width='100mm' height='100mm' viewBox='5 5 100 100'"),
       30,
       0,
       0,
       {5, 5, 25, 15}},
      {"cm", page("width='10cm' height='10cm' viewBox='0 0 100 100'"), 30, 0, 0, {10, 10, 30, 20}},
      {"in",
       page("width='1in' height='1in' viewBox='0 0 50 50'"),
       30 * 0.508,
       0,
       0,
       {5.08, 5.08, 15.24, 10.16}},
      {"pt",
       page("width='72pt' height='72pt' viewBox='0 0 100 100'"),
       30 * 0.254,
       0,
       0,
       {2.54, 2.54, 7.62, 5.08}},
      {"meet centres",
       page("width='200mm' height='100mm' viewBox='0 0 100 100'"),
       30,
       0,
       0,
       {60, 10, 80, 20}},
      {"xMinYMin",
       page("width='200mm' height='100mm' viewBox='0 0 100 100' preserveAspectRatio='xMinYMin'"),
       30,
       0,
       0,
       {10, 10, 30, 20}},
      {"slice",
       page("width='200mm' height='100mm' viewBox='0 0 100 100' preserveAspectRatio='xMinYMin "
            "slice'"),
       60,
       0,
       0,
       {20, 20, 60, 40}},
      {"none stretches",
       page("width='200mm' height='100mm' viewBox='0 0 100 100' preserveAspectRatio='none'"),
       50,
       0,
       0,
       {20, 10, 60, 20}},
      {"nested svg",
       svg("<svg x='10' y='10' width='50' height='50' viewBox='0 0 100 100'><path fill='none' "
           "stroke='#000' d='M0 0H40'/></svg>"),
       20,
       0,
       0,
       {10, 10, 30, 10}},
      // References, styles, what is not drawn.
      {"use",
       on_page("<defs><path id='a' d='M0 0H20'/></defs><use href='#a' x='5' y='6'/>"),
       20,
       0,
       0,
       {5, 6, 25, 6}},
      {"use twice",
       on_page("<path id='a' d='M0 0H20'/><use xlink:href='#a' y='6'/>"),
       40,
       0,
       0,
       {0, 0, 20, 6}},
      {"symbol",
       on_page("<symbol id='s' viewBox='0 0 10 10'><path d='M0 0H10'/></symbol><use href='#s' "
               "x='10' y='10' width='50' height='50'/>"),
       50,
       0,
       0,
       {10, 10, 60, 10}},
      {"defs are not drawn",
       on_page("<defs><path d='M0 0H90'/></defs><path d='M0 0H20'/>"),
       20,
       0,
       0,
       {0, 0, 20, 0}},
      {"display none",
       on_page("<path style='display:none' d='M0 0H90'/><path d='M0 0H20'/>"),
       20,
       0,
       0,
       {0, 0, 20, 0}},
      {"visibility hidden",
       on_page("<path visibility='hidden' d='M0 0H90'/><path d='M0 0H20'/>"),
       20,
       0,
       0,
       {0, 0, 20, 0}},
      {"style sheet",
       svg("<style>.x{stroke:#000;fill:none}</style><path class='x' d='M0 0H20'/>"),
       20,
       0,
       0,
       {0, 0, 20, 0}},
      {"style wins over attribute",
       on_page("<path stroke='#000' style='stroke:none' d='M0 0H90'/><path d='M0 0H20'/>"),
       20,
       0,
       0,
       {0, 0, 20, 0}},
      {"prefixed elements",
       "<s:svg xmlns:s='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 "
       "100'><s:path fill='none' stroke='#000' d='M0 0H20'/></s:svg>",
       20,
       0,
       0,
       {0, 0, 20, 0}},
      {"elements of another namespace",
       svg("<x:path xmlns:x='urn:other' d='M0 0H90' stroke='#000'/><path fill='none' stroke='#000' "
           "d='M0 0H20'/>"),
       20,
       0,
       0,
       {0, 0, 20, 0}},
      // Dashes.
      {"dashes", on_page("<path stroke-dasharray='4 2' d='M0 0H18'/>"), 12, 0, 0, {0, 0, 16, 0}},
      {"odd dashes repeat",
       on_page("<path stroke-dasharray='3' d='M0 0H18'/>"),
       9,
       0,
       0,
       {0, 0, 15, 0}},
      {"dash offset",
       on_page("<path stroke-dasharray='4 2' stroke-dashoffset='4' d='M0 0H18'/>"),
       12,
       0,
       0,
       {2, 0, 18, 0}},
      {"pathLength scales dashes",
       on_page("<path pathLength='9' stroke-dasharray='2 1' d='M0 0H18'/>"),
       12,
       0,
       0,
       {0, 0, 16, 0}},
      // Clips.
      {"clip by a rect",
       on_page("<clipPath id='c'><rect width='10' height='100'/></clipPath><path "
               "clip-path='url(#c)' d='M0 5H30'/>"),
       10,
       0,
       0,
       {0, 5, 10, 5}},
      {"clip of a group",
       on_page("<clipPath id='c'><rect x='5' width='10' height='100'/></clipPath><g "
               "clip-path='url(#c)'><path d='M0 5H30M0 9H30'/></g>"),
       20,
       0,
       0,
       {5, 5, 15, 9}},
      {"clip by a circle",
       on_page("<clipPath id='c'><circle cx='50' cy='50' r='10'/></clipPath><path "
               "clip-path='url(#c)' d='M0 50H100'/>"),
       20,
       0,
       0,
       {40, 50, 60, 50}},
      {"clip in the box of its element",
       on_page("<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='0.5' "
               "height='1'/></clipPath><path clip-path='url(#c)' d='M10 10H30V20'/>"),
       10,
       0,
       0,
       {10, 10, 20, 10}},
      // Meanings.
      {"data-assignment M", named("data-assignment='M'"), 0, 20, 0, {10, 10, 30, 10}},
      {"data-assignment V", named("data-assignment='V'"), 0, 0, 20, {10, 10, 30, 10}},
      {"layer of Inkscape",
       svg("<g inkscape:groupmode='layer' inkscape:label='Mountain'><path fill='none' "
           "stroke='#000' d='M10 10H30'/></g>"),
       0,
       20,
       0,
       {10, 10, 30, 10}},
      {"layer of Inkscape, valley",
       svg("<g inkscape:groupmode='layer' inkscape:label='valley folds'><path fill='none' "
           "stroke='#000' d='M10 10H30'/></g>"),
       0,
       0,
       20,
       {10, 10, 30, 10}},
      {"layer of Illustrator",
       svg("<!-- Generator: Adobe Illustrator 27.0 --><g id='Mountain'><path fill='none' "
           "stroke='#000' d='M10 10H30'/></g><g id='Cut'><path fill='none' stroke='#000' d='M10 "
           "20H30'/></g>"),
       20,
       20,
       0,
       {10, 10, 30, 20}},
      {"named dashes stay whole",
       svg("<g inkscape:groupmode='layer' inkscape:label='Valley'><path fill='none' stroke='#000' "
           "stroke-dasharray='1 1' d='M10 10H30'/></g>"),
       0,
       0,
       20,
       {10, 10, 30, 10}},
  };
}

/// "0 LINE 8 CUT ..." to groups: codes and values by turns.
std::string groups(const std::string& words) {
  std::istringstream in(words);
  std::string out, word;
  while (in >> word) out += word + "\n";
  return out;
}
std::string dxf(const std::string& entities, const std::string& before = "9 $INSUNITS 70 4",
                const std::string& more = "") {
  return groups("0 SECTION 2 HEADER " + before + " 0 ENDSEC " + more + " 0 SECTION 2 ENTITIES " +
                entities + " 0 ENDSEC 0 EOF");
}
const std::string kBlock =
    "0 SECTION 2 BLOCKS 0 BLOCK 2 B 70 0 10 0 20 0 0 LINE 8 CUT 10 0 20 0 11 10 21 0 0 ENDBLK 0 "
    "ENDSEC";

std::vector<Row> dxf_rows() {
  const std::string line = "0 LINE 8 CUT 10 0 20 0 11 30 21 40";
  return {
      {"LINE", dxf(line), 50, 0, 0, {0, -40, 30, 0}},
      {"inches", dxf(line, "9 $INSUNITS 70 1"), 1270, 0, 0, {0, -1016, 762, 0}},
      {"cm", dxf(line, "9 $INSUNITS 70 5"), 500, 0, 0, {0, -400, 300, 0}},
      {"CIRCLE", dxf("0 CIRCLE 8 CUT 10 20 20 20 40 10"), 20 * kPi, 0, 0, {10, -30, 30, -10}},
      {"ARC", dxf("0 ARC 8 CUT 10 0 20 0 40 10 50 0 51 90"), 5 * kPi, 0, 0, {0, -10, 10, 0}},
      {"ARC over zero",
       dxf("0 ARC 8 CUT 10 0 20 0 40 10 50 270 51 90"),
       10 * kPi,
       0,
       0,
       {0, -10, 10, 10}},
      {"LWPOLYLINE closed",
       dxf("0 LWPOLYLINE 8 CUT 90 3 70 1 10 0 20 0 10 30 20 0 10 30 20 40"),
       120,
       0,
       0,
       {0, -40, 30, 0}},
      {"bulge of a half circle",
       dxf("0 LWPOLYLINE 8 CUT 90 2 70 0 10 0 20 0 42 1 10 20 20 0"),
       10 * kPi,
       0,
       0,
       {0, 0, 20, 10}},
      {"bulge the other way",
       dxf("0 LWPOLYLINE 8 CUT 90 2 70 0 10 0 20 0 42 -1 10 20 20 0"),
       10 * kPi,
       0,
       0,
       {0, -10, 20, 0}},
      {"POLYLINE",
       dxf("0 POLYLINE 8 CUT 66 1 70 0 0 VERTEX 8 CUT 10 0 20 0 0 VERTEX 8 CUT 10 3 20 4 0 SEQEND"),
       5,
       0,
       0,
       {0, -4, 3, 0}},
      {"ELLIPSE",
       dxf("0 ELLIPSE 8 CUT 10 0 20 0 11 10 21 0 40 0.5 41 0 42 6.283185307"),
       48.442,
       0,
       0,
       {-10, -5, 10, 5}},
      {"layer MOUNTAIN", dxf("0 LINE 8 MOUNTAIN 10 0 20 0 11 30 21 40"), 0, 50, 0, {0, -40, 30, 0}},
      {"layer of valleys", dxf("0 LINE 8 fold_v 10 0 20 0 11 30 21 40"), 0, 0, 50, {0, -40, 30, 0}},
      {"INSERT scaled",
       dxf("0 INSERT 8 CUT 2 B 10 5 20 0 41 2 42 2", "9 $INSUNITS 70 4", kBlock),
       20,
       0,
       0,
       {5, 0, 25, 0}},
      {"INSERT turned",
       dxf("0 INSERT 8 CUT 2 B 10 0 20 0 50 90", "9 $INSUNITS 70 4", kBlock),
       10,
       0,
       0,
       {0, -10, 0, 0}},
      {"INSERT in rows",
       dxf("0 INSERT 8 CUT 2 B 10 0 20 0 70 2 71 3 44 20 45 5", "9 $INSUNITS 70 4", kBlock),
       60,
       0,
       0,
       {0, -10, 30, 0}},
      {"mirrored by its extrusion",
       dxf("0 CIRCLE 8 CUT 10 20 20 20 40 10 210 0 220 0 230 -1"),
       20 * kPi,
       0,
       0,
       {-30, -30, -10, -10}},
  };
}

std::vector<Row> fold_rows() {
  const std::string square =
      R"("vertices_coords":[[0,0],[20,0],[20,10],[0,10]],"edges_vertices":[[0,1],[1,2],[2,3],[3,0],[0,2]])";
  const double diagonal = std::sqrt(500);
  const auto fold = [&](const std::string& more) {
    return "{\"file_spec\":1.1," + square + more + "}";
  };
  // Page x is the pattern's y, page y its x.
  return {
      {"M",
       fold(R"(,"frame_unit":"mm","edges_assignment":["B","B","B","B","M"])"),
       60,
       diagonal,
       0,
       {0, 0, 10, 20}},
      {"v, small",
       fold(R"(,"frame_unit":"mm","edges_assignment":["b","b","b","b","v"])"),
       60,
       0,
       diagonal,
       {0, 0, 10, 20}},
      {"C",
       fold(R"(,"frame_unit":"mm","edges_assignment":["B","B","B","B","C"])"),
       60 + diagonal,
       0,
       0,
       {0, 0, 10, 20}},
      {"F is not cut",
       fold(R"(,"frame_unit":"mm","edges_assignment":["B","B","B","B","F"])"),
       60,
       0,
       0,
       {0, 0, 10, 20}},
      {"by angle",
       fold(
           R"(,"frame_unit":"mm","edges_assignment":["B","B","B","B","U"],"edges_foldAngle":[0,0,0,0,-90])"),
       60,
       diagonal,
       0,
       {0, 0, 10, 20}},
      {"cm",
       fold(R"(,"frame_unit":"cm","edges_assignment":["B","B","B","B","V"])"),
       600,
       0,
       10 * diagonal,
       {0, 0, 100, 200}},
      {"in a later frame",
       R"({"file_spec":1.1,"frame_classes":["foldedForm"],"vertices_coords":[[0,0,0],[1,0,1],[1,1,0]],"edges_vertices":[[0,1],[1,2]],"file_frames":[{"frame_unit":"mm",)" +
           square + R"(,"edges_assignment":["B","B","B","B","V"]}]})",
       60,
       0,
       diagonal,
       {0, 0, 10, 20}},
      {"faces alone",
       R"({"frame_unit":"mm","vertices_coords":[[0,0],[20,0],[20,10],[0,10]],"faces_vertices":[[0,1,2,3]]})",
       60,
       0,
       0,
       {0, 0, 10, 20}},
  };
}

}  // namespace

TEST_CASE("the corpus of drawings holds what was worked out by hand", "[core][formats][corpus]") {
  std::size_t drawings = 0;
  for (const Row& row : svg_rows()) check(row, read(row.drawing)), ++drawings;
  for (const Row& row : dxf_rows()) {
    const auto work = linework_from_dxf(row.drawing);
    INFO(row.name << ": " << (work ? "" : message(work.error())));
    REQUIRE(work);
    check(row, *work);
    ++drawings;
  }
  for (const Row& row : fold_rows()) {
    const auto work = linework_from_fold(row.drawing);
    INFO(row.name << ": " << (work ? "" : message(work.error())));
    REQUIRE(work);
    check(row, *work);
    ++drawings;
  }
  CHECK(drawings >= 100);
  std::printf("%zu drawings read as worked out by hand\n", drawings);
}

}  // namespace drawing_corpus_test
