// SPDX-License-Identifier: MIT
#include "core/formats/write/cricut_svg.hpp"

#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

constexpr double kMmPerInch = 25.4;

struct Group {
  std::string_view id;
  std::string_view colour;
  Operation first, last;
};

// One group per colour, in cutting order.
constexpr std::array<Group, 4> kGroups{{
    {"mark", "#00a651", Operation::Draw, Operation::Score},
    {"fold-mountain", "#ff0000", Operation::FoldMountain, Operation::FoldMountain},
    {"fold-valley", "#0000ff", Operation::FoldValley, Operation::FoldValley},
    {"cut", "#000000", Operation::Cut, Operation::Outline},
}};

/// Where the drawing goes on the mat.
struct Placing {
  Box box;
  bool turned{};

  /// Turned clockwise by 90 degrees if needed: a rotation, so nothing is mirrored.
  [[nodiscard]] PagePoint at(const PagePoint& p) const {
    if (turned) return {box.y1 - p.y, p.x - box.x0};
    return {p.x - box.x0, p.y - box.y0};
  }
};

void put_line(TextSink& text, std::span<const PagePoint> points, const Placing& placing) {
  text.put("<path d=\"");
  const bool ring = points.size() > 3 && closed(points);
  const std::size_t count = ring ? points.size() - 1 : points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const PagePoint p = placing.at(points[i]);
    text.put(i == 0 ? "M" : "L");
    text.put_rounded(p.x);
    text.put(",");
    text.put_rounded(p.y);
  }
  text.put(ring ? "Z\"/>\n" : "\"/>\n");
}

void put_group(TextSink& text, const LineWork& dashed, const Group& group, const Placing& placing) {
  bool any = false;
  for (auto operation = group.first; operation <= group.last;
       operation = static_cast<Operation>(static_cast<int>(operation) + 1)) {
    for (const DrawnLine& line : dashed.lines) {
      if (line.operation != operation) continue;
      if (!std::exchange(any, true)) {
        text("<g id=\"", group.id, "\" fill=\"none\" stroke=\"", group.colour,
             "\" stroke-width=\"0.25\">\n");
      }
      put_line(text, dashed.points_of(line), placing);
    }
  }
  if (any) text.put("</g>\n");
}

}  // namespace

Result<void> write_cricut_svg(const LineWork& dashed, const CricutMat& mat, std::ostream& out) {
  const double width = mat.width_in * kMmPerInch, height = mat.height_in * kMmPerInch;
  constexpr double kRounding = 1e-6;
  const Box box = bounds(dashed);
  const auto fits = [&](double x, double y) {
    return box.empty() || (x <= width + kRounding && y <= height + kRounding);
  };
  const bool upright = fits(box.width(), box.height());
  if (!upright && !fits(box.height(), box.width())) {
    return fail(
        ErrorKind::Infeasible, "cricut",
        fmt::format("the drawing is {:.1f} x {:.1f} mm, but the mat holds {:.1f} x {:.1f} mm "
                    "({:g} x {:g} in)",
                    box.width(), box.height(), width, height, mat.width_in, mat.height_in));
  }
  const Placing placing{box, !upright};
  TextSink text(out);
  text.put(svg_head(fmt::format("{} width=\"{}in\" height=\"{}in\" viewBox=\"0 0 {} {}\"", kDashed,
                                mat.width_in, mat.height_in, rounded(width), rounded(height)),
                    dashed.name));
  for (const Group& group : kGroups) put_group(text, dashed, group, placing);
  text.put("</svg>\n");
  return {};
}

}  // namespace popcut
