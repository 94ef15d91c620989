// SPDX-License-Identifier: MIT
#include <string>

#include <catch2/catch.hpp>

#include "daemon/pictures/png.hpp"

namespace png_test {

using namespace popcut;

TEST_CASE("a drawing becomes the same pixels each time, on white", "[daemon][picture]") {
  const std::string svg =
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="20mm" viewBox="0 0 30 20">)"
      R"(<rect x="3" y="2" width="9" height="7" fill="#123456"/></svg>)";
  const auto png = png_of_svg(svg, 300);
  REQUIRE(png);
  CHECK(png->substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(png->substr(16, 8) == std::string("\0\0\x01\x2c\0\0\0\xc8", 8));  // 300 x 200
  CHECK(png->substr(24, 2) == "\x08\x02");                                // RGB without alpha
  CHECK(*png_of_svg(svg, 300) == *png);
  CHECK(*png_of_svg(svg, 150) != *png);
}

TEST_CASE("what is no drawing is refused and not drawn", "[daemon][picture]") {
  for (const char* text : {"", "<svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>", "not xml"}) {
    CAPTURE(text);
    const auto png = png_of_svg(text, 100);
    REQUIRE_FALSE(png);
    CHECK(png.error().kind == ErrorKind::Internal);
    CHECK_FALSE(png.error().detail.empty());
  }
}

}  // namespace png_test
