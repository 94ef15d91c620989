// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/deploy/sheet_mesh.hpp"
#include "core/deploy/stl.hpp"
#include "core/judge/sheet_motion.hpp"
#include "core/pattern/pattern.hpp"
#include "core/picture/deployed_svg.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "daemon/cli/parsing/command_line.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// How a pattern is opened, as the user wrote it; shared by `design` and `deploy`.
struct MotionOptions {
  int frames{60};
  std::string from_psi{"pi"}, to_psi;  ///< no last one: the angle that it is designed for
  std::string thickness;               ///< mm; empty: the material's
  Option from_option{};
  Option thickness_option{};
};

/// Adds --frames, --from-psi, --to-psi and --thickness to a command.
void add_motion_options(const Command& command, MotionOptions& options);

/// The angles of the frames.
///
/// @param design_psi_rad  the last one where the user named none
/// @retval Usage  no angles, or not a valid list of them
[[nodiscard]] Result<std::vector<double>> angles_of(const MotionOptions& options,
                                                    double design_psi_rad);

/// True when the user named the first angle.
[[nodiscard]] bool from_is_given(const MotionOptions& options);

/// `--thickness` may stand before a file's name, and then has it for its value: the name goes to
/// `file`, where that is empty.
void give_back_file(MotionOptions& options, std::string& file);

/// Thickness of the solids in mm, 0 for surfaces.
///
/// @retval Usage  it is no thickness from 0.001 to 100 mm
[[nodiscard]] Result<double> thickness_of(const MotionOptions& options, double of_material_mm);

/// Writes `prefix` + "psi_NNN.stl" for each angle, the first with the number 1.
///
/// @param motion  how the pattern moves; null: by popcut's own law
[[nodiscard]] Result<void> add_meshes(const Pattern& pattern, const SheetMesh& mesh,
                                      const std::vector<double>& psi_rad, MeshAxes axes,
                                      const std::string& prefix, OutputFolder& folder,
                                      const Progress& progress = {},
                                      const judge::SolvedPoses* motion = nullptr);

/// Writes "deploy.glb": the way from the first angle to the last, as one animation. A solved motion
/// has a key at each of its angles.
[[nodiscard]] Result<void> add_glb(const Pattern& pattern, const std::vector<double>& psi_rad,
                                   double thickness_mm, OutputFolder& folder,
                                   const judge::SolvedPoses* motion = nullptr);

/// Writes "poster.svg": six poses from the first angle to the last.
[[nodiscard]] Result<void> add_poster(const Pattern& pattern, const std::vector<double>& psi_rad,
                                      const SceneOptions& scene, OutputFolder& folder);

/// Writes "film.svg": an SVG that plays the way there and back.
[[nodiscard]] Result<void> add_film(const Pattern& pattern, const std::vector<double>& psi_rad,
                                    OutputFolder& folder);

}  // namespace popcut::cli
