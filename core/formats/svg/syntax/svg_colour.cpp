// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_colour.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_scan.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

namespace popcut {
namespace {

using Kind = SvgPaint::Kind;

// CSS Color Module Level 4, section 6.1, in alphabetical order.
constexpr std::array<std::pair<std::string_view, std::uint32_t>, 148> kNames{
    {{"aliceblue", 0xf0f8ff},
     {"antiquewhite", 0xfaebd7},
     {"aqua", 0x00ffff},
     {"aquamarine", 0x7fffd4},
     {"azure", 0xf0ffff},
     {"beige", 0xf5f5dc},
     {"bisque", 0xffe4c4},
     {"black", 0x000000},
     {"blanchedalmond", 0xffebcd},
     {"blue", 0x0000ff},
     {"blueviolet", 0x8a2be2},
     {"brown", 0xa52a2a},
     {"burlywood", 0xdeb887},
     {"cadetblue", 0x5f9ea0},
     {"chartreuse", 0x7fff00},
     {"chocolate", 0xd2691e},
     {"coral", 0xff7f50},
     {"cornflowerblue", 0x6495ed},
     {"cornsilk", 0xfff8dc},
     {"crimson", 0xdc143c},
     {"cyan", 0x00ffff},
     {"darkblue", 0x00008b},
     {"darkcyan", 0x008b8b},
     {"darkgoldenrod", 0xb8860b},
     {"darkgray", 0xa9a9a9},
     {"darkgreen", 0x006400},
     {"darkgrey", 0xa9a9a9},
     {"darkkhaki", 0xbdb76b},
     {"darkmagenta", 0x8b008b},
     {"darkolivegreen", 0x556b2f},
     {"darkorange", 0xff8c00},
     {"darkorchid", 0x9932cc},
     {"darkred", 0x8b0000},
     {"darksalmon", 0xe9967a},
     {"darkseagreen", 0x8fbc8f},
     {"darkslateblue", 0x483d8b},
     {"darkslategray", 0x2f4f4f},
     {"darkslategrey", 0x2f4f4f},
     {"darkturquoise", 0x00ced1},
     {"darkviolet", 0x9400d3},
     {"deeppink", 0xff1493},
     {"deepskyblue", 0x00bfff},
     {"dimgray", 0x696969},
     {"dimgrey", 0x696969},
     {"dodgerblue", 0x1e90ff},
     {"firebrick", 0xb22222},
     {"floralwhite", 0xfffaf0},
     {"forestgreen", 0x228b22},
     {"fuchsia", 0xff00ff},
     {"gainsboro", 0xdcdcdc},
     {"ghostwhite", 0xf8f8ff},
     {"gold", 0xffd700},
     {"goldenrod", 0xdaa520},
     {"gray", 0x808080},
     {"green", 0x008000},
     {"greenyellow", 0xadff2f},
     {"grey", 0x808080},
     {"honeydew", 0xf0fff0},
     {"hotpink", 0xff69b4},
     {"indianred", 0xcd5c5c},
     {"indigo", 0x4b0082},
     {"ivory", 0xfffff0},
     {"khaki", 0xf0e68c},
     {"lavender", 0xe6e6fa},
     {"lavenderblush", 0xfff0f5},
     {"lawngreen", 0x7cfc00},
     {"lemonchiffon", 0xfffacd},
     {"lightblue", 0xadd8e6},
     {"lightcoral", 0xf08080},
     {"lightcyan", 0xe0ffff},
     {"lightgoldenrodyellow", 0xfafad2},
     {"lightgray", 0xd3d3d3},
     {"lightgreen", 0x90ee90},
     {"lightgrey", 0xd3d3d3},
     {"lightpink", 0xffb6c1},
     {"lightsalmon", 0xffa07a},
     {"lightseagreen", 0x20b2aa},
     {"lightskyblue", 0x87cefa},
     {"lightslategray", 0x778899},
     {"lightslategrey", 0x778899},
     {"lightsteelblue", 0xb0c4de},
     {"lightyellow", 0xffffe0},
     {"lime", 0x00ff00},
     {"limegreen", 0x32cd32},
     {"linen", 0xfaf0e6},
     {"magenta", 0xff00ff},
     {"maroon", 0x800000},
     {"mediumaquamarine", 0x66cdaa},
     {"mediumblue", 0x0000cd},
     {"mediumorchid", 0xba55d3},
     {"mediumpurple", 0x9370db},
     {"mediumseagreen", 0x3cb371},
     {"mediumslateblue", 0x7b68ee},
     {"mediumspringgreen", 0x00fa9a},
     {"mediumturquoise", 0x48d1cc},
     {"mediumvioletred", 0xc71585},
     {"midnightblue", 0x191970},
     {"mintcream", 0xf5fffa},
     {"mistyrose", 0xffe4e1},
     {"moccasin", 0xffe4b5},
     {"navajowhite", 0xffdead},
     {"navy", 0x000080},
     {"oldlace", 0xfdf5e6},
     {"olive", 0x808000},
     {"olivedrab", 0x6b8e23},
     {"orange", 0xffa500},
     {"orangered", 0xff4500},
     {"orchid", 0xda70d6},
     {"palegoldenrod", 0xeee8aa},
     {"palegreen", 0x98fb98},
     {"paleturquoise", 0xafeeee},
     {"palevioletred", 0xdb7093},
     {"papayawhip", 0xffefd5},
     {"peachpuff", 0xffdab9},
     {"peru", 0xcd853f},
     {"pink", 0xffc0cb},
     {"plum", 0xdda0dd},
     {"powderblue", 0xb0e0e6},
     {"purple", 0x800080},
     {"rebeccapurple", 0x663399},
     {"red", 0xff0000},
     {"rosybrown", 0xbc8f8f},
     {"royalblue", 0x4169e1},
     {"saddlebrown", 0x8b4513},
     {"salmon", 0xfa8072},
     {"sandybrown", 0xf4a460},
     {"seagreen", 0x2e8b57},
     {"seashell", 0xfff5ee},
     {"sienna", 0xa0522d},
     {"silver", 0xc0c0c0},
     {"skyblue", 0x87ceeb},
     {"slateblue", 0x6a5acd},
     {"slategray", 0x708090},
     {"slategrey", 0x708090},
     {"snow", 0xfffafa},
     {"springgreen", 0x00ff7f},
     {"steelblue", 0x4682b4},
     {"tan", 0xd2b48c},
     {"teal", 0x008080},
     {"thistle", 0xd8bfd8},
     {"tomato", 0xff6347},
     {"turquoise", 0x40e0d0},
     {"violet", 0xee82ee},
     {"wheat", 0xf5deb3},
     {"white", 0xffffff},
     {"whitesmoke", 0xf5f5f5},
     {"yellow", 0xffff00},
     {"yellowgreen", 0x9acd32}}};

std::uint32_t pack(double r, double g, double b) {
  const auto byte = [](double v) {
    return static_cast<std::uint32_t>(std::clamp(std::round(v), 0.0, 255.0));
  };
  return byte(r) << 16 | byte(g) << 8 | byte(b);
}

std::optional<SvgPaint> from_hex(std::string_view digits) {
  const std::size_t n = digits.size();
  if (n != 3 && n != 4 && n != 6 && n != 8) return std::nullopt;
  std::uint32_t value = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + n, value, 16);
  if (fault != std::errc{} || end != digits.data() + n) return std::nullopt;
  const bool is_short = n < 6;  // each digit stands twice
  const std::size_t count = is_short ? n : n / 2;
  std::array<std::uint32_t, 4> channels{0, 0, 0, 255};
  for (std::size_t i = 0; i < count; ++i, value = is_short ? value >> 4 : value >> 8)
    channels[count - 1 - i] = is_short ? (value & 15) * 17 : value & 255;
  if (channels[3] == 0) return SvgPaint{};
  return SvgPaint{Kind::Colour, channels[0] << 16 | channels[1] << 8 | channels[2]};
}

// Hue in degrees, the others 0 to 1 (CSS Color 4, section 7.1).
std::uint32_t from_hsl(double hue, double saturation, double lightness) {
  hue = std::fmod(hue, 360.0);
  if (hue < 0) hue += 360.0;
  const double s = std::clamp(saturation, 0.0, 1.0), l = std::clamp(lightness, 0.0, 1.0);
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue / 30, 12.0);
    return 255 * (l - s * std::min(l, 1 - l) * std::max(-1.0, std::min({k - 3, 9 - k, 1.0})));
  };
  return pack(channel(0), channel(8), channel(4));
}

// rgb(255, 0, 0), rgb(100% 0 0 / 50%), hsl(120deg, 100%, 50%) ...
std::optional<SvgPaint> from_function(std::string_view name, std::string_view inside) {
  const bool hsl = name.substr(0, 3) == "hsl";
  SvgScan scan(inside);
  std::array<double, 4> v{0, 0, 0, 1};
  std::size_t count = 0;
  for (; count < 4 && !scan.at_end(); ++count) {
    if (scan.peek() == '/') scan.skip();
    if (!scan.number(v[count])) return std::nullopt;
    const bool percent = scan.peek() == '%';
    if (percent) scan.skip();
    (void)scan.word();  // deg
    if (percent) v[count] /= count == 3 || hsl ? 100.0 : 100.0 / 255.0;
  }
  if (count < 3 || !scan.at_end()) return std::nullopt;
  if (v[3] <= 0.0) return SvgPaint{};
  return SvgPaint{Kind::Colour, hsl ? from_hsl(v[0], v[1], v[2]) : pack(v[0], v[1], v[2])};
}

std::optional<SvgPaint> from_url(std::string_view text) {
  const std::size_t end = text.find(')');
  if (end == std::string_view::npos) return std::nullopt;
  const auto fallback = parse_svg_paint(trimmed(text.substr(end + 1)));
  return SvgPaint{Kind::Server, fallback && fallback->kind == Kind::Colour ? fallback->rgb : 0};
}

}  // namespace

std::optional<SvgPaint> parse_svg_paint(std::string_view text) {
  text = trimmed(text);
  if (text.empty() || text.size() > 4096) return std::nullopt;
  std::string c = lower(text);
  // What a printer makes of the colour follows it (SVG 1.1, section 11.2).
  if (const std::size_t at = c.find(" icc-color("); at != std::string::npos)
    c.resize(trimmed(std::string_view(c).substr(0, at)).size());
  if (c == "none" || c == "transparent") return SvgPaint{};
  if (c[0] == '#') return from_hex(std::string_view(c).substr(1));
  if (c == "currentcolor") return SvgPaint{Kind::Current, 0};
  if (c.rfind("context-", 0) == 0) return SvgPaint{Kind::Server, 0};
  if (c.rfind("url(", 0) == 0) return from_url(c);
  const std::size_t open = c.find('(');
  if (open != std::string::npos) {
    const std::string_view name = std::string_view(c).substr(0, open);
    if (c.back() != ')' || (name != "rgb" && name != "rgba" && name != "hsl" && name != "hsla"))
      return std::nullopt;
    return from_function(name, std::string_view(c).substr(open + 1, c.size() - open - 2));
  }
  const auto found = std::lower_bound(kNames.begin(), kNames.end(), c,
                                      [](const auto& row, const auto& n) { return row.first < n; });
  if (found == kNames.end() || found->first != c) return std::nullopt;
  return SvgPaint{Kind::Colour, found->second};
}

std::string colour_text(std::uint32_t rgb) { return fmt::format("#{:06x}", rgb); }

}  // namespace popcut
