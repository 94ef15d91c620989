// SPDX-License-Identifier: MIT
#include "daemon/planning/design_export.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "core/deploy/pose_table.hpp"
#include "core/deploy/sheet_mesh.hpp"
#include "core/deploy/stl.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/formats/write/segments_csv.hpp"
#include "core/geometry/angle.hpp"
#include "core/hands/fold_guide.hpp"
#include "core/hands/wobble.hpp"
#include "core/judge/glue_guide.hpp"
#include "core/picture/poster.hpp"
#include "core/picture/target_on_sheet.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "daemon/planning/design_files.hpp"

namespace popcut::planning {
namespace {

constexpr int kPosesOfMeshes = 60;  // as popcut design
constexpr std::size_t kPoses = 6;

Result<void> write_fold_guide(const ExportJob& job, std::ostream& out) {
  const auto guide = hands::fold_guide(job.made.pattern);
  if (!guide) return tl::unexpected(guide.error());
  out << hands::fold_guide_json({&*guide, 1}, {&job.made.pattern, 1});
  return {};
}

struct Named {
  std::string_view file;
  Result<void> (*write)(const ExportJob&, std::ostream&);
  bool is_drawn{false};  ///< with the target around it
};

constexpr std::array kNamed{
    Named{"pattern.fold", write_fold_file},
    Named{"pattern.svg", write_svg_file},
    Named{"cut.svg", write_cut_file},
    Named{"pattern.dxf", write_dxf_file},
    Named{"segments.csv", write_csv_file},
    Named{"deploy.glb", write_glb_file},
    Named{"deployed.stl", write_stl_file},
    Named{"deployed.svg", write_deployed_file, true},
    Named{"poster.svg", write_poster_file, true},
    Named{"report.json", write_report_file},
    Named{"fold-guide.json", write_fold_guide},
};

template <typename Write>
std::string text_written(const Write& write) {
  std::ostringstream out;
  write(out);
  return std::move(out).str();
}

}  // namespace

Result<void> write_fold_file(const ExportJob& job, std::ostream& out) {
  return write_fold(job.made.pattern, job.fold, out);
}

Result<void> write_svg_file(const ExportJob& job, std::ostream& out) {
  write_pattern_svg(job.made.pattern, out);
  return {};
}

Result<void> write_cut_file(const ExportJob& job, std::ostream& out) {
  write_cut_svg(job.made.pattern, micro_cuts(job.dashed), out);
  return {};
}

Result<void> write_dxf_file(const ExportJob& job, std::ostream& out) {
  write_pattern_dxf(job.made.pattern, out);
  return {};
}

Result<void> write_csv_file(const ExportJob& job, std::ostream& out) {
  write_segments_csv(job.made.strips, out, job.made.pattern.kites);
  return {};
}

Result<void> write_deployed_file(const ExportJob& job, std::ostream& out) {
  CardScene scene = card_scene(job.made.pattern, job.scenery.scene(kMostPanels));
  const auto& known = job.made.report.wobble;
  if (!known || known->loose > 0)
    if (const auto wobble = hands::wobble_of(job.made.pattern); wobble && wobble->loose > 0)
      for (const double moves_mm : wobble->face_mm)
        scene.tones.push_back(moves_mm > hands::kFirm_mm ? PanelTone::Loose : PanelTone::Paper);
  write_deployed_svg(scene, job.made.pattern.design_psi_rad, {.labels = Labels::All}, out);
  return {};
}

Result<void> write_poster_file(const ExportJob& job, std::ostream& out) {
  return write_poster_svg(job.made.pattern, drawn_angles(job.psi_rad, kPoses),
                          {.scene = job.scenery.scene(kMostPanelsOfPoster)}, out);
}

Result<void> write_report_file(const ExportJob& job, std::ostream& out) {
  out << (job.whole ? report_json(*job.whole) : report_json(job.made.report));
  return {};
}

Result<void> write_glb_file(const ExportJob& job, std::ostream& out) {
  const auto glb = animation_glb(job.made.pattern, job.psi_rad, job.thickness_mm);
  if (!glb) return tl::unexpected(glb.error());
  out << *glb;
  return {};
}

Result<void> write_stl_file(const ExportJob& job, std::ostream& out) {
  const Pattern& pattern = job.made.pattern;
  const double psi_rad = job.psi_rad.back();
  const auto mesh = surface_mesh(pattern, job.made.strips);
  if (!mesh) return tl::unexpected(mesh.error());
  const auto table = pose_table(pattern, {&psi_rad, 1});
  if (!table) return tl::unexpected(table.error());
  write_stl(*mesh, *table, 0, MeshAxes::Upright, stl_title(pattern, psi_rad), out);
  return {};
}

std::string stl_title(const Pattern& pattern, double psi_rad) {
  return fmt::format("psi {:.6f} rad, {}", psi_rad, pattern.name);
}

std::vector<double> drawn_angles(const std::vector<double>& psi_rad, std::size_t count) {
  constexpr double kLeastRad = radians(3);
  const double from = psi_rad.front(), to = psi_rad.back();
  if (from == to) return {std::max(from, kLeastRad)};
  std::vector<double> angles;
  for (std::size_t i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(count - 1);
    angles.push_back(std::max(kLeastRad, i + 1 == count ? to : from + part * (to - from)));
  }
  return angles;
}

std::vector<SheetLine> micro_cuts(const LineWork& dashed) {
  std::vector<SheetLine> dashes;
  for (const DrawnLine& line : dashed.lines) {
    if (!is_fold(line.operation)) continue;
    const EdgeRole role =
        line.operation == Operation::FoldMountain ? EdgeRole::Mountain : EdgeRole::Valley;
    const auto points = dashed.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i)
      dashes.push_back({points[i - 1].y, points[i - 1].x, points[i].y, points[i].x, role});
  }
  return dashes;
}

LineWork dashed_page(const Material& material, Design& made) {
  Dashed dashed = micro_cut(linework_from_pattern(made.pattern), material.dashes);
  if (auto warning = left_out_warning(dashed, material.dashes, "are not in cut.svg (page x, y)")) {
    warning->message = fmt::format("{}: {}", material.name, warning->message);
    made.report.warnings.push_back(std::move(*warning));
  }
  return std::move(dashed.work);
}

Result<std::string> design_file(PatchAssembly& made, const Material& material,
                                std::string_view file, std::size_t part) {
  const auto* const named = std::find_if(kNamed.begin(), kNamed.end(),
                                         [&](const Named& one) { return one.file == file; });
  if (named == kNamed.end()) return fail(ErrorKind::OutOfRange, "/file", "is not written");
  if (part >= made.parts.size())
    return fail(ErrorKind::OutOfRange, "/part",
                fmt::format("is {}; this design has {} parts", part + 1, made.parts.size()));
  // The report names what each part leaves out.
  std::vector<LineWork> dashed;
  for (Design& one : made.parts) dashed.push_back(dashed_page(material, one));
  Design& one = made.parts[part];
  const auto angles = opening_angles(std::numbers::pi, one.pattern.design_psi_rad, kPosesOfMeshes);
  if (!angles) return tl::unexpected(angles.error());
  Scenery scenery;
  if (named->is_drawn) scenery.ghost = target_on_sheet(one, true);
  const bool of_whole = made.parts.size() == 1 || file == "report.json";
  FoldOptions fold;
  fold.creator = "popcut " POPCUT_VERSION;
  const ExportJob job{one, of_whole ? &made : nullptr, dashed[part], fold, *angles, 0.0, scenery};
  std::ostringstream out;
  if (const auto done = named->write(job, out); !done) return tl::unexpected(done.error());
  return std::move(out).str();
}

Result<std::string> parts_file(const PartsCard& made, const Material& material,
                               std::string_view file) {
  if (file == "pattern.fold") return made.fold;
  if (file == "report.json") return made.report();
  if (file == "fold-guide.json") {
    const auto guide = judge::glue_guide(made.fold);
    if (!guide) return tl::unexpected(guide.error());
    return judge::glue_guide_json(*guide);
  }
  const Pattern drawing = parts_drawing(made.card());
  if (file == "pattern.svg")
    return text_written([&](std::ostream& out) { write_pattern_svg(drawing, out); });
  if (file == "pattern.dxf")
    return text_written([&](std::ostream& out) { write_pattern_dxf(drawing, out); });
  if (file == "cut.svg") {
    const Dashed dashed = micro_cut(linework_from_pattern(drawing), material.dashes);
    return text_written(
        [&](std::ostream& out) { write_cut_svg(drawing, micro_cuts(dashed.work), out); });
  }
  return fail(ErrorKind::OutOfRange, "/file",
              fmt::format("{} is for cards of one sheet, and this card has {} parts", file,
                          made.card().parts.size()));
}

}  // namespace popcut::planning
