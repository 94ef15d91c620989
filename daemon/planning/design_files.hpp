// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/design/patches.hpp"
#include "core/machines/machine.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// How many poses of a pattern one table may hold, at most `wanted`.
[[nodiscard]] std::size_t poses_at_once(const Pattern& pattern, std::size_t wanted);

/// The bytes of `deploy.glb`: the motion from the first angle to the last, as one animation.
[[nodiscard]] Result<std::string> animation_glb(const Pattern& pattern,
                                                const std::vector<double>& psi_rad,
                                                double thickness_mm);

/// Gives a spec what it leaves to its material: `min_panel_mm` of three thicknesses if that is more
/// than 0.5, and V-folds with room for a good dash beside them. Of patches: each its own.
void suit_material(const Material& material, DesignSpec& spec);

/// Warnings in the report of what is hard to make in this material: its thickness when folded,
/// folds that are too short, strips and slits that are too narrow, a sheet larger than `spec.sheet`
/// or, where that is left out, than the usual cutter's.
void add_make_warnings(const Material& material, const DesignSpec& spec, Design& made);

/// Adds to the reports of a design what designing leaves out: how near it is to its target, and
/// what is hard to make.
///
/// @param material  that it was suited to (`suit_material`); null: popcut does not know it
void add_figures(const Material* material, const DesignSpec& spec, PatchAssembly& made);

/// Receives each file of a plan; its error ends the work.
using FileSink = std::function<Result<void>(std::string name, std::string bytes)>;

/// The files of a design: pattern.svg, pattern.fold, deploy.glb and report.json; of a design of
/// several parts "part-01-pattern.svg" and so on. What cannot be written (an animation of too
/// many faces) is noted in `warnings`.
[[nodiscard]] Result<void> add_design_files(const PatchAssembly& made, const FileSink& add,
                                            std::vector<Warning>& warnings);

}  // namespace popcut::planning
