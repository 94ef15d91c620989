// SPDX-License-Identifier: MIT
#include "daemon/planning/make/program_sheets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <sstream>

#include <fmt/format.h>

#include "core/formats/write/pattern_files.hpp"
#include "core/formats/write/profile_svg.hpp"

namespace popcut::planning {
namespace {

bool same_line(std::span<const PagePoint> a, std::span<const PagePoint> b) {
  const auto same = [](const PagePoint& p, const PagePoint& q) { return p.x == q.x && p.y == q.y; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same) ||
         std::equal(a.begin(), a.end(), b.rbegin(), b.rend(), same);
}

using Ends = std::array<double, 4>;

Ends ends_of(std::span<const PagePoint> line) {
  const PagePoint &p = line.front(), &q = line.back();
  return p.x < q.x || (p.x == q.x && p.y < q.y) ? Ends{p.x, p.y, q.x, q.y}
                                                : Ends{q.x, q.y, p.x, p.y};
}

}  // namespace

LineWork strokes_as_lines(const PlannedSheet& sheet, FoldMode folds, const std::string& title) {
  const Toolpath& path = sheet.path;
  LineWork work;
  work.name = title;
  work.dashed = folds == FoldMode::Perforate;
  work.points.reserve(path.points.size());
  std::set<Ends> scored;
  for (std::size_t i = 0; i < sheet.scored.size(); ++i) scored.insert(ends_of(sheet.scored[i]));
  const auto rounds = static_cast<std::size_t>(std::max(1, sheet.knife.rounds));
  for (std::size_t i = 0; i < path.strokes.size(); ++i) {
    auto points = path.points_of(path.strokes[i]);
    if (i > 0 && same_line(path.points_of(path.strokes[i - 1]), points)) continue;
    Operation operation = path.strokes[i].operation;
    if (is_cut(operation) && closed(points) && rounds > 1)
      points = points.first((points.size() - 1) / rounds + 1);
    if (is_fold(operation) && scored.contains(ends_of(points))) operation = Operation::Score;
    work.append(operation, points);
  }
  return work;
}

namespace {

// The mats of that maker keep a quarter of an inch free all round.
CricutMat cricut_mat(const PlannedSheet& sheet, const Machine& machine) {
  constexpr double kMmPerInch = 25.4;
  CricutMat mat;
  if (machine.language == "cricut") {
    mat.width_in = std::round(sheet.area_mm[0] / kMmPerInch * 1e4) / 1e4;
    mat.height_in = std::round(sheet.area_mm[1] / kMmPerInch * 1e4) / 1e4;
    return mat;
  }
  const double inches = sheet.area_mm[1] / kMmPerInch;
  if (inches > mat.height_in + 0.5 + 1e-6) mat.height_in = 23.5;
  return mat;
}

}  // namespace

std::string program_sheet_name(std::size_t number, std::string_view program) {
  if (program == kDxfSheets) return fmt::format("sheet-{:02}.dxf", number);
  return fmt::format("sheet-{:02}-{}.svg", number, program);
}

Result<std::optional<std::string>> program_sheet(const Plan& plan, std::size_t number,
                                                 std::string_view program,
                                                 const std::string& title) {
  const PlannedSheet& sheet = plan.sheets[number - 1];
  std::ostringstream out;
  if (program == "cricut") {
    const auto written = write_cricut_svg(strokes_as_lines(sheet, plan.folds, title),
                                          cricut_mat(sheet, plan.machine), out);
    if (!written) return tl::unexpected(written.error());
  } else if (program == "lightburn") {
    write_lightburn_svg(strokes_as_lines(sheet, plan.folds, title), sheet.area_mm, out);
  } else if (program == kDxfSheets) {
    write_sheet_dxf(strokes_as_lines(sheet, plan.folds, title), sheet.area_mm, out);
  } else if (program == "origami-sim" && sheet.lines) {
    write_origami_sim_svg(*sheet.lines, out);
  } else {
    return std::nullopt;
  }
  return std::move(out).str();
}

}  // namespace popcut::planning
