// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_units.hpp"

#include <algorithm>
#include <array>

#include "core/formats/svg/syntax/svg_scan.hpp"

namespace popcut {
namespace {

struct UnitName {
  std::string_view name;
  SvgLength::Unit unit;
  double factor;
};
using Unit = SvgLength::Unit;
constexpr std::array<UnitName, 12> kUnits{{{"", Unit::User, 1.0},
                                           {"px", Unit::User, 1.0},
                                           {"mm", Unit::Mm, 1.0},
                                           {"cm", Unit::Mm, 10.0},
                                           {"in", Unit::Mm, 25.4},
                                           {"pt", Unit::Mm, 25.4 / 72},
                                           {"pc", Unit::Mm, 25.4 / 6},
                                           {"q", Unit::Mm, 0.25},
                                           {"%", Unit::Percent, 1.0},
                                           {"em", Unit::Em, 1.0},
                                           {"ex", Unit::Em, 0.5},
                                           {"rem", Unit::Rem, 1.0}}};

}  // namespace

std::optional<SvgLength> parse_svg_length(std::string_view text) {
  text = trimmed(text);
  if (text.empty() || text.front() == ',') return std::nullopt;
  SvgScan scan(text);
  SvgLength length;
  if (!scan.number(length.value)) return std::nullopt;
  const std::string_view unit = text.substr(scan.position());
  for (const UnitName& known : kUnits)
    if (same_word(unit, known.name)) {
      length.value *= known.factor;
      length.unit = known.unit;
      return length;
    }
  return std::nullopt;
}

std::optional<SvgLength> parse_svg_font_size(std::string_view text) {
  // As browsers have them.
  static constexpr std::array<UnitName, 11> kWords{{{"xx-small", Unit::User, 9.0},
                                                    {"x-small", Unit::User, 10.0},
                                                    {"small", Unit::User, 13.0},
                                                    {"medium", Unit::User, 16.0},
                                                    {"large", Unit::User, 18.0},
                                                    {"x-large", Unit::User, 24.0},
                                                    {"xx-large", Unit::User, 32.0},
                                                    {"xxx-large", Unit::User, 48.0},
                                                    {"smaller", Unit::Em, 1 / 1.2},
                                                    {"larger", Unit::Em, 1.2},
                                                    {"math", Unit::Em, 1.0}}};
  text = trimmed(text);
  for (const UnitName& word : kWords)
    if (same_word(text, word.name)) return SvgLength{word.factor, word.unit};
  return parse_svg_length(text);
}

std::optional<SvgLength> font_size_of_shorthand(std::string_view text) {
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    std::string_view word = take_word(text, kBlanks);
    word = word.substr(0, word.find('/'));
    double weight = 0.0;
    if (read_number(word, weight)) continue;  // a size has a unit
    if (const auto size = parse_svg_font_size(word)) return size;
  }
  return std::nullopt;
}

double user_units(const SvgLength& length, const SvgMeasure& measure) {
  switch (length.unit) {
    case Unit::User:
      break;
    case Unit::Mm:
      return length.value / measure.user_mm;
    case Unit::Percent:
      return length.value / 100.0 * measure.whole;
    case Unit::Em:
      return length.value * measure.font.own;
    case Unit::Rem:
      return length.value * measure.font.root;
  }
  return length.value;
}

}  // namespace popcut
