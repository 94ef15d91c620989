// SPDX-License-Identifier: MIT
#include "core/formats/svg_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "core/formats/svg_path.hpp"
#include "core/formats/svg_scan.hpp"
#include "core/formats/svg_style.hpp"
#include "core/formats/svg_transform.hpp"

namespace popcut {
namespace {

constexpr double kFlatten = 0.02;     // mm between a curve and its chords
constexpr double kPixel = 25.4 / 96;  // mm
constexpr std::size_t kMostBytes = 256u << 20;
constexpr int kMostDeep = 200;
constexpr double kMostDashes = 1e6;  // of one line

std::string place_in(std::string_view text, std::ptrdiff_t offset) {
  const auto at =
      std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)), text.size());
  const std::string_view before = text.substr(0, at);
  const std::size_t newline = before.rfind('\n');
  return fmt::format("line {}, column {}", 1 + std::count(before.begin(), before.end(), '\n'),
                     newline == std::string_view::npos ? at + 1 : at - newline);
}

// A length in mm; percentages and nonsense are none.
std::optional<double> length_mm(std::string_view text, bool& has_unit) {
  SvgScan scan(text);
  double value = 0.0;
  if (!scan.number(value)) return std::nullopt;
  const std::string_view unit = scan.word();
  constexpr std::array<std::pair<std::string_view, double>, 8> kUnits{{{"", kPixel},
                                                                       {"px", kPixel},
                                                                       {"mm", 1.0},
                                                                       {"cm", 10.0},
                                                                       {"in", 25.4},
                                                                       {"pt", 25.4 / 72},
                                                                       {"pc", 25.4 / 6},
                                                                       {"Q", 0.25}}};
  if (!scan.at_end()) return std::nullopt;
  for (const auto& [name, mm] : kUnits)
    if (unit == name) {
      has_unit = has_unit || (unit != "" && unit != "px");
      return value * mm;
    }
  return std::nullopt;
}

class SvgReader {
 public:
  SvgReader(std::string_view text, SvgProfile profile) : text_(text), profile_(profile) {}

  Result<LineWork> read(const pugi::xml_node& root) {
    work_.has_page = true;
    work_.name = root.child_value("title");
    work_.dashed = std::string_view(root.attribute("data-popcut").value()) == "dashes";
    const auto page = page_of(root);
    if (!page) return tl::unexpected(page.error());
    if (auto done = children(root, *page, style_of(root, {}), 0); !done)
      return tl::unexpected(done.error());
    tell();
    return std::move(work_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> wrong(const pugi::xml_node& node, std::string detail,
                                            ErrorKind kind = ErrorKind::Malformed) const {
    return fail(kind, place_in(text_, node.offset_debug() - 1), std::move(detail));
  }

  // User units of the root to mm on the page.
  Result<SvgTransform> page_of(const pugi::xml_node& root) {
    bool has_unit = false;
    const auto width = length_mm(root.attribute("width").value(), has_unit);
    const auto height = length_mm(root.attribute("height").value(), has_unit);
    if (!has_unit)
      work_.warnings.emplace_back(
          "no unit of length is given; 96 user units are taken as one inch");
    const auto box = root.attribute("viewBox");
    if (!box) return SvgTransform{kPixel, 0, 0, kPixel, 0, 0};
    SvgScan scan(box.value());
    std::array<double, 4> v{};
    for (double& value : v)
      if (!scan.number(value)) return wrong(root, "viewBox: four numbers are needed");
    if (!(v[2] > 0.0 && v[3] > 0.0))
      return wrong(root, "viewBox: its width and height must be positive");
    const double sx = (width ? *width : v[2] * kPixel) / v[2];
    const double sy = (height ? *height : v[3] * kPixel) / v[3];
    if (!(sx > 0.0 && sy > 0.0)) return wrong(root, "width and height must be positive");
    if (std::string_view(root.attribute("preserveAspectRatio").value()).substr(0, 4) == "none")
      return SvgTransform{sx, 0, 0, sy, -sx * v[0], -sy * v[1]};
    // xMidYMid meet: one scale for both, the drawing in the middle.
    const double s = !width ? sy : !height ? sx : std::min(sx, sy);
    const double dx = width ? (*width - s * v[2]) / 2 : 0.0;
    const double dy = height ? (*height - s * v[3]) / 2 : 0.0;
    return SvgTransform{s, 0, 0, s, dx - s * v[0], dy - s * v[1]};
  }

  Result<void> children(const pugi::xml_node& parent, const SvgTransform& transform,
                        const SvgStyle& style, int depth) {
    if (depth > kMostDeep)
      return wrong(parent, fmt::format("groups more than {} deep", kMostDeep),
                   ErrorKind::OutOfRange);
    for (const pugi::xml_node& node : parent.children()) {
      if (node.type() != pugi::node_element) continue;
      if (auto done = element(node, transform, style, depth); !done) return done;
    }
    return {};
  }

  Result<void> element(const pugi::xml_node& node, const SvgTransform& outer,
                       const SvgStyle& inherited, int depth) {
    static const std::set<std::string_view> kGroups{"g", "a", "switch"};
    static const std::set<std::string_view> kSilent{
        "defs",   "title",   "desc",           "metadata",       "symbol", "clipPath", "mask",
        "marker", "pattern", "linearGradient", "radialGradient", "filter", "script"};
    static const std::set<std::string_view> kShapes{"path",    "line",   "rect",   "polyline",
                                                    "polygon", "circle", "ellipse"};
    std::string_view name = node.name();
    if (name.rfind("svg:", 0) == 0) name.remove_prefix(4);
    if (kSilent.count(name) > 0 || name.find(':') != std::string_view::npos) return {};
    if (name == "style") {
      classes_ = true;
      return {};
    }
    if (kGroups.count(name) == 0 && kShapes.count(name) == 0) {
      ++unread_[std::string(name.substr(0, 30))];
      return {};
    }
    const SvgStyle style = style_of(node, inherited);
    if (style.display_none) return {};
    SvgTransform transform = outer;
    if (const auto attribute = node.attribute("transform")) {
      const auto own = parse_svg_transform(attribute.value());
      if (!own) return wrong(node, "the transform cannot be read");
      transform = outer * *own;
    }
    if (kGroups.count(name) > 0) return children(node, transform, style, depth + 1);
    return shape(node, name, transform, style);
  }

  Result<void> shape(const pugi::xml_node& node, std::string_view name,
                     const SvgTransform& transform, const SvgStyle& style) {
    if (style.hidden) return {};
    if (style.stroke == "none" || style.stroke == "transparent") {
      if (style.fill != "none") ++only_filled_;
      return {};
    }
    const auto operation = operation_of(style, profile_);
    if (!operation) {
      ++left_out_;
      return {};
    }
    const double scale = transform.largest_scale();
    if (!std::isfinite(scale))
      return wrong(node, "the transform is too large", ErrorKind::OutOfRange);
    if (!(scale > 0.0)) return {};
    auto lines = outline(node, name, kFlatten / scale);
    if (!lines) return tl::unexpected(lines.error());
    for (const auto& line : *lines)
      if (auto done = add(node, line, transform, style, *operation); !done) return done;
    return {};
  }

  Result<void> add(const pugi::xml_node& node, const std::vector<PagePoint>& line,
                   const SvgTransform& transform, const SvgStyle& style, Operation operation) {
    if (style.dashes.empty() || is_fold(operation) || operation == Operation::Score)
      return append(node, line, transform, operation);
    const double period = std::accumulate(style.dashes.begin(), style.dashes.end(), 0.0);
    if (length(line) / period * static_cast<double>(style.dashes.size()) > kMostDashes)
      return wrong(node, "the dashes are too fine for this line", ErrorKind::OutOfRange);
    ++dashed_;
    for (const auto& dash : dashed_by_style(line, style, static_cast<std::size_t>(kMostDashes)))
      if (auto done = append(node, dash, transform, operation); !done) return done;
    return {};
  }

  Result<void> append(const pugi::xml_node& node, const std::vector<PagePoint>& line,
                      const SvgTransform& transform, Operation operation) {
    if (line.size() < 2) return {};
    if (work_.points.size() + line.size() > kMaxDrawnPoints)
      return wrong(node, fmt::format("the drawing has more than {} points", kMaxDrawnPoints),
                   ErrorKind::OutOfRange);
    std::vector<PagePoint> page;
    page.reserve(line.size());
    for (const PagePoint& p : line) {
      page.push_back(transform(p));
      if (!(std::abs(page.back().x) <= kMaxCoordinate && std::abs(page.back().y) <= kMaxCoordinate))
        return wrong(node, "lies more than 100 m from the origin", ErrorKind::OutOfRange);
    }
    if (line.front() == line.back()) page.back() = page.front();
    work_.append(operation, page);
    return {};
  }

  // A number of an attribute in user units, `otherwise` if it is not there.
  Result<double> number(const pugi::xml_node& node, const char* name,
                        double otherwise = 0.0) const {
    const auto attribute = node.attribute(name);
    if (!attribute) return otherwise;
    bool has_unit = false;
    const auto mm = length_mm(attribute.value(), has_unit);
    if (!mm) return wrong(node, fmt::format("{} is not a length", name));
    return *mm / kPixel;
  }

  Result<SvgLines> outline(const pugi::xml_node& node, std::string_view name,
                           double tolerance) const {
    if (name == "path") {
      auto lines = parse_svg_path(node.attribute("d").value(), tolerance, kMaxDrawnPoints);
      if (!lines) return wrong(node, lines.error().detail, lines.error().kind);
      return lines;
    }
    if (name == "polyline" || name == "polygon") return points(node, name == "polygon");
    std::array<double, 6> v{};
    const std::array<const char*, 6> names =
        name == "line"     ? std::array{"x1", "y1", "x2", "y2", "", ""}
        : name == "rect"   ? std::array{"x", "y", "width", "height", "rx", "ry"}
        : name == "circle" ? std::array{"cx", "cy", "r", "r", "", ""}
                           : std::array{"cx", "cy", "rx", "ry", "", ""};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const auto value = number(node, names[i], i >= 4 ? -1.0 : 0.0);
      if (!value) return tl::unexpected(value.error());
      v[i] = *value;
    }
    SvgPen pen(tolerance);
    if (name == "line") {
      pen.move({v[0], v[1]});
      pen.line({v[2], v[3]});
    } else if (name == "rect") {
      rectangle(pen, v);
    } else if (v[2] > 0.0 && v[3] > 0.0) {
      pen.move({v[0] + v[2], v[1]});
      pen.arc(v[2], v[3], 0, false, true, {v[0] - v[2], v[1]});
      pen.arc(v[2], v[3], 0, false, true, {v[0] + v[2], v[1]});
    }
    return pen.take();
  }

  static void rectangle(SvgPen& pen, const std::array<double, 6>& v) {
    const auto [x, y, w, h, rx_given, ry_given] = v;
    if (!(w > 0.0 && h > 0.0)) return;
    const double rx = std::clamp(rx_given < 0 ? ry_given : rx_given, 0.0, w / 2);
    const double ry = std::clamp(ry_given < 0 ? rx_given : ry_given, 0.0, h / 2);
    const bool round = rx > 0.0 && ry > 0.0;
    const auto corner = [&](const PagePoint& to) {
      if (round) pen.arc(rx, ry, 0, false, true, to);
    };
    const double ox = round ? rx : 0.0, oy = round ? ry : 0.0;
    pen.move({x + ox, y});
    pen.line({x + w - ox, y});
    corner({x + w, y + oy});
    pen.line({x + w, y + h - oy});
    corner({x + w - ox, y + h});
    pen.line({x + ox, y + h});
    corner({x, y + h - oy});
    pen.line({x, y + oy});
    corner({x + ox, y});
    pen.close();
  }

  Result<SvgLines> points(const pugi::xml_node& node, bool is_closed) const {
    SvgScan scan(node.attribute("points").value());
    std::vector<PagePoint> line;
    while (scan.number_follows()) {
      PagePoint p;
      if (!scan.number(p.x) || !scan.number(p.y))
        return wrong(node, "points: pairs of numbers are needed");
      line.push_back(p);
    }
    if (!scan.at_end()) return wrong(node, "points: pairs of numbers are needed");
    if (is_closed && line.size() > 1 && line.front() != line.back()) line.push_back(line.front());
    return SvgLines{std::move(line)};
  }

  void tell() {
    for (const auto& [name, count] : unread_)
      work_.warnings.push_back(
          fmt::format("{} <{}> cannot be read and {} left out; turn {} into paths", count, name,
                      count == 1 ? "is" : "are", count == 1 ? "it" : "them"));
    const auto say = [&](std::size_t count, const char* what) {
      if (count > 0) work_.warnings.push_back(fmt::format("{} {}", count, what));
    };
    say(only_filled_, "shapes have a fill but no stroke; only strokes are cut");
    say(left_out_, "strokes are for nothing that is cut or folded and are left out");
    say(dashed_, "lines are dashed by their style and are cut as those dashes");
    if (classes_)
      work_.warnings.emplace_back("style sheets (<style>) are not read; only attributes count");
  }

  std::string_view text_;
  SvgProfile profile_;
  LineWork work_;
  std::map<std::string, std::size_t> unread_;
  std::size_t only_filled_{}, left_out_{}, dashed_{};
  bool classes_{false};
};

}  // namespace

Result<SvgProfile> parse_svg_profile(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, SvgProfile>, 5> kProfiles{
      {{"popcut", SvgProfile::Popcut},
       {"origami-sim", SvgProfile::OrigamiSim},
       {"lightburn", SvgProfile::Lightburn},
       {"cricut", SvgProfile::Cricut},
       {"plain", SvgProfile::Plain}}};
  for (const auto& [known, profile] : kProfiles)
    if (name == known) return profile;
  return fail(ErrorKind::Usage, "--svg-profile",
              fmt::format("{} is not known; one of popcut, origami-sim, lightburn, cricut, plain",
                          name.substr(0, 40)));
}

Result<LineWork> linework_from_svg(std::string_view text, SvgProfile profile) {
  if (text.size() > kMostBytes)
    return fail(ErrorKind::Malformed, "",
                fmt::format("{} bytes of SVG; at most {} are read", text.size(), kMostBytes));
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    return fail(ErrorKind::Malformed, place_in(text, parsed.offset),
                fmt::format("not XML: {}", parsed.description()));
  pugi::xml_node root = document.child("svg");
  if (!root) root = document.child("svg:svg");
  if (!root)
    return fail(ErrorKind::Malformed, "line 1, column 1",
                "no <svg> at the top; is this an SVG file?");
  return SvgReader(text, profile).read(root);
}

}  // namespace popcut
