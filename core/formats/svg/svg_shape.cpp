// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_scan.hpp"

namespace popcut {
namespace {

constexpr double kAuto = -1.0;

class Outliner {
 public:
  Outliner(const pugi::xml_node& node, const SvgOutlining& how, SvgLines& lines)
      : node_(node), how_(how), pen_(how.tolerance, lines, how.closes) {}

  Result<void> line() {
    const double x1 = along_x("x1"), y1 = along_y("y1"), x2 = along_x("x2"), y2 = along_y("y2");
    if (error_) return tl::unexpected(*error_);
    pen_.move({x1, y1});
    pen_.line({x2, y2});
    pen_.finish();
    return {};
  }

  Result<void> rectangle() {
    const double x = along_x("x"), y = along_y("y"), w = along_x("width"), h = along_y("height");
    double rx = along_x("rx", kAuto), ry = along_y("ry", kAuto);
    if (error_) return tl::unexpected(*error_);
    if (!(w > 0.0 && h > 0.0)) return {};
    if (rx < 0.0) rx = ry;
    if (ry < 0.0) ry = rx;
    rx = std::clamp(rx, 0.0, w / 2);
    ry = std::clamp(ry, 0.0, h / 2);
    const bool round = rx > 0.0 && ry > 0.0;
    const double ox = round ? rx : 0.0, oy = round ? ry : 0.0;
    const auto side = [&](const PagePoint& to, const PagePoint& past_corner) {
      if (pen_.at() != to) pen_.line(to);
      if (round) pen_.arc(rx, ry, 0, false, true, past_corner);
    };
    pen_.move({x + ox, y});
    side({x + w - ox, y}, {x + w, y + oy});
    side({x + w, y + h - oy}, {x + w - ox, y + h});
    side({x + ox, y + h}, {x, y + h - oy});
    side({x, y + oy}, {x + ox, y});
    pen_.close();
    return {};
  }

  Result<void> ellipse(bool is_circle) {
    const double cx = along_x("cx"), cy = along_y("cy");
    const double all = frame_diagonal(how_.frame);
    double rx = is_circle ? number("r", 0.0, all) : along_x("rx", kAuto);
    double ry = is_circle ? rx : along_y("ry", kAuto);
    if (error_) return tl::unexpected(*error_);
    if (rx < 0.0) rx = ry;
    if (ry < 0.0) ry = rx;
    if (!(rx > 0.0 && ry > 0.0)) return {};
    pen_.move({cx + rx, cy});
    pen_.arc(rx, ry, 0, false, true, {cx - rx, cy});
    pen_.arc(rx, ry, 0, false, true, {cx + rx, cy});
    pen_.finish();
    return {};
  }

  Result<void> points(bool is_closed) {
    const std::string_view text = node_.attribute("points").value();
    SvgScan scan(text);
    bool first = true;
    while (scan.number_follows()) {
      PagePoint p;
      if (!scan.number(p.x) || !scan.number(p.y)) return wrong_points(scan, text);
      if (first)
        pen_.move(p);
      else
        pen_.line(p);
      first = false;
    }
    if (!scan.at_end()) return wrong_points(scan, text);
    if (is_closed)
      pen_.close();
    else
      pen_.finish();
    return {};
  }

 private:
  static tl::unexpected<Error> wrong_points(const SvgScan& scan, std::string_view text) {
    return fail(ErrorKind::Malformed, "",
                fmt::format("points: must be pairs of numbers; see character {} of {}",
                            scan.position() + 1, text.size()));
  }
  double number(const char* name, double otherwise, double whole) {
    const auto value = svg_attribute(node_, name, otherwise, {how_.user_mm, whole, how_.font});
    if (value) return *value;
    if (!error_) error_ = value.error();
    return 0.0;
  }
  double along_x(const char* name, double otherwise = 0.0) {
    return number(name, otherwise, how_.frame.width);
  }
  double along_y(const char* name, double otherwise = 0.0) {
    return number(name, otherwise, how_.frame.height);
  }

  const pugi::xml_node& node_;
  const SvgOutlining& how_;
  SvgPen pen_;
  std::optional<Error> error_;
};

}  // namespace

double frame_diagonal(const SvgFrame& frame) {
  return std::hypot(frame.width, frame.height) / std::sqrt(2.0);
}

bool is_svg_shape(std::string_view name) {
  constexpr std::array<std::string_view, 7> kShapes{"path",    "line",   "rect",   "polyline",
                                                    "polygon", "circle", "ellipse"};
  return std::find(kShapes.begin(), kShapes.end(), name) != kShapes.end();
}

Result<double> svg_attribute(const pugi::xml_node& node, const char* name, double otherwise,
                             const SvgMeasure& measure) {
  const auto attribute = node.attribute(name);
  if (!attribute) return otherwise;
  const std::string_view text = trimmed(attribute.value());
  if (text == "auto") return otherwise;
  const auto length = parse_svg_length(text);
  if (!length)
    return fail(ErrorKind::Malformed, "",
                fmt::format("{} is \"{}\"; write a length such as 12, 12mm or 5%", name,
                            text.substr(0, 40)));
  return user_units(*length, measure);
}

Result<void> outline_of(const pugi::xml_node& node, std::string_view name, std::string_view d,
                        const SvgOutlining& how, SvgLines& lines) {
  if (name == "path") return read_svg_path(d, how.tolerance, how.most_points, lines, how.closes);
  Outliner outliner(node, how, lines);
  if (name == "line") return outliner.line();
  if (name == "rect") return outliner.rectangle();
  if (name == "circle" || name == "ellipse") return outliner.ellipse(name == "circle");
  return outliner.points(name == "polygon");
}

}  // namespace popcut
