// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/design/patches.hpp"
#include "core/pattern/pattern.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// How many poses of a pattern one table may hold, at most `wanted`.
[[nodiscard]] std::size_t poses_at_once(const Pattern& pattern, std::size_t wanted);

/// The bytes of `deploy.glb`: the way from the first angle to the last, as one animation.
[[nodiscard]] Result<std::string> animation_glb(const Pattern& pattern,
                                                const std::vector<double>& psi_rad,
                                                double thickness_mm);

/// Says in the report where the paper's thickness matters.
void add_thickness_note(const Material& material, Design& made);

/// Takes a file of a plan; its error ends the work.
using FileSink = std::function<Result<void>(std::string name, std::string bytes)>;

/// The files of a design: pattern.svg, pattern.fold, deploy.glb and report.json; of a design of
/// several parts "part-01-pattern.svg" and so on. What cannot be made (an animation of too many
/// faces) is told in `warnings`.
[[nodiscard]] Result<void> add_design_files(const PatchAssembly& made, const FileSink& add,
                                            std::vector<std::string>& warnings);

}  // namespace popcut::planning
