// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "device/session/session.hpp"
#include "device/sim/trace.hpp"
#include "protocol/encode.hpp"

namespace popcut::testing {

/// The points on a machine's grid, without repeats.
inline std::vector<PagePoint> grid_line(std::span<const PagePoint> points, double unit_mm) {
  std::vector<PagePoint> line;
  for (const PagePoint& p : points) {
    const PagePoint q{std::round(p.x / unit_mm) * unit_mm, std::round(p.y / unit_mm) * unit_mm};
    if (line.empty() || distance(line.back(), q) > unit_mm / 2) line.push_back(q);
  }
  return line;
}

/// What a cutter should draw, stroke by stroke, without strokes that are too short to be sent.
struct MeantLines {
  std::vector<std::vector<PagePoint>> lines;
  std::vector<std::size_t> stroke;  ///< of the toolpath, one a line

  MeantLines(const Toolpath& path, double unit_mm) {
    for (std::size_t k = 0; k < path.strokes.size(); ++k) {
      std::vector<PagePoint> line = grid_line(path.points_of(path.strokes[k]), unit_mm);
      if (line.size() < 2) continue;
      lines.push_back(std::move(line));
      stroke.push_back(k);
    }
  }
};

/// How many of the expected lines a trace has, complete and begun (below 0: see `wrong`).
struct CutLines {
  std::size_t whole{};
  std::size_t begun{};
  std::string wrong;  ///< what was drawn that was not meant, or twice; empty if nothing
};

/// Every stroke of a trace must be the next of the expected lines, or its beginning.
inline CutLines cut_lines(const Trace& trace, const MeantLines& meant) {
  CutLines cut;
  for (std::size_t k = 0; k < trace.strokes.size() && cut.wrong.empty(); ++k) {
    const auto got = trace.points_of(trace.strokes[k]);
    if (k >= meant.lines.size() || got.size() > meant.lines[k].size()) {
      cut.wrong = fmt::format("stroke {} of the trace was not meant", k);
      break;
    }
    for (std::size_t i = 0; i < got.size(); ++i)
      if (distance(got[i], meant.lines[k][i]) > 1e-9)
        cut.wrong = fmt::format("point {} of stroke {} is elsewhere", i, k);
    ++cut.begun;
    if (got.size() == meant.lines[k].size()) ++cut.whole;
  }
  return cut;
}

/// What is wrong in a ledger; empty if all of it is true. `now` is the trace when the session
/// ended, `later` the trace after the cutter has executed everything that was sent.
inline std::string untrue(const SessionEnd& end, const CutLines& now, const CutLines& later,
                          const MeantLines& meant) {
  if (!now.wrong.empty()) return now.wrong;
  if (!later.wrong.empty()) return later.wrong;
  for (std::size_t i = 0; i < meant.lines.size(); ++i) {
    const StrokeFate fate = end.fates[meant.stroke[i]];
    if (fate == StrokeFate::Certain && i >= now.whole)
      return fmt::format("line {} is certain, but not cut", i);
    if (fate == StrokeFate::NotSent && i < later.begun)
      return fmt::format("line {} is not sent, but cut", i);
    if (!end.error && !end.cancelled && end.confirmed && fate != StrokeFate::Certain)
      return fmt::format("the job is done, but line {} is not certain", i);
  }
  return {};
}

}  // namespace popcut::testing
