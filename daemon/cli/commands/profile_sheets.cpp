// SPDX-License-Identifier: MIT
#include "daemon/cli/commands/profile_sheets.hpp"

#include <sstream>

#include <fmt/format.h>

#include "core/formats/write/cricut_svg.hpp"
#include "core/formats/write/profile_svg.hpp"

namespace popcut::cli {
namespace {

LineWork strokes_as_lines(const Toolpath& path, const std::string& title) {
  LineWork work;
  work.name = title;
  work.dashed = true;
  work.points.reserve(path.points.size());
  for (const Stroke& stroke : path.strokes) work.append(stroke.operation, path.points_of(stroke));
  return work;
}

// The mats of that maker keep a quarter of an inch free all round.
CricutMat cricut_mat(const PlannedSheet& sheet) {
  constexpr double kMmPerInch = 25.4;
  CricutMat mat;
  const double inches = sheet.area_mm[1] / kMmPerInch;
  if (inches > mat.height_in + 0.5 + 1e-6) mat.height_in = 23.5;
  return mat;
}

}  // namespace

Result<void> add_profile_sheet(const PlannedSheet& sheet, std::size_t number,
                               const std::string& profile, const std::string& title,
                               OutputFolder& folder, std::vector<std::string>& warnings) {
  const std::string name = fmt::format("sheet-{:02}-{}.svg", number, profile);
  std::ostringstream out;
  if (profile == "cricut") {
    const auto written =
        write_cricut_svg(strokes_as_lines(sheet.path, title), cricut_mat(sheet), out);
    if (!written) {
      warnings.push_back(fmt::format("{} is not written: {}", name, written.error().detail));
      return {};
    }
  } else if (profile == "lightburn") {
    write_lightburn_svg(strokes_as_lines(sheet.path, title), sheet.area_mm, out);
  } else if (profile == "origami-sim" && sheet.lines) {
    write_origami_sim_svg(*sheet.lines, out);
  } else {
    return {};
  }
  return folder.add(name, out.str());
}

}  // namespace popcut::cli
