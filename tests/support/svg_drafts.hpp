// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/formats/svg/svg_profile.hpp"
#include "core/formats/svg/svg_reader.hpp"

namespace popcut::testing {

/// Small SVG drawings on a page of 100 x 100 mm, and how they are read.
inline constexpr const char* kPage = R"x(width="100mm" height="100mm" viewBox="0 0 100 100")x";

inline std::string svg(const std::string& inner, const std::string& head = kPage) {
  return R"x(<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="l" xmlns:inkscape="i" )x" + head +
         ">" + inner + "</svg>";
}

inline LineWork read(const std::string& text, const char* profile = "popcut") {
  SvgReadOptions how;
  const auto found = find_stroke_profile(profile);
  INFO((found ? "" : message(found.error())));
  REQUIRE(found);
  how.profile = *found;
  const auto work = linework_from_svg(text, how);
  INFO((work ? "" : message(work.error())));
  REQUIRE(work);
  return *work;
}

inline Error error_of(const std::string& text, SvgLimits limits = {}) {
  SvgReadOptions how;
  how.profile = *find_stroke_profile("popcut");
  how.limits = limits;
  const auto work = linework_from_svg(text, how);
  REQUIRE_FALSE(work);
  CHECK(work.error().detail.find('\n') == std::string::npos);
  return work.error();
}

inline bool is_told(const LineWork& work, const std::string& part) {
  return std::any_of(work.warnings.begin(), work.warnings.end(), [&](const Warning& warning) {
    return warning.message.find(part) != std::string::npos;
  });
}

// The x of both ends of each line.
inline std::vector<double> spans(const LineWork& work) {
  std::vector<double> out;
  for (const DrawnLine& line : work.lines) {
    out.push_back(work.points_of(line).front().x);
    out.push_back(work.points_of(line).back().x);
  }
  return out;
}

inline void check_spans(const LineWork& work, const std::vector<double>& expected) {
  const std::vector<double> got = spans(work);
  CAPTURE(got);
  REQUIRE(got.size() == expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) CHECK(got[i] == Approx(expected[i]).margin(1e-9));
}

}  // namespace popcut::testing
