// SPDX-License-Identifier: MIT
#include "core/design/outline/drawing_outline.hpp"

#include <algorithm>
#include <cmath>

#include "core/drawing/linework.hpp"
#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"

namespace popcut {
namespace {

constexpr double kClosed = 1e-4;  // of the drawing's size: ends that are as near as this meet

bool is_svg(const std::string& bytes) {
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return first != std::string::npos && bytes[first] == '<';
}

}  // namespace

Result<std::vector<Area>> drawing_areas(const std::string& bytes, std::optional<double> height) {
  auto work =
      is_svg(bytes) ? linework_from_svg(bytes, SvgProfile::Plain) : linework_from_dxf(bytes);
  if (!work) return tl::unexpected(work.error());
  const Box size = bounds(*work);
  const double near = kClosed * std::max(size.width(), size.height());
  std::vector<Ring> rings;
  Eigen::AlignedBox2d box;
  for (const DrawnLine& line : work->lines) {
    const auto points = work->points_of(line);
    const double dx = points.front().x - points.back().x, dy = points.front().y - points.back().y;
    if (points.size() < 3 || !(std::hypot(dx, dy) <= near)) continue;
    Ring& ring = rings.emplace_back();
    for (const PagePoint& p : points) {
      ring.emplace_back(p.x, -p.y);
      box.extend(ring.back());
    }
  }
  if (rings.empty() && !work->warnings.empty())
    return fail(ErrorKind::Infeasible, "",
                "has no closed line with an area: " + work->warnings.front().message);
  const double drawn = box.isEmpty() ? 0.0 : box.sizes().y();
  const double scale = height && drawn > 0.0 ? *height / drawn : 1.0;
  for (Ring& ring : rings)
    for (Vec2& p : ring) p = (p - box.min()) * scale;
  return areas_within(rings, FillRule::EvenOdd);
}

}  // namespace popcut
