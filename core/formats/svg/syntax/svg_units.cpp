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
                                           {"rem", Unit::User, 16.0}}};

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

double user_units(const SvgLength& length, const SvgMeasure& measure) {
  switch (length.unit) {
    case Unit::User:
      break;
    case Unit::Mm:
      return length.value / measure.user_mm;
    case Unit::Percent:
      return length.value / 100.0 * measure.whole;
    case Unit::Em:
      return length.value * measure.font;
  }
  return length.value;
}

}  // namespace popcut
