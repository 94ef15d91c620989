// SPDX-License-Identifier: MIT
// Pages to print: what stands on them, and their form as PDF.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <pugixml.hpp>

#include "core/formats/svg/svg_reader.hpp"
#include "core/layout/sheet.hpp"
#include "core/print/footer.hpp"
#include "core/print/pages.hpp"
#include "core/text/text_width.hpp"
#include "daemon/pictures/pdf.hpp"
#include "daemon/pictures/pdf_page.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/small_pdf.hpp"
#include "tests/support/value.hpp"

namespace pages_test {

using namespace popcut;

namespace {

Footer full_footer() {
  return {
      {legend_entry(Operation::Cut), legend_entry(Operation::FoldMountain),
       legend_entry(Operation::FoldValley), legend_entry(Operation::Draw), legend_entry_of_tabs()},
      {"a name of some length: sheet 10 of 12, pieces 3, 4, 5",
       "Printed side up: mountain folds rise toward you, valley folds sink away."}};
}

}  // namespace

TEST_CASE("a footer stays within its place at every width", "[core][print]") {
  for (double width = 10.0; width < 400.0; width += 7.0) {
    CAPTURE(width);
    const FooterPlace place{8, 100, width, 23};
    const std::string svg = footer_svg(full_footer(), place);
    const bool fits = footer_height_mm(full_footer(), width) <= place.height;
    if (!fits) CHECK(svg.empty());
    if (svg.empty()) continue;
    pugi::xml_document document;
    REQUIRE(document.load_string(("<svg>" + svg + "</svg>").c_str()));
    for (const auto& found : document.select_nodes("//text")) {
      const pugi::xml_node text = found.node();
      const double x = text.attribute("x").as_double(), y = text.attribute("y").as_double();
      CAPTURE(text.text().get());
      CHECK(x >= place.left);
      CHECK(x + text_width(text.text().get(), 2.8) <= place.left + place.width + 0.01);
      CHECK(y >= place.top);
      CHECK(y <= place.top + place.height);
    }
  }
  // A wide page has all of it, a narrow one a bar that says its length.
  CHECK(footer_svg(full_footer(), {8, 100, 194, 23}).find("glue under") != std::string::npos);
  CHECK(footer_bar({8, 100, 194, 23}).find("100 mm: measure") != std::string::npos);
  CHECK(footer_bar({8, 100, 60, 23}).find("50 mm") != std::string::npos);
  CHECK(footer_bar({8, 100, 30, 23}).find("20 mm") != std::string::npos);
  CHECK(footer_bar({8, 100, 12, 23}).find("10 mm") != std::string::npos);
  CHECK(footer_bar({8, 100, 9, 23}).empty());
}

TEST_CASE("a pattern's page is the sheet at true scale within its margins", "[core][print]") {
  const Pattern pattern = testing::row_of_boxes(3);
  const auto pages = testing::value(pattern_pages(pattern));
  REQUIRE(pages.size() == 1);
  CHECK(pages.front().width_mm == Approx(210 + 2 * kPrintSideMm));
  CHECK(pages.front().height_mm == Approx(70 + kPrintSideMm + kPrintFooterMm));
  CHECK(pages.front().margin_mm == 0.0);
  const auto pdf = testing::value(pdf_of_pages(pages, pattern.name));
  CHECK(pdf.rfind("%PDF-", 0) == 0);
  CHECK(*pdf_of_pages(pages, pattern.name) == pdf);
  CHECK(pdf.find("CreationDate") == std::string::npos);
}

TEST_CASE("nothing below a drawing touches it at any size of paper", "[core][print]") {
  for (const int boxes : {1, 2, 5}) {
    const Pattern pattern = testing::row_of_boxes(boxes);
    const auto pages = testing::value(pattern_pages(pattern));
    pugi::xml_document document;
    REQUIRE(document.load_string(pages.front().svg.c_str()));
    const double lowest = kPrintSideMm + 70;  // of the drawing
    int below = 0;
    for (const auto& found : document.select_nodes("/svg/g/text")) {
      const double size = found.parent().attribute("font-size").as_double();
      CHECK(found.node().attribute("y").as_double() - size > lowest);
      ++below;
    }
    CHECK(below > 0);
  }
}

TEST_CASE("each fold of a page has two dashes or more", "[core][print]") {
  for (const Operation operation : {Operation::FoldMountain, Operation::FoldValley})
    for (double length = 0.2; length < 200.0; length *= 1.1) {
      CAPTURE(length);
      const std::vector<double> dashes = fold_dashes_mm(operation, length);
      REQUIRE(dashes.size() % 2 == 0);
      double at = 0.0, seen = 0.0, drawn = 0.0;
      for (std::size_t k = 0; at < length - 1e-9; k = (k + 1) % dashes.size()) {
        const double part = std::min(dashes[k], length - at);
        if (k % 2 == 0) seen += 1.0, drawn += part;
        at += dashes[k];
      }
      CHECK(seen >= 2.0);
      CHECK(drawn < 0.85 * length);
    }
  // The legend has the look of a long fold; a short one on a page has its own.
  CHECK(legend_entry(Operation::FoldValley).style.find("\"3 1.5\"") != std::string::npos);
  Pattern card = testing::box_card_pattern();
  card.lines.push_back({5, 5, 5, 7, EdgeRole::Mountain});
  const auto pages = testing::value(pattern_pages(card));
  CHECK(pages.front().svg.find("stroke-dasharray=\"0.5 0.5\"") != std::string::npos);
}

TEST_CASE("a sheet larger than a PDF page is refused by name", "[core][print]") {
  const auto pages = pattern_pages(testing::row_of_boxes(73));  // 5110 mm
  REQUIRE_FALSE(pages);
  CHECK(pages.error().kind == ErrorKind::Infeasible);
  CHECK(pages.error().detail.find("5126 x 108 mm") != std::string::npos);
}

TEST_CASE("a name with any bytes gives a valid page", "[core][print]") {
  Pattern pattern = testing::box_card_pattern();
  for (const std::string& name :
       {"(\\ \xc3\xa9 \xff)\n" + std::string(5000, 'x'), std::string("<b>&amp;\"'"),
        std::string("\xe2\x80\xae"
                    "evil"),
        std::string(119, 'a') + "\xe2\x99\xa5", std::string()}) {
    CAPTURE(name);
    pattern.name = name;
    const auto pages = testing::value(pattern_pages(pattern));
    CHECK(pdf_of_pages(pages, name));
  }
}

TEST_CASE("letters that no font has are named", "[core][print]") {
  CHECK(letters_without_font("Für Oma ♥ Ωμέγα Привет\t1").empty());
  CHECK(letters_without_font("a\xf3\xbf\xbf\xbd"
                             "b\xf3\xbf\xbf\xbd\xff") == "\xf3\xbf\xbf\xbd");
}

namespace {

/// Lengths of cuts and folds, mm.
std::pair<double, double> cut_and_fold_mm(const LineWork& work) {
  std::pair<double, double> out;
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    double length = 0;
    for (std::size_t k = 1; k < points.size(); ++k)
      length += std::hypot(points[k].x - points[k - 1].x, points[k].y - points[k - 1].y);
    (is_fold(line.operation.operation) ? out.second : out.first) += length;
  }
  return out;
}

}  // namespace

TEST_CASE("a page of a PDF is a drawing of its size, with its layers by name", "[pictures][pdf]") {
  const std::string page =
      "0.1 w /OC /L0 BDC 72 72 144 144 re S EMC\n"
      "/OC /L1 BDC /OC /L2 BDC 72 144.3 m 216 144.3 l S EMC 90 90 36 36 re S EMC\n"
      "/OC /L3 BDC 0 0 m 288 288 l S EMC\n"
      "1 1 1 rg 0 0 288 288 re f 0 g BT /F 24 Tf 100 100 Td (Hello) Tj ET";
  const std::string pdf =
      testing::small_pdf({page}, {"Cut & out", "Inner \"Cut\"", "Valley Fold", "Notes"}, {3});
  const auto read = testing::value(pictures::pdf_page(pdf, 1));
  for (const char* name : {"Cut &amp; out", "Inner &quot;Cut&quot;", "Valley Fold"})
    CHECK(read.svg.find(fmt::format("inkscape:label=\"{}\"", name)) != std::string::npos);
  CHECK(read.svg.find("Notes") == std::string::npos);
  REQUIRE(read.warnings.size() == 2);
  CHECK(read.warnings[0].message.find("5 letters of text are left out") == 0);
  CHECK(read.warnings[1].message.find("1 white area is left out") == 0);
  SvgReadOptions how;
  how.profile = find_stroke_profile("auto").value();
  const auto drawn = testing::value(linework_from_svg(read.svg, how));
  const auto [cut_mm, fold_mm] = cut_and_fold_mm(drawn);
  CHECK(cut_mm == Approx((4 * 144 + 4 * 36) * 25.4 / 72).margin(0.01));
  CHECK(fold_mm == Approx(144 * 25.4 / 72).margin(0.005));
  const Box box = bounds(drawn);
  CHECK(box.x0 == Approx(25.4).margin(0.002));
  CHECK(box.y1 == Approx(3 * 25.4).margin(0.002));
}

TEST_CASE("what popcut prints as PDF is read again with the same lengths", "[pictures][pdf]") {
  const std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 180 120'><path fill='none' "
      "stroke='#000' stroke-width='.3' d='M10 10H150V90.37H10ZM20 20C40 0 60 80 90 33'/></svg>";
  const auto pdf =
      testing::value(pdf_of_pages(std::vector<PrintedPage>{{svg, 210, 150, 15}}, "a page"));
  const auto read = testing::value(pictures::pdf_page(pdf, 1));
  const auto own = linework_from_svg(svg, SvgProfile::Plain);
  const auto again = linework_from_svg(read.svg, SvgProfile::Plain);
  REQUIRE(own);
  REQUIRE(again);
  // The SVG has no size: its units are px there, and mm on the page.
  CHECK(cut_and_fold_mm(*again).first ==
        Approx(cut_and_fold_mm(*own).first * 96 / 25.4).epsilon(2e-4));
}

TEST_CASE("a PDF that cannot be read says why", "[pictures][pdf]") {
  const auto refused = [](std::string_view pdf, std::uint64_t page, const std::string& part) {
    const auto read = pictures::pdf_page(pdf, page);
    REQUIRE(!read);
    CAPTURE(read.error().detail, part);
    CHECK(read.error().detail.find(part) != std::string::npos);
    return read.error().kind;
  };
  const std::string two = testing::small_pdf({"0 0 m 9 9 l S", "0 0 m 99 9 l S"});
  CHECK(pictures::pdf_page(two, 2)->warnings.front().message.find("page 2 of 2") == 0);
  CHECK(refused(two, 3, "has the pages 1 to 2") == ErrorKind::OutOfRange);
  CHECK(refused(testing::small_pdf({""}), 2, "has one page") == ErrorKind::OutOfRange);
  CHECK(refused("%PDF-1.4 nothing", 1, "cannot be read (") == ErrorKind::Malformed);
  CHECK(refused(std::string_view(two).substr(0, 200), 1, "cannot be read (") ==
        ErrorKind::Malformed);
  const std::string illustrator = testing::small_pdf(
      {"BT /F 9 Tf 9 9 Td (This is an Adobe Illustrator File that was saved without PDF Content.) "
       "Tj ET"});
  CHECK(refused(illustrator, 1, "Create PDF Compatible File") == ErrorKind::Malformed);
}

}  // namespace pages_test
