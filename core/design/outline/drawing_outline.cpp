// SPDX-License-Identifier: MIT
#include "core/design/outline/drawing_outline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/gzip.hpp"
#include "core/text/utf8.hpp"

namespace popcut {
namespace {

constexpr double kClosed = 1e-4;  // of the drawing's size: ends that are as near as this meet

bool is_svg(const std::string& bytes) {
  std::string kept;
  const std::string_view text = plain_text(bytes, kept);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return is_gzip(bytes) || (first != std::string_view::npos && text[first] == '<');
}

constexpr Operation kSolid = Operation::Cut, kWhite = Operation::Draw, kPage = Operation::Outline;

/// @param enlarged  times that the drawing becomes larger afterwards, at least 1
Result<LineWork> drawing_of(const std::string& bytes, double enlarged) {
  if (!is_svg(bytes)) {
    if (const std::string_view kind = foreign_kind(bytes); !kind.empty())
      return fail(ErrorKind::Malformed, "", fmt::format("is {}; give an SVG or DXF drawing", kind));
    DxfOptions options;
    options.tolerance_mm /= enlarged;
    return linework_from_dxf(bytes, options);
  }
  auto plain = find_stroke_profile(svg_profile_name(SvgProfile::Plain));
  if (!plain) return tl::unexpected(plain.error());
  SvgReadOptions how;
  how.profile = std::move(*plain);
  how.enlarged = enlarged;
  how.tolerance_mm /= enlarged;
  how.profile.whites = kWhite;
  how.profile.pages = kPage;
  return linework_from_svg(bytes, how);
}

// What the reader says and does not matter here: fills are what is wanted, and a height that is
// given needs no unit.
bool matters(const Warning& warning, bool has_height) {
  return warning.code != "fill_cut" && !(warning.code == "no_unit" && has_height);
}

}  // namespace

Result<std::vector<Area>> drawing_areas(const std::string& bytes, std::optional<double> height,
                                        std::vector<Warning>* warnings) {
  auto work = drawing_of(bytes, 1.0);
  if (!work) return tl::unexpected(work.error());
  Box size = bounds(*work);
  // Curves are flattened at the size of the design, which is known only now.
  const double enlarged = height && size.height() > 0.0 ? *height / size.height() : 1.0;
  if (enlarged > 1.0 && std::isfinite(enlarged)) {
    work = drawing_of(bytes, enlarged);
    if (!work) return tl::unexpected(work.error());
    size = bounds(*work);
  }
  const double near = kClosed * std::max(size.width(), size.height());
  const bool has_white = std::any_of(work->lines.begin(), work->lines.end(),
                                     [](const DrawnLine& one) { return one.operation == kWhite; });
  std::vector<Coat> coats;
  Eigen::AlignedBox2d box;
  std::size_t open = 0;
  for (const DrawnLine& line : work->lines) {
    if (line.operation == kPage && !has_white) continue;  // a background
    const auto points = work->points_of(line);
    const double dx = points.front().x - points.back().x, dy = points.front().y - points.back().y;
    if (points.size() < 3 || !(std::hypot(dx, dy) <= near)) {
      ++open;
      continue;
    }
    const bool white = line.operation == kWhite;
    if (coats.empty() || coats.back().takes_away != white) coats.push_back({{}, white});
    Ring& ring = coats.back().rings.emplace_back();
    for (const PagePoint& p : points) ring.emplace_back(p.x, -p.y);
    if (!white)
      for (const Vec2& p : ring) box.extend(p);
  }
  if (open > 0)
    work->warnings.push_back(
        {.code = "open_line",
         .message = fmt::format("{} not closed and {} no area: {} left out; close {} in the editor",
                                open == 1 ? "1 line is" : fmt::format("{} lines are", open),
                                open == 1 ? "bounds" : "bound", open == 1 ? "it is" : "they are",
                                open == 1 ? "it" : "them"),
         .spoils = true});
  std::erase_if(work->warnings,
                [&](const Warning& one) { return !matters(one, height.has_value()); });
  if (box.isEmpty() && !work->warnings.empty())
    return fail(ErrorKind::Infeasible, "",
                "has no closed line with an area: " + work->warnings.front().message);
  if (warnings != nullptr) *warnings = std::move(work->warnings);
  const double drawn = box.isEmpty() ? 0.0 : box.sizes().y();
  const double scale = height && drawn > 0.0 ? *height / drawn : 1.0;
  for (Coat& coat : coats)
    for (Ring& ring : coat.rings)
      for (Vec2& p : ring) p = (p - box.min()) * scale;
  return areas_painted(std::move(coats));
}

}  // namespace popcut
