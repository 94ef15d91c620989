// SPDX-License-Identifier: MIT
#include "core/verify/sheet/hinge_lines.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace popcut::verify {
namespace {

std::pair<std::uint32_t, std::uint32_t> panels_of(const HingeLine& line) {
  return std::minmax(line.left, line.right);
}

bool in_one_line(const HingeLine& line, const HingeLine& other) {
  const Vec2 way = line.to - line.from;
  const double slack = 1e-7 * norm(way) * (norm(way) + norm(other.to - line.from));
  return std::abs(cross(way, other.from - line.from)) <= slack &&
         std::abs(cross(way, other.to - line.from)) <= slack;
}

}  // namespace

std::vector<HingeLine> hinge_lines(const FoldModel& file, const Sheet& sheet) {
  std::vector<HingeLine> all;
  for (std::uint32_t h = 0; h < sheet.hinges.size(); ++h) {
    const Hinge& hinge = sheet.hinges[h];
    const std::uint32_t left = sheet.panel_of_face[hinge.left];
    const std::uint32_t right = sheet.panel_of_face[hinge.right];
    if (left != right) all.push_back({left, right, file.flat[hinge.from], file.flat[hinge.to], h});
  }
  std::stable_sort(all.begin(), all.end(), [](const HingeLine& p, const HingeLine& q) {
    return panels_of(p) < panels_of(q);
  });
  std::vector<HingeLine> lines;
  std::size_t first = 0;  // first line between the current two panels
  for (const HingeLine& hinge : all) {
    if (lines.empty() || panels_of(lines.back()) != panels_of(hinge)) first = lines.size();
    const auto same = std::find_if(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(),
                                   [&](const HingeLine& line) { return in_one_line(line, hinge); });
    if (same != lines.end()) {
      const Vec2 way = same->to - same->from;
      for (const Vec2& end : {hinge.from, hinge.to}) {
        if (dot(way, end - same->from) < 0.0) same->from = end;
        if (dot(way, end - same->to) > 0.0) same->to = end;
      }
    } else if (lines.size() - first < 3) {
      lines.push_back(hinge);
    }
  }
  return lines;
}

std::vector<PanelFrame> panel_frames(const std::vector<HingeLine>& lines, std::size_t panels) {
  std::vector<PanelFrame> frames(panels);
  for (const HingeLine& line : lines) {
    for (const std::uint32_t p : {line.left, line.right}) {
      frames[p].middle = frames[p].middle + 0.5 * (line.from + line.to);
      ++frames[p].hinges;
    }
  }
  for (PanelFrame& frame : frames) {
    if (frame.hinges > 0) frame.middle = (1.0 / static_cast<double>(frame.hinges)) * frame.middle;
  }
  for (const HingeLine& line : lines) {
    for (const std::uint32_t p : {line.left, line.right}) {
      for (const Vec2& end : {line.from, line.to})
        frames[p].size_mm = std::max(frames[p].size_mm, norm(end - frames[p].middle));
    }
  }
  for (PanelFrame& frame : frames) {
    if (!(frame.size_mm > 0.0)) frame.size_mm = 1.0;
  }
  return frames;
}

}  // namespace popcut::verify
