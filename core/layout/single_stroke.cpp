// SPDX-License-Identifier: MIT
// Part of core/layout/marks.hpp.
#include <array>

#include "core/layout/marks.hpp"

namespace popcut {
namespace {

constexpr double kColumns = 4, kRows = 6,
                 kAdvance = 6;  // of the raster of a glyph, with the space after it
constexpr double kBar = 1.5;    // raster steps below the baseline

struct Glyph {
  char name;
  std::string_view strokes;  // column and row from the lower left; a space lifts the pen
};

// Drawn for popcut on a raster of 4 x 6, with straight strokes only.
constexpr std::array<Glyph, 45> kGlyphs{{
    {'0', "010516364541301001 0145"},
    {'1', "152620 1030"},
    {'2', "0516364544000040"},
    {'3', "0516364544331333 42413010"},
    {'4', "360242 3530"},
    {'5', "460603344341301001"},
    {'6', "4536160501103041423303"},
    {'7', "064620"},
    {'8', "133344453616050413 1302011030414233"},
    {'9', "011030414536160504133343"},
    {'A', "0004264440 0343"},
    {'B', "00063645443303 3342413000"},
    {'C', "4536160501103041"},
    {'D', "00062644422000"},
    {'E', "46060040 0333"},
    {'F', "460600 0333"},
    {'G', "453616050110304143 2343"},
    {'H', "0006 4640 0343"},
    {'I', "1636 2620 1030"},
    {'J', "464130 1001"},
    {'K', "0006 460240 0203"},
    {'L', "060040"},
    {'M', "0006234640"},
    {'N', "00064046"},
    {'O', "010516364541301001"},
    {'P', "00063645443303"},
    {'Q', "010516364541301001 2240"},
    {'R', "00063645443303 2340"},
    {'S', "453616050413334241301001"},
    {'T', "0646 2620"},
    {'U', "060110304146"},
    {'V', "062046"},
    {'W', "0610233046"},
    {'X', "0046 0640"},
    {'Y', "062346 2320"},
    {'Z', "06460040"},
    {'-', "1333"},
    {'.', "2021"},
    {',', "2110"},
    {':', "2122 2425"},
    {'/', "0046"},
    {'(', "36252130"},
    {')', "16252110"},
    {'\'', "2625"},
    {'"', "1615 3635"},
}};

const Glyph* glyph(char name) {
  for (const Glyph& g : kGlyphs)
    if (g.name == name) return &g;
  return nullptr;
}

}  // namespace

std::vector<std::vector<PagePoint>> single_stroke(std::string_view text, double height_mm) {
  const double unit = height_mm / kRows;
  std::vector<std::vector<PagePoint>> lines;
  double left = 0.0;
  for (const char c : text) {
    if (const Glyph* g = glyph(c)) {
      std::vector<PagePoint> line;
      const auto lift = [&] {
        if (line.size() > 1) lines.push_back(line);
        line.clear();
      };
      std::string_view rest = g->strokes;
      while (rest.size() > 1) {
        if (rest[0] == ' ') {
          lift();
          rest.remove_prefix(1);
          continue;
        }
        const PagePoint p{(left + (rest[0] - '0')) * unit, -(rest[1] - '0') * unit};
        if (line.empty() || line.back() != p) line.push_back(p);
        rest.remove_prefix(2);
      }
      lift();
    }
    left += kAdvance;
  }
  if (left > 0.0)
    lines.push_back({{0.0, kBar * unit}, {(left - kAdvance + kColumns) * unit, kBar * unit}});
  return lines;
}

PagePoint single_stroke_size(std::string_view text, double height_mm) {
  if (text.empty()) return {};
  const double unit = height_mm / kRows;
  return {(kAdvance * static_cast<double>(text.size()) - kAdvance + kColumns) * unit,
          height_mm + kBar * unit};
}

}  // namespace popcut
