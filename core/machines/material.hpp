// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/machines/tab_shape.hpp"
#include "core/result.hpp"

namespace popcut {

/// Dashes that make a fold: `dash_mm` cut, `gap_mm` paper between dashes, at least `clearance_mm`
/// paper at both ends; no dash shorter than `min_dash_mm`.
struct DashShape {
  double dash_mm{1.5};
  double gap_mm{1.0};
  double clearance_mm{0.5};
  double min_dash_mm{0.5};
};

/// What touches the sheet. A blade trails behind its axis; a pen and a stylus do not.
enum class ToolTip : std::uint8_t { Blade, Pen, Stylus };

/// How folds are made: rows of cuts, a line pressed with a stylus, a line cut half through.
enum class FoldMode : std::uint8_t { Perforate, Score, Light };

/// Settings of the tool for one kind of stroke.
struct ToolSettings {
  int tool{1};
  double force_gf{};
  double speed_mm_s{};
  int passes{1};
  double force_step_gf{};  ///< more force on each further pass
  ToolTip tip{ToolTip::Blade};
};

/// A row of the material table (core/data/materials.json, and users' own tables).
struct Material {
  std::string name;   ///< "paper-220"
  std::string title;  ///< "Paper, 220 gsm"
  double thickness_mm{};
  DashShape dashes;
  ToolSettings cut, fold, draw;
  std::optional<ToolSettings> score;  ///< a stylus or wheel; none: the material is not scored
  std::optional<ToolSettings> light;  ///< a cut that does not go through
  FoldMode folds{FoldMode::Perforate};
  double blade_offset_mm{0.9};
  double overcut_mm{0.5};         ///< beyond both ends of closed cuts
  double swivel_above_deg{15.0};  ///< corners above it are turned on an arc, where popcut does it
  int autoblade_depth{};          ///< 0..10, for machines that have one
  TabShape tabs;                  ///< that glue pieces of an oversized drawing
};

/// The blade offset that popcut has to compensate; 0 where the machine's firmware does it.
[[nodiscard]] double host_blade_offset_mm(const Machine& machine, const Material& material);

/// "perforate", "score", "light"
[[nodiscard]] const char* fold_mode_name(FoldMode mode);

/// Finds a material by name; tables and errors as `find_machine`.
[[nodiscard]] Result<Material> find_material(std::string_view name,
                                             const std::vector<std::string>& user_tables = {});
[[nodiscard]] Result<std::vector<Material>> all_materials(
    const std::vector<std::string>& user_tables = {});

}  // namespace popcut
