// SPDX-License-Identifier: MIT
#include "daemon/planning/design_files.hpp"

#include <algorithm>
#include <numbers>
#include <sstream>

#include <fmt/format.h>

#include "core/deploy/glb.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/deploy/shut_stack.hpp"
#include "core/design/makeable.hpp"
#include "core/design/shape_fit.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/plan/knife/micro_cut.hpp"

namespace popcut::planning {
namespace {

constexpr int kFrames = 60;  // as popcut design
constexpr const char* kDefaultMachine = "cameo3";

/// Shorter panels do not fold flat.
double least_panel_mm(const Material& material) { return std::max(0.5, 3 * material.thickness_mm); }

Result<void> add_part(const Design& part, const std::string& prefix, const FileSink& add,
                      std::vector<Warning>& warnings) {
  std::ostringstream svg;
  write_pattern_svg(part.pattern, svg);
  if (auto done = add(prefix + "pattern.svg", std::move(svg).str()); !done) return done;
  std::ostringstream fold;
  FoldOptions options;
  options.creator = "popcut " POPCUT_VERSION;
  if (auto written = write_fold(part.pattern, options, fold); !written) return written;
  if (auto done = add(prefix + "pattern.fold", std::move(fold).str()); !done) return done;
  const auto angles = opening_angles(std::numbers::pi, part.pattern.design_psi_rad, kFrames);
  if (!angles) return tl::unexpected(angles.error());
  auto glb = animation_glb(part.pattern, *angles, 0.0);
  if (glb) return add(prefix + "deploy.glb", std::move(*glb));
  warnings.push_back(
      {.code = "no_deploy_glb",
       .message = fmt::format("{}deploy.glb was not written: {}", prefix, message(glb.error()))});
  return {};
}

}  // namespace

std::size_t poses_at_once(const Pattern& pattern, std::size_t wanted) {
  return std::clamp<std::size_t>(kMaxTabled / std::max<std::size_t>(1, pattern.faces()), 1, wanted);
}

Result<std::string> animation_glb(const Pattern& pattern, const std::vector<double>& psi_rad,
                                  double thickness_mm) {
  const std::size_t most_keys = std::max<std::size_t>(13, poses_at_once(pattern, 61));
  std::vector<double> angles = psi_rad;
  if (angles.size() > 1) {
    const auto few =
        opening_angles(psi_rad.front(), psi_rad.back(),
                       static_cast<int>(std::clamp<std::size_t>(psi_rad.size(), 13, most_keys)));
    if (!few) return tl::unexpected(few.error());
    angles = *few;
  }
  const auto table = pose_table(pattern, angles);
  if (!table) return tl::unexpected(table.error());
  return glb(pattern, *table, {.creator = "popcut " POPCUT_VERSION, .thickness_mm = thickness_mm});
}

void suit_material(const Material& material, DesignSpec& spec) {
  for (DesignSpec& patch : spec.patches) suit_material(material, patch);
  if (!spec.min_panel_asked)
    spec.min_panel_mm = std::max(spec.min_panel_mm, least_panel_mm(material));
  if (spec.splay && !spec.splay->ligament_asked)
    spec.splay->ligament_mm = std::max(
        {spec.splay->ligament_mm, spec.min_panel_mm, shortest_good_fold_mm(material.dashes)});
}

void add_make_warnings(const Material& material, const DesignSpec& spec, Design& made) {
  MakeLimits limits{shortest_good_fold_mm(material.dashes), least_panel_mm(material), {}, {}};
  if (spec.sheet) {
    limits.sheet_mm[0] = spec.sheet->width_mm, limits.sheet_mm[1] = spec.sheet->height_mm;
    limits.sheet_name = spec.sheet->name.empty() ? "the sheet" : "a sheet " + spec.sheet->name;
  } else if (const auto machine = find_machine(kDefaultMachine);
             machine && !machine->mats.empty()) {
    const Mat& mat = machine->mats.front();
    limits.sheet_mm[0] = mat.width_mm, limits.sheet_mm[1] = mat.length_mm;
    limits.sheet_name = fmt::format("the {} mat of {}", mat.name, machine->name);
  }
  const auto add = [&](Warning warning) {
    warning.message = fmt::format("{}: {}", material.name, warning.message);
    made.report.warnings.push_back(std::move(warning));
  };
  for (Warning& warning : make_warnings(made.strips, made.pattern, limits)) add(std::move(warning));
  const ShutStack stack = shut_stack(made.strips, material.thickness_mm);
  if (auto warning = thickness_warning(stack, material.thickness_mm)) add(std::move(*warning));
}

void add_figures(const Material* material, const DesignSpec& spec, PatchAssembly& made) {
  for (Design& part : made.parts) {
    part.report.surface_fit = surface_fit(part);
    if (material != nullptr) add_make_warnings(*material, spec, part);
  }
}

Result<void> add_design_files(const PatchAssembly& made, const FileSink& add,
                              std::vector<Warning>& warnings) {
  const bool is_one = made.parts.size() == 1;
  for (std::size_t p = 0; p < made.parts.size(); ++p)
    if (auto done =
            add_part(made.parts[p], is_one ? "" : part_folder(made, p) + "-", add, warnings);
        !done)
      return done;
  return add("report.json", report_json(made));
}

}  // namespace popcut::planning
