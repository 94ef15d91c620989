// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/drawing/linework.hpp"

namespace popcut {
Result<std::size_t> SvgStrokes::add(const SvgLines& lines, const SvgTransform& to_page,
                                    PenOperation operation) {
  std::size_t added = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines[i];
    if (work_.points.size() + line.size() > most_points_)
      return tl::unexpected(
          too_much(fmt::format("the drawing has more than {} points", most_points_)));
    const std::size_t first = work_.points.size();
    for (const PagePoint& p : line) {
      const PagePoint q = to_page(p);
      if (!(std::abs(q.x) <= kMaxCoordinate && std::abs(q.y) <= kMaxCoordinate))
        return fail(ErrorKind::OutOfRange, "",
                    "is more than 100 m from the origin; move or scale it");
      if (work_.points.size() == first || work_.points.back() != q) work_.points.push_back(q);
    }
    const std::size_t count = work_.points.size() - first;
    if (count < 2) {
      work_.points.resize(first);
      continue;
    }
    work_.lines.push_back(
        {operation, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
    ++added;
  }
  return added;
}

Result<void> SvgStrokes::dash(const SvgLines& lines, const SvgDashes& dashes, std::size_t& steps,
                              SvgLines& out) const {
  constexpr double kMostDashes = 1e6;  // of one line
  const double period = std::accumulate(dashes.lengths.begin(), dashes.lengths.end(), 0.0);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double count = length(lines[i]) / period * static_cast<double>(dashes.lengths.size());
    if (!(count <= kMostDashes) || !cut_into_dashes(lines[i], dashes, steps, out) ||
        out.points.size() > most_points_)
      return fail(
          ErrorKind::OutOfRange, "",
          fmt::format(
              "a line has {:.3g} dashes and gaps, which are too many to cut; make them longer",
              count));
  }
  return {};
}

std::size_t SvgStrokes::clip(const SvgClip& frame, std::size_t first) {
  const std::size_t left = frame.around != nullptr ? clip(*frame.around, first) : 0;
  const double margin = 1e-6 * (frame.box.width() + frame.box.height());
  const Box box{frame.box.x0 - margin, frame.box.y0 - margin, frame.box.x1 + margin,
                frame.box.y1 + margin};
  const auto leaves = [&](const DrawnLine& line) {
    const auto points = work_.points_of(line);
    return std::any_of(points.begin(), points.end(), [&](const PagePoint& p) {
      const PagePoint q = frame.from_page(p);
      return q.x < box.x0 || q.x > box.x1 || q.y < box.y0 || q.y > box.y1;
    });
  };
  const auto begin = work_.lines.begin() + static_cast<std::ptrdiff_t>(first);
  const auto lost = static_cast<std::size_t>(std::count_if(begin, work_.lines.end(), leaves));
  if (lost == 0) return left;
  LineWork kept;
  std::vector<PagePoint> here, run;
  for (auto line = begin; line != work_.lines.end(); ++line) {
    const auto points = work_.points_of(*line);
    if (!leaves(*line)) {
      kept.append(line->operation, points);
      continue;
    }
    here.clear();
    for (const PagePoint& p : points) here.push_back(frame.from_page(p));
    const std::size_t from = kept.points.size();
    clip_line(here, line->operation, frame.box, run, kept);
    for (std::size_t i = from; i < kept.points.size(); ++i)
      kept.points[i] = frame.to_page(kept.points[i]);
  }
  work_.points.resize(begin->first);
  work_.lines.erase(begin, work_.lines.end());
  for (const DrawnLine& line : kept.lines) work_.append(line.operation, kept.points_of(line));
  return std::max(left, lost);
}

std::size_t SvgStrokes::clip(const SvgRegion& region, std::size_t first, std::size_t& steps) {
  const std::vector<DrawnLine> lines(work_.lines.begin() + static_cast<std::ptrdiff_t>(first),
                                     work_.lines.end());
  if (lines.empty()) return 0;
  LineWork kept;
  SvgLines parts;
  std::size_t lost = 0;
  for (const DrawnLine& line : lines) {
    parts.clear();
    if (!region.cut(work_.points_of(line), steps, parts)) {
      kept.append(line.operation, work_.points_of(line));
      continue;
    }
    ++lost;
    for (std::size_t i = 0; i < parts.size(); ++i) kept.append(line.operation, parts[i]);
  }
  if (lost == 0) return 0;
  work_.points.resize(lines.front().first);
  work_.lines.resize(first);
  for (const DrawnLine& line : kept.lines) work_.append(line.operation, kept.points_of(line));
  return lost;
}

std::optional<SvgLines> clipped_fill(const SvgLines& lines, bool even_odd, const SvgClip* frame,
                                     const SvgClipPath* clips, std::size_t& steps) {
  if (frame == nullptr && clips == nullptr) return std::nullopt;
  SvgRegion around, fill, both;
  std::vector<SvgRegion::Part> parts;
  for (; frame != nullptr; frame = frame->around) {
    const Box& box = frame->box;
    SvgLines corners{{{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}}, {4}};
    parts.push_back(around.add_shape(moved(corners, frame->to_page), false));
  }
  for (; clips != nullptr; clips = clips->around)
    parts.push_back(around.add_region(*clips->region));
  around.finish(around.add_all(std::move(parts)));
  fill.finish(fill.add_shape(lines, even_odd));
  SvgLines kept;
  bool lost = false;
  for (std::size_t i = 0; i < lines.size(); ++i) lost |= around.cut(lines[i], steps, kept);
  if (!lost && !fill.contains_corner_of(around, steps)) return std::nullopt;
  const auto shape = both.add_region(fill), hidden = both.add_region(around);
  both.finish(both.add_all({shape, hidden}));
  return both.border(steps);
}

SvgLines moved(const SvgLines& lines, const SvgTransform& to_page) {
  SvgLines out = lines;
  for (PagePoint& p : out.points) p = to_page(p);
  return out;
}

void remove_thin_lines(SvgLines& lines) {
  SvgLines kept;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines[i];
    double twice = 0.0, around = 0.0;
    for (std::size_t k = 1; k < line.size(); ++k) {
      const double ax = line[k - 1].x - line[0].x, ay = line[k - 1].y - line[0].y;
      const double bx = line[k].x - line[0].x, by = line[k].y - line[0].y;
      twice += std::abs(ax * by - ay * bx);
      around += distance(line[k - 1], line[k]);
    }
    if (!(twice > 1e-9 * around * around)) continue;
    kept.points.insert(kept.points.end(), line.begin(), line.end());
    kept.ends.push_back(static_cast<std::uint32_t>(kept.points.size()));
  }
  lines = std::move(kept);
}

void remove_lines(LineWork& work, std::span<const std::size_t> which) {
  std::size_t next = 0, kept = 0;
  std::uint32_t points = 0;
  for (std::size_t i = 0; i < work.lines.size(); ++i) {
    if (next < which.size() && which[next] == i) {
      ++next;
      continue;
    }
    DrawnLine line = work.lines[i];
    std::copy_n(work.points.begin() + line.first, line.count, work.points.begin() + points);
    line.first = points;
    points += line.count;
    work.lines[kept++] = line;
  }
  work.lines.resize(kept);
  work.points.resize(points);
}

}  // namespace popcut
