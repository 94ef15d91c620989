// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/machines/tab_shape.hpp"
#include "core/result.hpp"

namespace popcut {

/// How a machine moves: what its firmware does with speeds and the tool, for times and simulation.
struct Motion {
  double accel_mm_s2{};       ///< acceleration along the path, tool down and up
  double travel_mm_s{};       ///< speed with the tool up
  double corner_mm{};         ///< junction deviation that sets the speed through corners
  double drop_s{}, lift_s{};  ///< tool down, tool up
  double setup_s{};           ///< settings accepted until ready
  double trailer_s{};         ///< trailer accepted until ready, beyond the way home
  double autoblade_reset_s{}, autoblade_tap_s{};  ///< reset, and each of (10 - depth) taps
  double swivel_mm_s{20.0};  ///< of the tip, where the firmware turns the blade at a corner
  double spread{0.25};       ///< how far times may be off, as a part of them
};

/// A scale that a machine takes as whole steps: `value = steps * per_step`.
struct SteppedScale {
  int min_step{}, max_step{};
  double per_step{};  ///< gf or mm/s a step; 0: the machine has no such setting
};

/// A carrier sheet a machine knows; `code` is what its mat command wants.
struct Mat {
  std::string name;
  int code{};
  double width_mm{}, length_mm{};  ///< usable, along carriage and feed
};

inline constexpr std::array<std::string_view, 3> kGpglVariants{"classic", "cameo3", "cameo4"};
/// The habits of HPGL machines, which protocol/encode.hpp explains.
inline constexpr std::array<std::string_view, 9> kHpglWords{
    "generic", "pa", "newline", "plain", "open", "negative", "ud", "camm1", "camm2"};

/// A row of the machine table (core/data/machines.json, and users' own tables).
struct Machine {
  std::string name;      ///< "cameo3": what --machine and sim:NAME take
  std::string title;     ///< "Silhouette Cameo 3"
  std::string language;  ///< "gpgl" or "hpgl"
  std::string variant;   ///< dialect of the language: one of kGpglVariants; for HPGL words of
                         ///< kHpglWords joined by "+"
  double unit_mm{0.05};
  double width_mm{}, length_mm{};  ///< largest area along carriage and feed, without a mat
  double margin_left_mm{}, margin_top_mm{};
  int tool_holders{1};
  bool autoblade{false};
  bool firmware_blade_offset{true};  ///< the firmware swivels the blade itself
  double blade_offset_mm{};          ///< of the blade it is used with; 0: the material's
  SteppedScale force_gf;
  SteppedScale speed_mm_s;
  Motion motion;
  std::vector<Mat> mats;  ///< the first is the default
  std::uint32_t buffer_bytes{65536};
  std::uint16_t usb_vendor{}, usb_product{};
  std::string identity;  ///< reply to FG, blank padded as sent, without ETX; empty: never recorded
  bool y_up{false};      ///< origin lower left with y up (HPGL), else top left with y down
};

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

/// Finds a machine by name in the built-in table, or in `user_tables` (JSON texts), which win.
///
/// @retval OutOfRange  no such name; the detail lists the names that are near
/// @retval Malformed   a user's table is not of the table's form; place is a JSON pointer
[[nodiscard]] Result<Machine> find_machine(std::string_view name,
                                           const std::vector<std::string>& user_tables = {});
[[nodiscard]] Result<Material> find_material(std::string_view name,
                                             const std::vector<std::string>& user_tables = {});
[[nodiscard]] Result<std::vector<Machine>> all_machines(
    const std::vector<std::string>& user_tables = {});
[[nodiscard]] Result<std::vector<Material>> all_materials(
    const std::vector<std::string>& user_tables = {});

}  // namespace popcut
