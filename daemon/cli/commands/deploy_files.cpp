// SPDX-License-Identifier: MIT
#include "daemon/cli/commands/deploy_files.hpp"

#include <algorithm>
#include <charconv>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/deploy/glb.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/picture/poster.hpp"
#include "daemon/cli/options/angles.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/planning/design_export.hpp"
#include "daemon/planning/design_files.hpp"

namespace popcut::cli {
namespace {

using Streamed = std::function<Result<void>(std::ostream&)>;

std::optional<double> number(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

Result<double> opening_angle(const char* option, const std::string& text) {
  const auto angle = parse_angle(text);
  if (!angle) return fail(ErrorKind::Usage, option, angle.error().detail);
  if (*angle >= 0 && *angle <= std::numbers::pi) return *angle;
  return fail(ErrorKind::Usage, option,
              fmt::format("is \"{}\"; give an angle from 0 (closed) to pi (flat){}", text,
                          degrees_hint(text)));
}

}  // namespace

void add_motion_options(const Command& command, MotionOptions& options) {
  whole_number(command.add_option(
                   "--frames", options.frames,
                   "Number of STL files (poses), 1 to 10000; other files have their own number"),
               1, 10'000)
      .value_text("N [60]");
  options.from_option =
      command
          .add_option("--from-psi", options.from_psi,
                      "Opening angle (psi) of the first pose, in radians or as 90deg; pi is flat")
          .value_text("ANGLE [pi]");
  command
      .add_option(
          "--to-psi", options.to_psi,
          "Opening angle (psi) of the last pose, 0 is closed; default: the angle the card is "
          "designed for, pi/2 without design_angle_deg")
      .value_text("ANGLE [pi/2]");
  options.thickness_option =
      command
          .add_option(
              "--thickness", options.thickness,
              "Write solids, as thick as the material or MM; default: a surface without thickness")
          .value_text("[MM]")
          .value_optional();
}

Result<std::vector<double>> angles_of(const MotionOptions& options, double design_psi_rad) {
  const auto from = opening_angle("--from-psi", options.from_psi);
  if (!from) return tl::unexpected(from.error());
  const auto to = options.to_psi.empty() ? Result<double>(design_psi_rad)
                                         : opening_angle("--to-psi", options.to_psi);
  if (!to) return tl::unexpected(to.error());
  return opening_angles(*from, *to, options.frames);
}

bool from_is_given(const MotionOptions& options) { return options.from_option.is_given(); }

void give_back_file(MotionOptions& options, std::string& file) {
  if (file.empty() && !options.thickness.empty() && !number(options.thickness))
    file = std::exchange(options.thickness, {});
}

Result<double> thickness_of(const MotionOptions& options, double of_material_mm) {
  if (!options.thickness_option.is_given()) return 0;
  if (options.thickness.empty()) return of_material_mm;
  constexpr double kLeastMm = 1e-3, kMostMm = 100;
  const auto mm = number(options.thickness);
  if (mm && *mm >= kLeastMm && *mm <= kMostMm) return *mm;
  return fail(ErrorKind::Usage, "--thickness",
              fmt::format("is \"{}\"; give a number from {} to {} (mm), or nothing for the "
                          "thickness of the material",
                          options.thickness, kLeastMm, kMostMm));
}

Result<void> add_meshes(const Pattern& pattern, const SheetMesh& mesh,
                        const std::vector<double>& psi_rad, MeshAxes axes,
                        const std::string& prefix, OutputFolder& folder, const Progress& progress,
                        const judge::SolvedPoses* motion) {
  // A table holds some poses at a time, since thousands of poses of thousands of faces are a lot.
  const std::size_t at_once = planning::poses_at_once(pattern, 64);
  for (std::size_t first = 0; first < psi_rad.size(); first += at_once) {
    const auto angles =
        std::span(psi_rad).subspan(first, std::min(at_once, psi_rad.size() - first));
    const auto table =
        motion == nullptr ? pose_table(pattern, angles) : motion->table(pattern, angles);
    if (!table) return tl::unexpected(table.error());
    for (std::size_t k = 0; k < angles.size(); ++k) {
      tell(progress, "writing the poses",
           static_cast<double>(first + k) / static_cast<double>(psi_rad.size()));
      const std::string title = planning::stl_title(pattern, angles[k]);
      auto done = folder.add(fmt::format("{}psi_{:03}.stl", prefix, first + k + 1),
                             Streamed([&](std::ostream& out) -> Result<void> {
                               write_stl(mesh, *table, k, axes, title, out);
                               return {};
                             }));
      if (!done) return done;
    }
  }
  return {};
}

Result<void> add_glb(const Pattern& pattern, const std::vector<double>& psi_rad,
                     double thickness_mm, OutputFolder& folder, const judge::SolvedPoses* motion) {
  const auto drawn = [&]() -> Result<std::string> {
    if (motion == nullptr) return planning::animation_glb(pattern, psi_rad, thickness_mm);
    const auto table = motion->table(pattern, psi_rad);
    if (!table) return tl::unexpected(table.error());
    return glb(pattern, *table,
               {.creator = "popcut " POPCUT_VERSION, .thickness_mm = thickness_mm});
  };
  const auto bytes = drawn();
  if (!bytes) return tl::unexpected(bytes.error());
  return folder.add("deploy.glb", *bytes);
}

Result<void> add_poster(const Pattern& pattern, const std::vector<double>& psi_rad,
                        const SceneOptions& scene, OutputFolder& folder) {
  constexpr std::size_t kPoses = 6;
  return folder.add("poster.svg", Streamed([&](std::ostream& out) {
                      return write_poster_svg(pattern, planning::drawn_angles(psi_rad, kPoses),
                                              {.scene = scene}, out);
                    }));
}

Result<void> add_film(const Pattern& pattern, const std::vector<double>& psi_rad,
                      OutputFolder& folder) {
  constexpr std::size_t kPoses = 24;
  constexpr double kSeconds = 5;
  return folder.add("film.svg", Streamed([&](std::ostream& out) {
                      return write_film_svg(pattern, planning::drawn_angles(psi_rad, kPoses),
                                            kSeconds, {.cell_px = 800}, out);
                    }));
}

}  // namespace popcut::cli
