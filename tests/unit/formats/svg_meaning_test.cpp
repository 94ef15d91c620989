// SPDX-License-Identifier: MIT
// What lines of drawings mean, and what is refused or named instead of read.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/syntax/svg_colour.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/svg_drafts.hpp"

namespace svg_meaning_test {

using namespace popcut;
using namespace popcut::testing;

TEST_CASE("units are those of CSS at 96 to the inch", "[core][formats][svg]") {
  const auto mm = [](const std::string& length, double dpi) {
    SvgReadOptions how;
    how.profile = *find_stroke_profile("popcut");
    how.dpi = dpi;
    const auto work = linework_from_svg(
        svg("<line stroke='red' x2='" + length + "'/>", "width='200mm' height='100mm'"), how);
    REQUIRE(work);
    return popcut::length(work->points);
  };
  CHECK(mm("96", 96) == Approx(25.4));
  CHECK(mm("96px", 96) == Approx(25.4));
  CHECK(mm("72pt", 96) == Approx(25.4));
  CHECK(mm("6pc", 96) == Approx(25.4));
  CHECK(mm("1in", 96) == Approx(25.4));
  CHECK(mm("2.54cm", 96) == Approx(25.4));
  CHECK(mm("25.4mm", 96) == Approx(25.4));
  CHECK(mm("25.4MM", 96) == Approx(25.4));
  CHECK(mm("10%", 96) == Approx(20));
  CHECK(mm("6em", 96) == Approx(25.4));
  CHECK(mm("72", 72) == Approx(25.4));
  CHECK(mm("25.4mm", 72) == Approx(25.4));
}

TEST_CASE("a filled drawing that its page was cropped to is no background",
          "[core][formats][svg]") {
  const auto cut_mm = [](const std::string& shape) {
    SvgReadOptions how;
    how.profile = *find_stroke_profile("popcut");
    const auto work =
        linework_from_svg(svg(shape, "width='100mm' height='80mm' viewBox='0 0 100 80'"), how);
    REQUIRE(work);
    return total_mm(*work, Operation::Cut);
  };
  CHECK(cut_mm("<path d='M50 0L100 80H0Z'/>") == Approx(100 + 2 * std::hypot(50, 80)));
  CHECK(cut_mm("<path d='M0 0H100V80H0ZM20 20H40V30H20Z'/>") == Approx(360 + 60));
  CHECK(cut_mm("<path d='M0 0H100V80H0Z'/>") == 0);
  CHECK(cut_mm("<path d='M-5 -5H105V85H-5Z'/>") == 0);
}

TEST_CASE("what is filled and not stroked is cut along its outline", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<rect width="100%" height="100%" fill="#eee"/>
      <path id="f" d="M0 0H10V10"/><path d="M0 0H10V10" fill="white"/><path d="M0 0H10" />
      <path d="M0 0H10V10" fill="none"/>)x"));
  CHECK(total_mm(work, Operation::Cut) == Approx(20 + std::sqrt(200.0)));  // closed
  CHECK(is_told(
      work, "1 shape has a fill but no stroke and is cut along its outline; at line 2 (id \"f\")"));
  CHECK(is_told(work, "2 shapes filled white or as large as the page count as background"));
  CHECK(is_told(work, "2 shapes have neither stroke nor fill"));
  // Where lines have names, what has none is no cut; named fills are what they are called.
  const LineWork named = read(svg(R"x(<path d="M0 0H10V10"/><path d="M0 0H7" stroke="red"/>
      <g inkscape:groupmode="layer" inkscape:label="Outline"><path d="M0 0H3V4Z"/></g>)x"));
  CHECK(total_mm(named, Operation::Cut) == Approx(7));
  CHECK(total_mm(named, Operation::Outline) == Approx(12));
  CHECK(is_told(named, "1 shape with a fill but no stroke and no name is left out"));
  CHECK(read(svg("<path d='M0 0H10V10'/>"), "lightburn").lines.empty());
}

TEST_CASE("without names a solid stroke is a cut and a dashed one is cut as dashes",
          "[core][formats][svg][profile]") {
  const std::string text =
      svg(R"x(<g fill="none"><path d="M0 0H6" stroke="red"/><path d="M0 1H6" stroke="#00f"/>
      <path d="M0 2H6" stroke="yellow" stroke-dasharray="2 1"/><path d="M0 3H6" stroke="white"/></g>)x");
  for (const char* profile : {"popcut", "plain", "cricut"}) {
    CAPTURE(profile);
    const LineWork work = read(text, profile);
    CHECK(work.lines.size() == 5);
    CHECK(total_mm(work, Operation::Cut) == Approx(6 + 6 + 4 + 6));
  }
  CHECK(is_told(read(text), "strokes have 4 colours (#ff0000, #0000ff, #ffff00, #ffffff)"));
}

TEST_CASE("profiles give colours and classes and lines their meaning",
          "[core][formats][svg][profile]") {
  const std::string text =
      svg(R"x(<g fill="none"><path d="M0 0H1" stroke="#000"/><path d="M0 1H2" stroke="red"/>
      <path d="M0 2H4" stroke="blue"/><path d="M0 3H8" stroke="#0f0"/><path d="M0 3H16" stroke="#ff0"/>
      <path d="M0 3H32" stroke="#f00001"/></g>)x");
  const auto sums = [&](const char* profile) {
    const LineWork work = read(text, profile);
    std::vector<int> out;
    for (const Operation operation :
         {Operation::Outline, Operation::Cut, Operation::Score, Operation::FoldMountain,
          Operation::FoldValley, Operation::Draw})
      out.push_back(static_cast<int>(std::lround(total_mm(work, operation))));
    return out;
  };
  using Sums = std::vector<int>;
  CHECK(sums("origami-sim") == Sums{1, 8, 0, 2, 4, 0});
  CHECK(sums("rabbit-ear") == Sums{1, 8, 0, 2 + 32, 4, 0});
  CHECK(sums("flat-folder") == Sums{1, 0, 0, 2, 4, 0});
  CHECK(sums("lightburn") == Sums{0, 1 + 8 + 16, 0, 2 + 32, 4, 0});
  CHECK(sums("boxes-py") == Sums{1, 4 + 16 + 32, 8, 0, 0, 0});
  CHECK(sums("fablab") == Sums{2 + 16 + 32, 4 + 8, 0, 0, 0, 1});
  const LineWork model =
      read(svg(R"x(<style>path{fill:none;stroke:#000} .convex{stroke-dasharray:1 2}</style>
      <path class="outer" d="M0 0H1"/><path class="convex" d="M0 0H2"/><path class="concave x" d="M0 0H4"/>)x"),
           "paper-model");
  CHECK(total_mm(model, Operation::Outline) == Approx(1));
  CHECK(total_mm(model, Operation::FoldMountain) == Approx(2));
  CHECK(total_mm(model, Operation::FoldValley) == Approx(4));
  const LineWork layers =
      read(svg(R"x(<g stroke="#000" inkscape:groupmode="layer" inkscape:label="Fold">
      <path d="M0 0H1"/><g inkscape:groupmode="layer" inkscape:label="Mountain"><path d="M0 0H2"/></g></g>
      <g stroke="#000" inkscape:groupmode="layer" inkscape:label="Text"><path d="M0 0H9"/></g>)x"),
           "papercraft");
  CHECK(total_mm(layers, Operation::FoldValley) == Approx(1));
  CHECK(total_mm(layers, Operation::FoldMountain) == Approx(2));
  CHECK(is_told(layers, "1 stroke is neither a cut nor a fold"));
}

TEST_CASE("users can add profiles", "[core][formats][svg][profile]") {
  const std::vector<std::string> tables{R"j({"popcut": 1, "svg_profiles": [
    {"name": "mine", "like": "popcut", "colours": "nearest", "labels": {"Kiss Cut": "score"},
     "rules": [{"colour": ["red", "#f80"], "line": "dashed", "use": "fold-mountain"},
               {"colour": "#00f", "use": "ignore"}], "otherwise": "outline", "fills": "ignore"}]})j"};
  const auto mine = find_stroke_profile("mine", tables);
  REQUIRE(mine);
  SvgReadOptions how;
  how.profile = *mine;
  const auto work = linework_from_svg(
      svg(R"x(<g fill="none"><path d="M0 0H1" stroke="#e00000" stroke-dasharray="1"/>
      <path d="M0 0H2" stroke="#e00000"/><path d="M0 0H4" stroke="navy"/>
      <g inkscape:groupmode="layer" inkscape:label=" kiss_CUT "><path d="M0 0H8" stroke="red"/></g></g>)x"),
      how);
  REQUIRE(work);
  CHECK(total_mm(*work, Operation::FoldMountain) == Approx(1));
  CHECK(total_mm(*work, Operation::Outline) == Approx(2));
  CHECK(total_mm(*work, Operation::Score) == Approx(8));
  CHECK(find_stroke_profile("mint", tables).error().detail.find("did you mean mine") !=
        std::string::npos);
  for (
      const auto& [table, place] : std::vector<std::pair<std::string, std::string>>{
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "rules": [{"colour": "rot", "use": "cut"}]}]})j",
           "table 1: /svg_profiles/0/rules/0/colour"},
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "rules": [{"colour": "red"}]}]})j",
           "table 1: /svg_profiles/0/rules/0/use"},
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "otherwise": "fold"}]})j",
           "table 1: /svg_profiles/0/otherwise"},
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "labels": {"x": "burn"}}]})j",
           "table 1: /svg_profiles/0/labels/x"}}) {
    CAPTURE(table);
    const auto wrong = find_stroke_profile("a", {table});
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().place == place);
  }
}

TEST_CASE("colours are read in all their spellings", "[core][formats][svg]") {
  const auto rgb = [](const char* text) {
    const auto paint = parse_svg_paint(text);
    CAPTURE(text);
    REQUIRE(paint);
    CHECK(paint->kind == SvgPaint::Kind::Colour);
    return paint->rgb;
  };
  for (const char* red :
       {"red", "RED", "#f00", "#FF0000", "#f00f", "#ff0000ff", "rgb(255,0,0)", "rgb(100%, 0%, 0%)",
        "rgb(255 0 0 / 50%)", "#f00 icc-color(sRGB, 1, 0, 0)", "rgba(255,0,0,.5)",
        "hsl(0,100%,50%)", "hsl(360deg 100% 50%)"})
    CHECK(rgb(red) == 0xFF0000);
  CHECK(rgb("rebeccapurple") == 0x663399);
  CHECK(rgb("hsl(120,100%,25%)") == 0x008000);
  for (const char* none : {"none", "transparent", "#ff000000", "rgba(1,2,3,0)"})
    CHECK(parse_svg_paint(none)->kind == SvgPaint::Kind::None);
  CHECK(parse_svg_paint("url(#g) #0f0") == SvgPaint{SvgPaint::Kind::Server, 0x00FF00});
  for (const char* wrong : {"", "rot", "#12", "#12345g", "rgb(1,2)", "rgb(1,2,3", "url(#a"})
    CHECK_FALSE(parse_svg_paint(wrong));
}

TEST_CASE("what is not seen of a stroke is not cut", "[core][formats][svg]") {
  for (const char* unseen :
       {"stroke='#000' opacity='0.001'", "stroke='#000' style='stroke-opacity:0.1%'",
        "color='transparent' stroke='currentColor'", "stroke='#000' requiredExtensions='urn:x'",
        "style='STROKE:#00000000'"}) {
    CAPTURE(unseen);
    const LineWork work =
        read(svg("<path d='M0 0H4' stroke='red'/><path d='M0 0V9' " + std::string(unseen) + "/>"));
    CHECK(total_mm(work, Operation::Cut) == Approx(4));
    CHECK_FALSE(work.warnings.empty());
  }
  const LineWork work =
      read(svg("<g color='#0000'><path d='M0 0H4' color='red' "
               "stroke='currentColor'/></g>"));
  CHECK(total_mm(work, Operation::Cut) == Approx(4));
}

TEST_CASE("colours that are read nowhere do not become those of cuts in silence",
          "[core][formats][svg]") {
  const auto spoils = [](const std::string& inner) {
    const LineWork work = read(svg("<path d='M0 0H4' stroke='#000'/>" + inner));
    return std::any_of(work.warnings.begin(), work.warnings.end(),
                       [](const Warning& warning) { return warning.spoils; });
  };
  const std::string line = "<g class='g' stroke='#000'><path class='f' d='M0 2H4'";
  CHECK_FALSE(spoils(line + "/></g>"));
  CHECK(spoils(line + " style='stroke:var(--fold)'/></g>"));
  CHECK(spoils(line + " stroke='oklch(0.6 0.25 29)'/></g>"));
  CHECK(spoils("<style>.g { .f { stroke: red } }</style>" + line + "/></g>"));
  SvgReadOptions how;
  how.profile = *find_stroke_profile("auto");
  for (const char* red : {"style='STROKE:red'/></g>",
                          "/></g><style type='text/CSS'>"
                          ".f{Stroke:red}</style>"}) {
    CAPTURE(red);
    CHECK_FALSE(linework_from_svg(svg("<path d='M0 0H4' stroke='#000'/>" + line + " " + red), how));
  }
}

TEST_CASE("only one drawing is read of a file", "[core][formats][svg][bad]") {
  SvgReadOptions how;
  how.profile = *find_stroke_profile("auto");
  const std::string one = svg("<path d='M0 0H4' stroke='#000'/>");
  CHECK(linework_from_svg(one + "<!-- end -->\n", how));
  const auto two = linework_from_svg(one + "\n" + one, how);
  REQUIRE_FALSE(two);
  CHECK(two.error().place == "line 2, column 1");
  CHECK(two.error().detail.find("<svg> follows the drawing's end") != std::string::npos);
}

TEST_CASE("features that are not applied are named with their place", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(
      <g clip-path="url(#c)"><path d="M0 0H1" stroke="url(#grad)" mask="url(#m)"/></g>
      <path id="f" d="M0 0H1" stroke="red" style="filter:url(#b)" marker-end="url(#arrow)"/>
      <path d="M0 0H1" stroke="red" transform="scale(0 1)"/><rect stroke="red" width="0" height="2"/>
      <path d="M0 0H1" stroke="red" data-assignment="Q"/>
      <foreignObject/><script/><text display="none">x</text>)x"));
  CHECK(is_told(work, "1 clip path is missing: what it clips is cut whole; at line 2"));
  CHECK(is_told(work, "1 element has a mask"));
  for (const char* unread : {"-webkit-mask:url(#m)", "mask-image:url(#m)", "rotate:45deg",
                             "scale:2", "translate:9px", "offset-path:url(#m)", "zoom:2"}) {
    CAPTURE(unread);
    CHECK_FALSE(read(svg("<path d='M0 0H1' stroke='red' style='" + std::string(unread) + "'/>"))
                    .warnings.empty());
  }
  CHECK(is_told(work, "1 element has a filter, which popcut does not apply; at line 3 (id \"f\")"));
  CHECK(is_told(work, "1 line has markers"));
  CHECK(is_told(work, "1 stroke is painted with a gradient"));
  CHECK(is_told(work, "1 shape or group has no size after its transform"));
  CHECK(is_told(work, "1 shape has no size"));
  CHECK(is_told(work, "1 data-assignment is unknown and ignored; at line 5: \"Q\""));
  CHECK(is_told(work, "1 <foreignObject>"));
  CHECK(is_told(work, "1 script is not run"));
  CHECK_FALSE(is_told(work, "<text>"));
  CHECK(work.lines.size() == 3);
}

TEST_CASE("a warning counts lines beyond the page of a drawing, which are cut whole",
          "[core][formats][svg]") {
  const auto draw = [](const std::string& content, const std::string& root) {
    return read("<svg xmlns='http://www.w3.org/2000/svg' " + root + ">" + content + "</svg>");
  };
  const std::string page = "width='50mm' height='50mm' viewBox='0 0 100 100'";
  const auto path = [](const std::string& d) {
    return "<path id='p' d='" + d + "' stroke='red' fill='none'/>";
  };
  const std::string wholly = path("M110 0H130"), partly = path("M0 -20V40");
  const LineWork both = draw(wholly + partly + path("M0 0H9"), page);
  CHECK(total_mm(both, Operation::Cut) == Approx(10 + 30 + 4.5));
  REQUIRE(both.warnings.size() == 1);
  CHECK(is_told(both, "2 lines lie wholly or partly beyond the page of the drawing"));
  CHECK(is_told(both, "the first at line 1 (id \"p\")"));
  CHECK(both.warnings[0].spoils);
  // The dashes of a stroke count as one line. A fill counts where it is cut.
  CHECK(is_told(draw("<path d='M90 9H190' stroke-dasharray='3' stroke='red'/>", page),
                "1 line lies wholly or partly beyond the page"));
  CHECK(
      is_told(draw("<rect x='90' width='20' height='9'/>", page), "1 line lies wholly or partly"));
  CHECK_FALSE(is_told(draw("<rect x='90' width='20' height='9'/><path id='cut' d='M0 0H9' "
                           "stroke='red'/>",
                           page),
                      "beyond the page"));
  for (const char* shown :
       {"overflow='visible'", "style='overflow:visible'", "viewBox='0 0 200 99'"}) {
    CAPTURE(shown);
    CHECK(draw(wholly,
               std::string(shown) + (shown[0] == 'v' ? " width='50mm' height='50mm'" : " " + page))
              .warnings.empty());
  }
  // What touches the border is on the page, and so is all of a drawing without one.
  CHECK(draw(path("M-0.19 0H100.19V100.19"), page).warnings.empty());
  CHECK_FALSE(draw(path("M-0.3 0H100"), page).warnings.empty());
  CHECK_FALSE(is_told(draw(wholly, ""), "beyond the page"));
  CHECK(is_told(draw(wholly, "width='20mm'"), "beyond the page"));
  // A page that is larger than its viewBox shows what lies beside it.
  CHECK(draw(wholly, "width='100mm' height='50mm' viewBox='0 0 100 100'").warnings.empty());
  // Before a drawing becomes larger, 0.1 mm of it are less.
  SvgReadOptions larger;
  larger.profile = find_stroke_profile("popcut").value();
  larger.enlarged = 10;
  const auto small = linework_from_svg(
      "<svg xmlns='http://www.w3.org/2000/svg' " + page + ">" + path("M-0.1 0H9") + "</svg>",
      larger);
  REQUIRE(small);
  CHECK(is_told(*small, "beyond the page"));
}

TEST_CASE("a warning lists names that are all unknown, if lines have different ones",
          "[core][formats][svg][profile]") {
  SvgReadOptions how;
  how.profile = find_stroke_profile("auto").value();
  const auto told = [&](const std::string& content) {
    const auto work = linework_from_svg(svg(content), how);
    REQUIRE(work);
    CHECK(total_mm(*work, Operation::Cut) == Approx(5 * work->lines.size()));
    return is_told(*work, "neither cut nor fold, and no other name does: all lines are cut");
  };
  const auto in = [](const std::string& name, int y) {
    return "<g id='" + name + "'><path d='M0 " + std::to_string(y) + "H5' stroke='black'/></g>";
  };
  CHECK(told(in("Bird", 1) + in("Tree", 2)));
  CHECK(told(in("Bird", 1) + in("g12", 2)));
  CHECK_FALSE(told(in("Bird", 1)));
  CHECK_FALSE(told(in("Bird", 1) + in("Bird", 2)));
  CHECK_FALSE(told(in("g11", 1) + in("path12", 2)));
  CHECK_FALSE(told(in("cut", 1)));
}

TEST_CASE("a note counts white strokes without a name", "[core][formats][svg]") {
  SvgReadOptions how;
  how.profile = find_stroke_profile("auto").value();
  const auto told = [&](const std::string& content) {
    const auto work = linework_from_svg(svg(content), how);
    REQUIRE(work);
    return is_told(*work, "1 stroke is white");
  };
  CHECK(told("<path d='M0 0H5' stroke='white'/>"));
  CHECK_FALSE(told("<path d='M0 0H5' stroke='black'/>"));
  CHECK_FALSE(told("<g id='cut'><path d='M0 0H5' stroke='white'/></g>"));
}

TEST_CASE("a warning says where viewers disagree", "[core][formats][svg]") {
  const std::string symbol = "<path d='M0 0H5' stroke='red'/></symbol><use href='#s'/>";
  CHECK(is_told(read(svg("<symbol id='s' refX='2' overflow='visible'>" + symbol)),
                "1 <symbol> has a refX or refY"));
  CHECK(is_told(read(svg("<symbol id='s' refY='center' overflow='visible'>" + symbol)),
                "1 <symbol> has a refX or refY"));
  CHECK(read(svg("<symbol id='s' refX='0' overflow='visible'>" + symbol)).warnings.empty());
  const std::string line = "<path d='M0 0H5' stroke='red' ";
  CHECK(is_told(read(svg(line + "style='clip:rect(0,9px,9px,0)'/>")),
                "1 clip path is not made of shapes"));
  CHECK(is_told(read(svg(line + "clip='rect(0 9 9 0)'/>")), "1 clip path is not made of shapes"));
  CHECK(read(svg(line + "clip='auto'/>")).warnings.empty());
}

// SVG 2, section 5.8: the tests of an element count in a <switch> and outside of it.
TEST_CASE("what is for readers of another language or needs an extension is left out and told",
          "[core][formats][svg]") {
  const auto work_of = [](const std::string& test, const std::string& rest = "") {
    return read(svg("<path d='M0 0H5' stroke='red'/><g><path d='M0 9H7' stroke='red' " + test +
                    "/></g>" + rest));
  };
  const auto cut_mm = [&](const std::string& test) {
    return total_mm(work_of(test), Operation::Cut);
  };
  for (const char* left_out : {"systemLanguage='de'", "systemLanguage='de, fr'",
                               "systemLanguage='den'", "systemLanguage=''"}) {
    CAPTURE(left_out);
    CHECK(cut_mm(left_out) == Approx(5));
    CHECK(is_told(work_of(left_out), "1 part of the drawing depends on the reader's language"));
  }
  for (const char* left_out : {"requiredExtensions='http://x'", "requiredExtensions=''",
                               "requiredFeatures='http://www.w3.org/TR/SVG11/feature#Nonsense'",
                               "requiredFeatures='http://www.w3.org/TR/SVG11/feature#'",
                               "requiredFeatures='http://www.w3.org/TR/SVG11/feature#Shape y'"}) {
    CAPTURE(left_out);
    CHECK(cut_mm(left_out) == Approx(5));
    CHECK(is_told(work_of(left_out), "1 element asks for a feature or an extension"));
  }
  for (const char* shown : {"systemLanguage='EN'", "systemLanguage='de,en-US'",
                            "requiredFeatures='http://www.w3.org/TR/SVG11/feature#Shape'",
                            "requiredFeatures='org.w3c.svg.static'"}) {
    CAPTURE(shown);
    CHECK(cut_mm(shown) == Approx(12));
    CHECK(work_of(shown).warnings.empty());
  }
  const auto choice = [&](const std::string& choices) {
    return work_of("stroke-width='1'", "<switch>" + choices + "</switch>");
  };
  const std::string german = "<path systemLanguage='de' d='M0 20H1' stroke='red'/>",
                    english = "<path systemLanguage='en' d='M0 20H2' stroke='red'/>",
                    any = "<path d='M0 20H4' stroke='red'/>";
  CHECK(total_mm(choice(german), Operation::Cut) == Approx(12));
  CHECK(total_mm(choice(german + english + any), Operation::Cut) == Approx(14));
  CHECK(total_mm(choice(german + any), Operation::Cut) == Approx(16));
  for (const std::string& told : {german, german + english, german + any})
    CHECK(is_told(choice(told), "1 part of the drawing depends on the reader's language"));
  CHECK(choice(any).warnings.empty());
  const LineWork clipped = read(svg(R"x(<clipPath id="c"><rect width="3" height="9"/>
      <rect systemLanguage="de" x="3" width="9" height="9"/></clipPath>
      <path clip-path="url(#c)" d="M0 1H8" stroke="red"/>)x"));
  CHECK(total_mm(clipped, Operation::Cut) == Approx(3));
  CHECK(is_told(clipped, "depends on the reader's language"));
}

TEST_CASE("a warning names animations, wherever they stand in a drawing", "[core][formats][svg]") {
  const std::string line = "<path id='p' stroke='red' d='M0 0H5'";
  for (const std::string& moving :
       {line + "><animate attributeName='d' to='M0 0H9'/></path>",
        line + "><set attributeName='visibility' to='hidden'/></path>",
        line + "><animateMotion path='M0 0H5'/></path>",
        "<g><animateTransform attributeName='transform' type='rotate' to='90'/>" + line + "/></g>",
        line + "/><defs><animate xlink:href='#p' attributeName='d' to='M0 0H9'/></defs>",
        line + " style='animation:turn 1s'/><style>@keyframes turn{to{rotate:9deg}}</style>"}) {
    CAPTURE(moving);
    const LineWork work = read(svg(moving));
    CHECK(total_mm(work, Operation::Cut) == Approx(5));
    REQUIRE(work.warnings.size() == 1);
    CHECK(is_told(work, "1 part of the drawing moves (animation) and is read as it stands"));
    CHECK(work.warnings[0].spoils);
  }
  CHECK(is_told(read(svg(line + "/><defs><script>p.remove()</script></defs>")),
                "1 script is not run"));
  CHECK(read(svg(line + "/><metadata><i:set/></metadata>")).warnings.empty());
}

TEST_CASE("a document type is never fetched and only plain entities are expanded",
          "[core][formats][svg][bad]") {
  const std::string drawing = svg("<path stroke='red' d='M0 0H&w;'/>");
  const auto with = [&](const std::string& doctype) {
    return "\xEF\xBB\xBF<?xml version='1.0'?>\n<!-- <!DOCTYPE --> " + doctype + "\n" + drawing;
  };
  CHECK(length(read(with("<!DOCTYPE svg [<!ENTITY w '12'> <!-- > ] --> <!ENTITY ns \"a'b>\">]>"))
                   .points) == Approx(12));
  CHECK(read("<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"http://a/svg11.dtd\">" +
             svg("<path stroke='red' d='M0 0H1'/>"))
            .lines.size() == 1);
  CHECK(read("<!DOCTYPE svg [<!ATTLIST svg xmlns:a CDATA #FIXED 'http://a' xmlns:b CDATA \"b\"> "
             "<!ENTITY w '12'>]>" +
             drawing)
            .lines.size() == 1);
  for (const char* subset :
       {"<!ATTLIST svg xmlns:a CDATA 'a' w (1|2) '1'>",
        "<!ATTLIST svg xmlns:a CDATA 'a' fill CDATA #FIXED 'red'>",
        "<!ATTLIST svg xmlns:a CDATA 'a", "<!ENTITY a 'x'><!ENTITY w '&a;&a;'>",
        "<!ENTITY % w '1'>", "<!ENTITY w SYSTEM 'file:///etc/passwd'>",
        "<!ENTITY w PUBLIC 'a' 'http://a'>", "<!ELEMENT svg ANY>", "<!ATTLIST svg w CDATA '1'>",
        "%w;", "<!ENTITY w '<g/>'>", "<!ENTITY w '1' NDATA x>", "<!NOTATION n SYSTEM 'x'>",
        "<?pi?>", "<!ENTITY w '1"}) {
    CAPTURE(subset);
    const Error error = error_of(with(std::string("<!DOCTYPE svg [") + subset + "]>"));
    CHECK(error.kind == ErrorKind::Malformed);
    CHECK(error.place.rfind("line ", 0) == 0);
  }
  std::string many;
  for (int i = 0; i < 65; ++i) many += "<!ENTITY e" + std::to_string(i) + " 'x'>";
  CHECK(error_of(with("<!DOCTYPE svg [" + many + "]>")).kind == ErrorKind::OutOfRange);
  const auto of_size = [](std::size_t n) {
    return "<!DOCTYPE svg [<!ENTITY w '1'><!ENTITY a '" + std::string(n, 'x') + "'>]>";
  };
  CHECK(error_of(with(of_size(257)))
            .detail.find("the entity a has 257 bytes, but the limit is 256") != std::string::npos);
  CHECK(read(with(of_size(256))).lines.size() == 1);
  SvgLimits small;
  small.bytes = 100'000;
  std::string refs;
  for (int i = 0; i < 1000; ++i) refs += "&a;";
  CHECK(error_of(of_size(256) + svg("<title>" + refs + "</title>"), small).kind ==
        ErrorKind::OutOfRange);
}

TEST_CASE("a drawing in UTF-16 or packed by gzip is read", "[core][formats][svg][bad]") {
  const std::string plain = svg("<title>\xC3\xA9</title><path stroke='red' d='M0 0H3'/>");
  for (const bool big : {true, false}) {
    std::string wide = big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char32_t c : std::u32string(plain.begin(), plain.end())) {
      if ((c & 0xFF) == 0xC3) continue;
      const char low = static_cast<char>((c & 0xFF) == 0xA9 ? 0xE9 : c);
      wide += big ? std::string{'\0', low} : std::string{low, '\0'};
    }
    const LineWork work = read(wide);
    CHECK(work.name == "\xC3\xA9");
    CHECK(length(work.points) == Approx(3));
  }
  CHECK(error_of("\x1F\x8B\x08").detail.find("gunzip") != std::string::npos);
  // Packed by gzip.
  constexpr std::string_view kPacked{
      "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x2d\x8c\x31\x0e\xc2\x30\x0c\x00\xbf\xe2\xcd\x5b"
      "\x1d\x01\x4b\x50\x9c\x81\x89\x85\x47\x20\x25\x8a\x23\x08\xa9\x12\xab\xee\xf3\x29\x12\xe3"
      "\xe9\x4e\x17\xe6\x56\x60\x6f\xef\xcf\x64\x14\xd5\xf5\x4a\x64\x66\x8b\x9d\x97\x3e\x0a\x9d"
      "\x9c\x73\x74\x14\x08\x56\x93\x0a\xa3\x6f\x0d\x41\x72\x2d\xa2\x7f\xd8\x6a\xb6\x5b\xdf\x19"
      "\x1d\x38\xf0\xe0\x31\x86\xf5\xa9\x02\x53\x47\x7f\x65\xc6\x91\x13\x42\x62\x7c\x1c\xfe\x7e"
      "\x41\x8a\xe1\x37\x8c\x5f\x92\xc4\xab\x72\x78\x00\x00\x00",
      124};
  CHECK(length(read(std::string(kPacked)).points) == Approx(4));
  CHECK(error_of(std::string(kPacked.substr(0, 60))).detail.find("not whole") != std::string::npos);
  SvgLimits few;
  few.bytes = 100;
  CHECK(error_of(std::string(kPacked), few).kind == ErrorKind::OutOfRange);
  CHECK(error_of(svg(std::string(1, '\0'))).detail.find("is zero") != std::string::npos);
}

TEST_CASE("invalid numbers are refused in one line with the element", "[core][formats][svg][bad]") {
  for (const char* inner :
       {"<path id='p' stroke='red' d='M0 0L1e308 1e308'/>",
        "<path id='p' stroke='red' d='M0 0Lnan 1'/>",
        "<path id='p' stroke='red' d='M0 0L1e999 1'/>",
        "<rect id='p' stroke='red' width='inf' height='1'/>",
        "<circle id='p' stroke='red' r='1e308'/>",
        "<path id='p' stroke='red' d='M0 0C1e308 0 0 1e308 9 9'/>",
        "<path id='p' stroke='red' d='M0 0A1e308 1e308 0 0 0 1e300 1'/>",
        "<path id='p' stroke='red' d='M0 0H1' transform='scale(1e308)'/>",
        "<path id='p' stroke='red' d='M0 0H1' transform='rotate(nan)'/>",
        "<path id='p' stroke='red' d='M0 0H1' transform='matrix(1 2 3)'/>",
        "<polygon id='p' stroke='red' points='0 0 1'/>",
        "<polygon id='p' stroke='red' points='0 0 a 1'/>", "<svg id='p' viewBox='0 0 nan 1'/>",
        "<svg id='p' viewBox='0 0 -1 1'/>", "<line id='p' stroke='red' x1='1 2'/>"}) {
    CAPTURE(inner);
    const Error error = error_of(svg(std::string("\n") + inner));
    CHECK(error.place.rfind("line 2, column ", 0) == 0);
    CHECK(error.place.find("id \"p\"") != std::string::npos);
    CHECK(error.detail.size() < 300);
  }
  for (const char* head :
       {"viewBox='0 0 0 100'", "viewBox='0 0 1'", "viewBox='a'", "width='0' height='5'",
        "width='-5mm' height='5mm'", "viewBox='0 0 1e999 1'"}) {
    CAPTURE(head);
    error_of(svg("<path stroke='red' d='M0 0H1'/>", head));
  }
}

TEST_CASE("sizes are checked before memory is taken", "[core][formats][svg][bad]") {
  SvgLimits limits;
  limits.bytes = 1000;
  CHECK(error_of(std::string(1001, ' '), limits).detail.find("the limit is 1000") !=
        std::string::npos);
  std::string nodes;
  for (int i = 0; i < 1000; ++i) nodes += "<a/>";
  limits = {};
  limits.tree_bytes = 10'000;
  CHECK(error_of(svg(nodes), limits).kind == ErrorKind::OutOfRange);
  limits = {};
  limits.points = 50;
  std::string path = "<path id='big' stroke='red' d='M0 0";
  for (int i = 0; i < 60; ++i) path += "l1 1";
  const Error many = error_of(svg(path + "'/>"), limits);
  CHECK(many.kind == ErrorKind::OutOfRange);
  CHECK(many.place.find("id \"big\"") != std::string::npos);
  std::string deep;
  for (int i = 0; i < 300; ++i) deep += "<g>";
  for (int i = 0; i < 300; ++i) deep += "</g>";
  CHECK(error_of(svg(deep)).detail.find("200 deep") != std::string::npos);
  // Every selector against every element: too much work, and told so.
  std::string rules, paths;
  for (int i = 0; i < 2000; ++i) rules += "* * * * *{stroke:red}", paths += "<g/>";
  limits = {};
  limits.steps = 2'000'000;
  CHECK(error_of(svg("<style>" + rules + "</style>" + paths), limits).kind ==
        ErrorKind::OutOfRange);
  CHECK(SvgLimits{}.raised(4).points == 16'000'000);
}

TEST_CASE("long lists of classes and many selectors are read in time or refused as too much",
          "[core][formats][svg]") {
  std::string classes, single, pairs;
  for (int i = 0; i < 2000; ++i) {
    classes += "c" + std::to_string(i) + " ";
    single += ".c" + std::to_string(i) + "{stroke:red}";
    pairs += ".c0.c1999{stroke:red}";
  }
  SvgLimits limits;
  limits.steps = 100'000;
  const auto with = [&](const std::string& rules) {
    return svg("<style>" + rules + "</style><path class='" + classes + "' d='M1,1h20'/>");
  };
  // A class by which a rule was found is not looked for again; others are.
  CHECK(linework_from_svg(with(single), {.limits = limits}));
  CHECK(error_of(with(pairs), limits).kind == ErrorKind::OutOfRange);
}

TEST_CASE("curves follow the requested tolerance", "[core][formats][svg]") {
  SvgReadOptions how;
  how.profile = *find_stroke_profile("plain");
  std::size_t last = 0;
  for (const double tolerance : {0.5, 0.1, 0.02, 0.005}) {
    how.tolerance_mm = tolerance;
    const auto work = linework_from_svg(
        svg("<circle r='1' transform='translate(50 50) scale(40)' stroke='red' fill='none'/>"),
        how);
    REQUIRE(work);
    CAPTURE(tolerance, work->points.size());
    CHECK(work->points.size() > last);
    last = work->points.size();
    for (std::size_t i = 1; i < work->points.size(); ++i) {
      const PagePoint &a = work->points[i - 1], &b = work->points[i];
      CHECK(40 - std::hypot((a.x + b.x) / 2 - 50, (a.y + b.y) / 2 - 50) <= tolerance * (1 + 1e-9));
    }
  }
}

TEST_CASE("a prefix for SVG and elements of editors are accepted", "[core][formats][svg]") {
  const LineWork work =
      read(R"x(<s:svg xmlns:s="http://www.w3.org/2000/svg" xmlns:sodipodi="x" width="9mm"
      height="9mm" viewBox="0 0 9 9"><s:title>T</s:title><sodipodi:namedview><g/></sodipodi:namedview>
      <s:style>.a{stroke:red}</s:style><s:path class="a" d="M0 0H4"/></s:svg>)x");
  CHECK(work.name == "T");
  CHECK(length(work.points) == Approx(4));
  CHECK(work.warnings.empty());
  const LineWork choice =
      read(svg(R"x(<switch><foreignObject requiredExtensions="http://ns.adobe.com"/>
      <g><path d="M0 0H4" stroke="red"/></g><g><path d="M0 0H9" stroke="red"/></g></switch>)x"));
  CHECK(length(choice.points) == Approx(4));
  CHECK(choice.warnings.empty());
}

TEST_CASE("strokes of width 0 and text are told with what to do", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<g stroke="red" fill="none" stroke-width="0">
      <path id="a" d="M0 0H1"/><path d="M0 0H2" style="stroke-width:0px"/>
      <path d="M0 0H4" stroke-width="0.01"/><path d="M0 0H8" stroke-width="initial"/>
      <path d="M0 0H9" stroke="none"/></g><path d="M0 0H16" stroke="red"/>
      <text id="t"><tspan>x</tspan></text>)x"));
  CHECK(total_mm(work, Operation::Cut) == Approx(1 + 2 + 4 + 8 + 16));
  CHECK(is_told(work,
                "2 strokes of width 0, which viewers do not show, are read as any other; the "
                "first at line 2 (id \"a\"); set a stroke-width"));
  CHECK(is_told(work,
                "1 <text> cannot be read and is left out; at line 5 (id \"t\"); turn it into "
                "paths (Inkscape: Path > Object to Path"));
  CHECK(std::count_if(work.warnings.begin(), work.warnings.end(),
                      [](const Warning& w) { return w.code == "stroke_zero" && w.spoils; }) == 1);
}

TEST_CASE("layers of Illustrator are read by their names", "[core][formats][svg][profile]") {
  CHECK(illustrator_name("Fold") == "Fold");
  CHECK(illustrator_name("Fold_Lines") == "Fold Lines");
  CHECK(illustrator_name("fold_x5F_mountain") == "fold_mountain");
  CHECK(illustrator_name("fold_x2D_valley_1_") == "fold-valley");
  CHECK(illustrator_name("Cut_2_") == "Cut");
  CHECK(illustrator_name("Cut_2") == "Cut 2");
  CHECK(illustrator_name("_x31_st_cut") == "1st cut");
  CHECK(illustrator_name("_x") == " x");
  CHECK(illustrator_name("a_x__") == "a x  ");
  CHECK(illustrator_name("_1_") == " 1 ");
  CHECK(illustrator_name("").empty());

  const std::string comment =
      "<?xml version='1.0'?>\n<!-- Generator: Adobe Illustrator 24.0.1, SVG Export Plug-In . SVG "
      "Version: 6.00 Build 0)  -->\n";
  const std::string groups = R"x(<g id="Art"><g id="Fold"><path d="M0 0H1" stroke="#000"/></g>
      <g id="fold_x5F_mountain_1_"><path d="M0 0H2" stroke="#000"/></g></g>
      <g id="Cut"><path d="M0 0H4" stroke="#000"/><g id="Layer_4" data-name="Score lines">
      <path d="M0 0H8" stroke="#000"/></g></g><g id="g16"><path d="M0 0H16" stroke="#000"/></g>)x";
  const LineWork work = read(comment + svg(groups), "auto");
  CHECK(total_mm(work, Operation::FoldValley) == Approx(1));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(2));
  CHECK(total_mm(work, Operation::Cut) == Approx(4 + 16));
  CHECK(total_mm(work, Operation::Score) == Approx(8));
  CHECK_FALSE(is_told(work, "by its name"));
  // The same in drawings of other programs, and it is said.
  const LineWork plain = read(svg(groups), "auto");
  CHECK(total_mm(plain, Operation::FoldValley) == Approx(1));
  CHECK(total_mm(plain, Operation::Cut) == Approx(4 + 16));
  CHECK(is_told(plain, "4 groups are read by their names as layers of those names; the first"));
  const LineWork fold = read(svg(R"x(<g id="valley_folds"><path d="M0 0H1" stroke="red"/></g>
      <g id="cut"><path d="M0 0H2" stroke="blue"/></g>)x"),
                             "auto");
  CHECK(total_mm(fold, Operation::FoldValley) == Approx(1));
  CHECK(total_mm(fold, Operation::Cut) == Approx(2));
  CHECK(is_told(fold, "2 groups are read by their names"));
  CHECK(total_mm(read(svg(groups), "plain"), Operation::Cut) == Approx(31));
  // A label of Inkscape counts before the id.
  const LineWork both = read(svg(R"x(<g id="cut" inkscape:groupmode="layer" inkscape:label="Fold">
      <path d="M0 0H1" stroke="red"/></g>)x"));
  CHECK(total_mm(both, Operation::FoldValley) == Approx(1));
  CHECK(both.warnings.empty());
}

TEST_CASE("words of many languages say what lines are for", "[core][formats][words]") {
  const auto all_mean = [](LayerMeaning meaning, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      CAPTURE(name);
      CHECK(layer_meaning(name) == meaning);
    }
  };
  using enum LayerMeaning;
  all_mean(Fold, {"perf",
                  "Bend lines",
                  "HINGE",
                  "Crease pattern",
                  "Falz",
                  "Faltlinien",
                  "pli",
                  "Plis",
                  "doblez",
                  "折线",
                  "折り線",
                  "сгиб",
                  "СГИБЫ",
                  "zagięcie",
                  "ZAGIĘCIE",
                  "vouwlijn",
                  "foldline",
                  "PerfCutContour",
                  "fold&cut",
                  "접는선",
                  "piega",
                  "vinco",
                  "\xEF\xBD\x86old",
                  "fold-left-wing",
                  "Knicklinie",
                  "Biegekante",
                  "gefalzt",
                  "Kat çizgisi",
                  "Линии сгиба",
                  "изгибы",
                  "Taitelinja",
                  "dobrado",
                  "gevouwen",
                  "plec",
                  "خط الطي",
                  "קו קיפול",
                  "เส้นพับ",
                  "ĐƯỜNG GẤP",
                  "garis lipat",
                  "मोड़",
                  "ভাঁজ",
                  "خط تا",
                  "M/V",
                  "p\xCC\x81li"});
  all_mean(FoldMountain,
           {"Mtn", "mountain", "Bergfalten", "山折り", "m", "M-fold", "BEND_DOWN", "M 1"});
  all_mean(FoldValley,
           {"Vly", "valleyFolds", "Talfalte", "谷折", "V", "BEND_UP", "Vallée", "Linie V"});
  all_mean(Score, {"half cut", "Kiss-Cut", "kisscut", "scored", "Rillen", "ハーフカット", "半切",
                   "rainage", "Rainé", "Rain\xe9", "Mi-chair", "hendido", "Nutlinie", "geritzt",
                   "linia bigowania", "Бигование", "压痕"});
  all_mean(Draw, {"Engrave", "Gravur", "pen", "Lasergravur"});
  all_mean(Ignore,
           {"guide", "Notes", "Hilfslinien", "no cut", "don't cut", "NICHT schneiden",
            "ne pas couper", "不切割", "Registration marks", "pas de découpe", "do not cut"});
  all_mean(Cut,
           {"Cut", "CutContour", "Schnittlinie", "découpe", "刀线", "切り", "Cut no 2", "slit"});
  all_mean(Outline, {"Outline", "Umriß", "轮廓"});
  all_mean(Unknown, {"wing", "Hingemaker", "glue tab", "dieline", "F", "S", "R-2", "Ф", "A",
                     "Layer S", "s1"});
  // What is not folded may be cut, and what is not cut may be folded.
  all_mean(Unknown, {"cut without fold", "no fold", "Ohne Falz schneiden", "pas de pli", "不折",
                     "Fold, do not cut", "Fold: no", "折り目なし", "No"});
  all_mean(Wordless, {"", "0", "Layer 1", "path4242", "Ebene_2", "图层 1", "g17-3", "cls-1", "g5",
                      "e4023", "3fa9b2c1", "550e8400-e29b-41d4-a716-446655440000", "Untitled"});
  CHECK(parse_layer_uses("a=fold;b").error().place == "/options/layers");
  CHECK(parse_layer_uses("a=flod").error().detail.find("did you mean fold") != std::string::npos);
  CHECK(parse_layer_uses("Kiss Cut=cut")->at("kiss cut") == Cut);
}

TEST_CASE("names count at every depth, on lines, and as classes", "[core][formats][svg][profile]") {
  const auto folds_of = [](const std::string& inner) {
    const LineWork work = read(svg(inner), "auto");
    CHECK(total_mm(work, Operation::Cut) == Approx(4));
    return total_mm(work, Operation::FoldValley);
  };
  const std::string fold = "<path d='M0 0H2' stroke='#000'", cut = "<path d='M0 0H4' stroke='#000'";
  for (const std::string& inner :
       {"<g id='Frame 1'><g id='cut'>" + cut + "/></g><g id='fold'>" + fold + "/></g></g>",
        "<g id='Page-1'><g id='Card'><g id='cut'>" + cut + "/></g><g id='Falz'>" + fold +
            "/></g></g></g>",
        "<g id='Frame 1'>" + cut + " id='cut'/>" + fold + " id='fold_2'/></g>",
        cut + " class='cls-1 cut'/>" + fold + " class='cls-1 fold'/>",
        "<g class='cut'>" + cut + "/></g><g class='perf'>" + fold + "/></g>",
        cut + " inkscape:label='Schnitt'/>" + fold + " inkscape:label='Talfalte'/>",
        cut + " data-name='Cut'/>" + fold + " data-name='Valley' id='cut-2'/>",
        cut + " aria-label='Cut'/>" + fold + " v:layerName='Fold 2'/>",
        "<g data-layer='cut'>" + cut + "/></g><g xlink:title='Fold'>" + fold + "/></g>",
        "<g name='cut'>" + cut + "/></g><g><s:title>Fold</s:title>" + fold + "/></g>",
        // A line of a fold is not cut because of its id.
        "<g id='cut'>" + cut + "/></g><g id='fold'>" + fold + " id='cutout'/></g>",
        "<svg id='fold'>" + fold + "/></svg>" + cut + " id='Cut'/>",
        cut + " data-assignment='cut'/>" + fold + " data-assignment='crease'/>"}) {
    CAPTURE(inner);
    CHECK(folds_of(inner) == Approx(2));
  }
  CHECK(is_told(read(svg(cut + " id='cut'/>"), "auto"), "1 line is what its id or class says"));
}

TEST_CASE("letters of a text that became paths are no name", "[core][formats][svg][profile]") {
  const LineWork work =
      read(svg("<g aria-label='FOLD' style='font-size:9px'><path d='M0 0H4' stroke='#000'/></g>"),
           "auto");
  CHECK(total_mm(work, Operation::Cut) == Approx(4));
}

TEST_CASE("the root has the name of the only layer of Illustrator",
          "[core][formats][svg][profile]") {
  const std::string line = "<path d='M0 0H4' stroke='#000'/>";
  const auto folds = [](const LineWork& work) { return total_mm(work, Operation::FoldValley); };
  CHECK(folds(read(svg(line, "id='Fold' data-name='Fold'"), "auto")) > 0);
  CHECK(folds(read("<!-- Generator: Adobe Illustrator 24.0 -->" + svg(line, "id='Falz'"), "auto")) >
        0);
  CHECK(folds(read(svg(line, "id='fold'"), "auto")) == 0);
  CHECK(folds(read(svg("<g id='Cut'>" + line + "</g>", "data-name='Fold'"), "auto")) == 0);
  // One that cuts says nothing of other colours.
  SvgReadOptions how;
  how.profile = *find_stroke_profile("auto");
  const std::string red = "<path d='M0 2H4' stroke='red'/>";
  CHECK_FALSE(linework_from_svg(svg(line + red, "id='Cut' data-name='Cut'"), how));
}

TEST_CASE("a name that nobody knows beside known ones is asked about",
          "[core][formats][svg][profile]") {
  const auto asked = [](const std::string& inner) {
    SvgReadOptions how;
    how.profile = *find_stroke_profile("auto");
    const auto work = linework_from_svg(svg(inner), how);
    return work ? std::string() : work.error().place + ": " + work.error().detail;
  };
  const auto layer = [](const std::string& label) {
    return "<g inkscape:groupmode='layer' inkscape:label='" + label +
           "'><path d='M0 0H4' stroke='#000'/></g>";
  };
  const auto group = [](const std::string& id) {
    return "<g id='" + id + "'><path d='M0 0H4' stroke='#000'/></g>";
  };
  CHECK(asked(layer("Cut") + layer("Wing")).find("use `layers` \"Wing=fold\"") !=
        std::string::npos);
  CHECK(asked(group("Cut") + group("Wing") + group("Tuck")).find("the names \"Wing\", \"Tuck\"") !=
        std::string::npos);
  CHECK(asked(group("Wing") + group("Tuck")).empty());
  CHECK(asked(group("Cut") + group("Layer_2") + group("g17")).empty());
  // Letters; those of FOLD mean the same beside M or V.
  CHECK_FALSE(asked(layer("Cut") + layer("R-2")).empty());
  CHECK_FALSE(asked(group("Cut") + "<path id='S' d='M0 0H4' stroke='#000'/>").empty());
  CHECK_FALSE(asked(layer("Cut") + layer("C")).empty());
  CHECK(asked(layer("M") + layer("C") + layer("B1")).empty());
  CHECK_FALSE(asked(layer("M") + layer("C") + layer("U")).empty());
  // What is not drawn has no name.
  CHECK_FALSE(asked("<mask id='m'/>" + layer("Cut") + layer("C")).empty());
  // As a class or a title, in another frame, or with Affinity's own name of a group.
  CHECK_FALSE(asked("<path class='cut' d='M0 0H4' stroke='#000'/>"
                    "<path class='cls-1 a zwaan' d='M0 2H4' stroke='#000'/>")
                  .empty());
  CHECK_FALSE(
      asked(group("Cut") + "<g><title>zwaan</title><path d='M0 0H4' stroke='#000'/></g>").empty());
  CHECK_FALSE(asked(group("Cut") + "<g id='Frame 2'>" + group("zwaan") + "</g>").empty());
  CHECK(asked(group("Cut") + "<path class='cls-1' id='Vector' d='M0 0H4' stroke='#000'/>").empty());
  CHECK(asked(group("Cut") + "<g xmlns:serif='http://www.serif.com/' id='Wing1' serif:id='Fold 1'>"
                             "<path d='M0 0H4' stroke='#000'/></g>")
            .empty());
  // A name around known ones, as programs give to what they group.
  CHECK(asked("<g id='Art'>" + group("Cut") + group("Fold") + "</g>").empty());
  CHECK_FALSE(asked("<path id='fold' d='M0 0H4' stroke='#000'/>"
                    "<path id='wing' d='M0 0H4' stroke='#000'/>")
                  .empty());
  CHECK(
      asked(group("Cut") + "<g id='Wing'><g class='fold'><path d='M0 0H4' stroke='#000'/></g></g>")
          .empty());
  SvgReadOptions how;
  how.profile = *find_stroke_profile("auto");
  how.profile.labels = *parse_layer_uses("Wing=fold; cut=ignore");
  const auto said = linework_from_svg(svg(layer("Cut") + layer("Wing")), how);
  REQUIRE(said);
  CHECK(total_mm(*said, Operation::FoldValley) == Approx(4));
  CHECK(total_mm(*said, Operation::Cut) == 0);
}

TEST_CASE("names are read in the encoding that the XML declaration gives",
          "[core][formats][svg][profile]") {
  const auto folds = [](const std::string& encoding, const std::string& cut,
                        const std::string& fold) {
    const LineWork work = read("<?xml version=\"1.0\" encoding=\"" + encoding + "\"?>" +
                                   svg("<g id='" + cut +
                                       "'><path d='M0 0H4' stroke='#000'/></g>"
                                       "<g id='" +
                                       fold + "'><path d='M0 0H2' stroke='#000'/></g>"),
                               "auto");
    CHECK(total_mm(work, Operation::Cut) == Approx(4));
    return total_mm(work, Operation::FoldValley);
  };
  CHECK(folds("windows-1251", "\xf0\xe5\xe7", "\xf1\xe3\xe8\xe1") == Approx(2));
  CHECK(folds("GBK", "\xc7\xd0\xb8\xee", "\xd5\xdb\xcf\xdf") == Approx(2));
  CHECK(folds("Shift_JIS", "cut", "\x90\xdc\x82\xe8\x90\xfc") == Approx(2));
}

TEST_CASE("filled shapes that lie over each other are told and welded on request",
          "[core][formats][svg]") {
  const auto cut = [](const std::string& inner, bool weld) {
    SvgReadOptions how;
    how.profile = *find_stroke_profile("auto");
    how.weld = weld;
    const auto work = linework_from_svg(svg(inner), how);
    REQUIRE(work);
    return *work;
  };
  const std::string crossing =
      "<rect x='10' y='10' width='30' height='20'/><rect x='30' y='20' width='30' height='20'/>";
  CHECK(total_mm(cut(crossing, false), Operation::Cut) == Approx(200));
  CHECK(is_told(cut(crossing, false), "2 filled shapes lie over each other"));
  CHECK(total_mm(cut(crossing, true), Operation::Cut) == Approx(160));
  SvgReadOptions weld;
  weld.profile = *find_stroke_profile("auto");
  weld.weld = true;
  for (const char* scale : {"1e9", "1e18", "1e130"}) {
    const auto huge = linework_from_svg(
        svg("<g transform='scale(" + std::string(scale) + ")'>" + crossing + "</g>"), weld);
    REQUIRE_FALSE(huge);
    CHECK_THAT(huge.error().detail, Catch::StartsWith("is more than 100 m from the origin"));
  }
  // Beside each other, and one within the other.
  const std::string beside =
      "<rect x='10' y='10' width='30' height='20'/><rect x='40' y='10' width='30' height='20'/>";
  CHECK_FALSE(is_told(cut(beside, false), "lie over each other"));
  CHECK(total_mm(cut(beside, true), Operation::Cut) == Approx(160));
  const std::string within =
      "<rect x='10' y='10' width='30' height='20'/><rect x='15' y='15' width='5' height='5'/>";
  CHECK_FALSE(is_told(cut(within, false), "lie over each other"));
  CHECK(total_mm(cut(within, true), Operation::Cut) == Approx(100));
  // Lines of one path, and shapes with a stroke. The even-odd rule makes holes.
  const std::string both = " d='M10 10H40V30H10Z M30 20H60V40H30Z'/>";
  for (const std::string path : {"<path", "<path stroke='#000' fill='#f00'"}) {
    CAPTURE(path);
    CHECK(is_told(cut(path + both, false), "1 filled shape has lines that lie over what it fills"));
    CHECK(total_mm(cut(path + both, true), Operation::Cut) == Approx(160));
  }
  CHECK(cut("<path fill='none' stroke='#000'" + both, false).warnings.empty());
  CHECK_FALSE(is_told(cut("<path fill-rule='evenodd'" + both, false), "lie over"));
  CHECK(total_mm(cut("<path fill-rule='evenodd'" + both, true), Operation::Cut) == Approx(200));
  // popcut looks for crossings after it has scaled the drawing.
  SvgReadOptions tiny;
  tiny.profile = *find_stroke_profile("auto");
  tiny.enlarged = 300;
  const auto small = linework_from_svg(
      svg("<rect x='.1' y='.1' width='.3' height='.2'/><rect x='.395' y='.2' width='.3' "
          "height='.2'/>"),
      tiny);
  REQUIRE(small);
  CHECK(is_told(*small, "2 filled shapes lie over each other"));
  // Strokes go with their fills, holes and other operations stay.
  const std::string stroked =
      "<g stroke='#000' fill='#eee'><rect x='10' y='10' width='30' height='20'/><rect x='30' "
      "y='20' "
      "width='30' "
      "height='20'/></g><g id='fold'><path d='M0 0H9' stroke='#000'/></g>";
  CHECK(total_mm(cut(stroked, true), Operation::Cut) == Approx(160));
  CHECK(is_told(cut(stroked, false), "2 filled shapes lie over each other"));
  CHECK(total_mm(cut(stroked, true), Operation::FoldValley) == Approx(9));
}

TEST_CASE("drawings of Inkscape before 0.92 are told to have 90 units to the inch",
          "[core][formats][svg]") {
  const auto told = [](const std::string& head) {
    return is_told(read(svg("<path d='M0 0H9' stroke='red'/>", head)), "use `svg-dpi` 90");
  };
  const std::string mm = "width='210mm' height='297mm' ";
  CHECK(told(mm + "inkscape:version='0.48.4 r9939'"));
  CHECK(told(mm + "inkscape:version='0.91'"));
  CHECK(told("width='744' height='1052' inkscape:version='0.47pre4'"));
  CHECK(told(mm + "xmlns:sodipodi='s' sodipodi:version='0.32'"));
  CHECK_FALSE(told(mm + "inkscape:version='0.92.3'"));
  CHECK_FALSE(told(mm + "inkscape:version='1.2'"));
  CHECK_FALSE(told(mm + "viewBox='0 0 210 297' inkscape:version='0.48'"));
}

TEST_CASE("drawings of Illustrator without a unit are told to have 72 to the inch",
          "[core][formats][svg]") {
  const std::string comment = "<!-- Generator: Adobe Illustrator 24.0.1 -->";
  const std::string line = "<path d='M0 0H72' stroke='red'/>";
  const std::string px = "width='72px' height='72px' viewBox='0 0 72 72'";
  const std::string advice = "use `svg-dpi` 72";
  const LineWork work = read(comment + svg(line, px));
  CHECK(total_mm(work, Operation::Cut) == Approx(72 * 25.4 / 96));
  CHECK(is_told(work, advice));
  CHECK(is_told(read(comment + svg(line, "viewBox='0 0 72 72'")), advice));
  CHECK_FALSE(is_told(read(comment + svg(line, "width='1in' viewBox='0 0 72 72'")), advice));
  CHECK_FALSE(is_told(read(comment + svg(line, "width='72pt' viewBox='0 0 72 72'")), advice));
  CHECK_FALSE(is_told(read(svg(line, px)), advice));
  CHECK_FALSE(is_told(read(svg(line + comment, px)), advice));
  SvgReadOptions how;
  how.profile = *find_stroke_profile("popcut");
  how.dpi = 72;
  const auto said = linework_from_svg(comment + svg(line, px), how);
  REQUIRE(said);
  CHECK(total_mm(*said, Operation::Cut) == Approx(25.4));
  CHECK_FALSE(is_told(*said, advice));
}

TEST_CASE("a person says what colours and names are for, and what is left to say is known",
          "[core][formats][svg][profile]") {
  const std::string text =
      svg(R"x(<g fill="none"><path d="M0 0H1" stroke="#000"/><path d="M0 1H2" stroke="red"/>
      <path d="M0 2H4" stroke="blue"/><path d="M0 3H8" stroke="blue"/></g>)x");
  SvgReadOptions how;
  how.profile = *find_stroke_profile("auto");
  REQUIRE(linework_from_svg(text, how).error().reason == ErrorReason::Unclear);
  how.looks = true;
  const auto asked = linework_from_svg(text, how);
  REQUIRE(asked);
  CHECK(asked->asks == "colors");
  CHECK(asked->unsaid == std::vector<DrawnLook>{{"", "#000000"}, {"", "#ff0000"}, {"", "#0000ff"}});
  REQUIRE(asked->lines.size() == 4);
  CHECK(asked->lines[3].operation.pen == 3);
  how.profile.colours = *parse_colour_uses("red=fold-mountain; #00F=ignore");
  const auto said = linework_from_svg(text, how);
  REQUIRE(said);
  CHECK(said->asks.empty());
  CHECK(said->unsaid == std::vector<DrawnLook>{{"", "#000000"}});
  how.looks = false;
  const auto read = linework_from_svg(text, how);
  REQUIRE(read);
  CHECK(read->lines.size() == 2);
  CHECK(total_mm(*read, Operation::FoldMountain) == Approx(2));
  CHECK(total_mm(*read, Operation::Cut) == Approx(1));
  // Where cuts were said, a colour of which nothing was said is not cut.
  for (const bool looks : {false, true}) {
    how.looks = looks;
    how.profile.colours = *parse_colour_uses("black=cut; red=fold-mountain");
    const auto half = linework_from_svg(text, how);
    REQUIRE(half.has_value() == looks);
    if (looks)
      CHECK((half->asks == "colors" && half->unsaid == std::vector<DrawnLook>{{"", "#0000ff"}}));
    else
      CHECK((half.error().reason == ErrorReason::Unclear &&
             half.error().detail.find("#0000ff=") != std::string::npos));
  }
  // Dashed lines are cut as dashes, and may be explained with the others.
  how.profile.colours.clear();
  const auto dashed = linework_from_svg(
      svg(R"x(<g fill="none"><path d="M0 0H1" stroke="#000"/><path d="M0 2H4" stroke="blue"/>
      <path d="M0 1H20" stroke="red" stroke-dasharray="3 2"/></g>)x"),
      how);
  REQUIRE(dashed);
  CHECK(dashed->asks == "colors");
  CHECK(dashed->unsaid ==
        std::vector<DrawnLook>{{"", "#000000"}, {"", "#0000ff"}, {"", "#ff0000"}});
  // Names come before colours, and are asked about before them.
  const std::string named = svg(
      R"x(<g fill="none" stroke="#f00"><g id="Cut"><path d="M0 0H1"/></g>
      <g id="Zunge"><path d="M0 1H2"/></g></g>)x");
  SvgReadOptions names;
  names.profile = *find_stroke_profile("auto");
  names.looks = true;
  const auto layers = linework_from_svg(named, names);
  REQUIRE(layers);
  CHECK(layers->asks == "layers");
  CHECK(layers->unsaid == std::vector<DrawnLook>{{"Zunge", "#ff0000"}});
}

TEST_CASE("what is said of colours is refused in one line where it is none",
          "[core][formats][words][bad]") {
  for (const char* wrong : {"red", "rouge=cut", "=cut", "red=", "red=glue", "colour x=cut"}) {
    CAPTURE(wrong);
    const auto uses = parse_colour_uses(wrong);
    REQUIRE_FALSE(uses);
    CHECK(uses.error().kind == ErrorKind::Usage);
    CHECK(uses.error().place == "/options/colors");
  }
  const auto uses = parse_colour_uses(" colour 30 = score ; red=fold;");
  REQUIRE(uses);
  CHECK(use_of_index(*uses, 30) == LayerMeaning::Score);
  CHECK(use_of_index(*uses, 1) == LayerMeaning::Fold);
  CHECK(use_of_colour(*uses, 0xff0000) == LayerMeaning::Fold);
  CHECK_FALSE(use_of_colour(*uses, 0x0000ff));
}

}  // namespace svg_meaning_test
