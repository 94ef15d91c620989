// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/formats/svg/syntax/svg_scan.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"
#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

std::optional<SvgTransform> one_of(std::string_view name, std::span<const double> v) {
  const std::size_t n = v.size();
  if (name == "matrix" && n == 6) return SvgTransform{v[0], v[1], v[2], v[3], v[4], v[5]};
  if (name == "translate" && (n == 1 || n == 2))
    return SvgTransform{1, 0, 0, 1, v[0], n == 2 ? v[1] : 0};
  if (name == "scale" && (n == 1 || n == 2))
    return SvgTransform{v[0], 0, 0, n == 2 ? v[1] : v[0], 0, 0};
  if (name == "skewX" && n == 1) return SvgTransform{1, 0, std::tan(radians(v[0])), 1, 0, 0};
  if (name == "skewY" && n == 1) return SvgTransform{1, std::tan(radians(v[0])), 0, 1, 0, 0};
  if (name == "rotate" && (n == 1 || n == 3)) {
    const double c = std::cos(radians(v[0])), s = std::sin(radians(v[0]));
    const double x = n == 3 ? v[1] : 0, y = n == 3 ? v[2] : 0;
    return SvgTransform{c, s, -s, c, x - c * x + s * y, y - s * x - c * y};
  }
  return std::nullopt;
}

// The fraction of the spare room that lies before the drawing: Min, Mid or Max.
std::optional<double> share(std::string_view word) {
  if (word == "Min") return 0.0;
  if (word == "Mid") return 0.5;
  if (word == "Max") return 1.0;
  return std::nullopt;
}

std::string_view next_word(std::string_view& text) {
  text = trimmed(text);
  return take_word(text, kBlanks);
}

}  // namespace

SvgTransform SvgTransform::operator*(const SvgTransform& m) const {
  return {a * m.a + c * m.b, b * m.a + d * m.b,     a * m.c + c * m.d,
          b * m.c + d * m.d, a * m.e + c * m.f + e, b * m.e + d * m.f + f};
}

std::optional<SvgTransform> SvgTransform::inverse() const {
  const double det = a * d - b * c;
  if (!std::isfinite(det) || !(std::abs(det) > 1e-14 * (a * a + b * b + c * c + d * d)))
    return std::nullopt;
  return SvgTransform{
      d / det, -b / det, -c / det, a / det, (c * f - d * e) / det, (b * e - a * f) / det};
}

double SvgTransform::largest_scale() const {
  const double sum = a * a + b * b + c * c + d * d;
  const double det = a * d - b * c;
  return std::sqrt((sum + std::sqrt(std::max(0.0, sum * sum - 4 * det * det))) / 2);
}

std::optional<SvgTransform> parse_svg_transform(std::string_view text) {
  SvgTransform all;
  SvgScan scan(text);
  if (trimmed(text) == "none") return all;
  while (!scan.at_end()) {
    const std::string_view name = scan.word();
    if (scan.peek() != '(') return std::nullopt;
    scan.skip();
    std::array<double, 6> values{};
    std::size_t count = 0;
    while (scan.number_follows()) {
      if (count == values.size() || !scan.number(values[count])) return std::nullopt;
      ++count;
      const std::string_view unit = scan.peek() == ')' ? std::string_view{} : scan.word();
      if (!unit.empty() && unit != "deg" && unit != "px") return std::nullopt;
    }
    if (scan.peek() != ')') return std::nullopt;
    scan.skip();
    const auto next = one_of(name, std::span(values).first(count));
    if (!next) return std::nullopt;
    all = all * *next;
    if (scan.peek() == ',') scan.skip();
  }
  return all;
}

std::optional<std::array<double, 4>> parse_svg_view_box(std::string_view text) {
  SvgScan scan(text);
  std::array<double, 4> box{};
  for (double& value : box)
    if (!scan.number(value)) return std::nullopt;
  if (!scan.at_end()) return std::nullopt;
  return box;
}

SvgTransform fit_svg_view_box(const std::array<double, 4>& box, double width, double height,
                              std::string_view aspect) {
  std::string_view align = next_word(aspect);
  if (align == "defer") align = next_word(aspect);
  double sx = width / box[2], sy = height / box[3];
  double before_x = 0.5, before_y = 0.5;
  if (align != "none") {
    if (align.size() == 8 && align[0] == 'x' && align[4] == 'Y') {
      before_x = share(align.substr(1, 3)).value_or(0.5);
      before_y = share(align.substr(5, 3)).value_or(0.5);
    }
    sx = sy = next_word(aspect) == "slice" ? std::max(sx, sy) : std::min(sx, sy);
  }
  return {sx,
          0,
          0,
          sy,
          (width - sx * box[2]) * before_x - sx * box[0],
          (height - sy * box[3]) * before_y - sy * box[1]};
}

}  // namespace popcut
