// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// How a machine moves: speeds and tool times, for estimates and for the simulator.
struct Motion {
  double accel_mm_s2{};       ///< acceleration along the path, tool down and up
  double travel_mm_s{};       ///< speed with the tool up
  double corner_mm{};         ///< junction deviation that sets the speed through corners
  double drop_s{}, lift_s{};  ///< tool down, tool up
  double setup_s{};           ///< from sending the settings until the machine is ready
  double trailer_s{};         ///< from the end of the program until ready, without the move home
  double autoblade_reset_s{}, autoblade_tap_s{};  ///< the reset, and each of its (10 - depth) taps
  double swivel_mm_s{20.0};  ///< speed of the tip where the firmware turns the blade at a corner
  double spread{0.25};       ///< relative error of estimated times: 0.25 is 25 %
};

/// How a machine searches for the registration marks of a printed sheet.
struct MarkSearch {
  /// The search begins this far left of and above the corner where the marks are expected; below 0:
  /// right of it, or below.
  double before_left_mm{10}, before_top_mm{10};
  /// After a miss it begins so much lower than at first, once for each.
  std::vector<double> again_mm{};
  double sensor_mm_s{40};  ///< of the sensor along both sides of the marks' rectangle
  double longest_s{30};
};
inline constexpr double kFarthestSearchMm = 50.0;  ///< of a start, either way
inline constexpr std::size_t kMostSearches = 10;   ///< after a miss

/// A quantity that a machine sets in whole steps: `value = steps * per_step`.
struct SteppedScale {
  int min_step{}, max_step{};
  double per_step{};  ///< gf or mm/s per step; 0: the machine has no such setting
};

/// A carrier sheet (cutting mat) that a machine knows; `code` is the argument of its mat command.
struct Mat {
  std::string name;
  int code{};
  double width_mm{}, length_mm{};  ///< usable area, along carriage and feed
};

/// Along what a machine's first coordinate runs, the X of HPGL; the second runs along the other.
enum class Axes : std::uint8_t {
  FeedCarriage,  ///< along the feed, as on roll cutters and in GPGL
  CarriageFeed,  ///< along the carriage: flatbed cutters and desktop plotters
};
/// "feed-carriage", "carriage-feed"
[[nodiscard]] const char* axes_name(Axes axes);

/// What a person found for a material on one machine (`popcut calibrate`).
struct MaterialForce {
  std::string material;        ///< its name
  double cut_gf{};             ///< that its blade needs to cut through
  std::optional<int> depth{};  ///< of the autoblade
};

/// How folds are made: a row of cuts, a line pressed with a stylus, or a line cut half through.
enum class FoldMode : std::uint8_t { Perforate, Score, Light };

inline constexpr std::array<std::string_view, 3> kGpglVariants{"classic", "cameo3", "cameo4"};
/// Words for the dialects of HPGL machines; protocol/encode.hpp explains each.
inline constexpr std::array<std::string_view, 9> kHpglWords{
    "generic", "pa", "newline", "plain", "open", "negative", "ud", "camm1", "camm2"};

/// A row of the machine table (core/data/machines.json and the tables of users).
struct Machine {
  std::string name;      ///< "cameo3": used in --machine and sim:NAME
  std::string title;     ///< "Silhouette Cameo 3"
  std::string language;  ///< "gpgl" or "hpgl"; "cricut": Design Space takes a drawing; "hand": a
                         ///< person takes paper
  std::string variant;   ///< dialect of the language: one of kGpglVariants; for HPGL words of
                         ///< kHpglWords joined by "+"; empty for the others
  std::string source;    ///< where its figures come from, and which are not measured
  bool built_in{false};  ///< a row of popcut's own table, not replaced by a user's
  double unit_mm{0.05};
  double width_mm{}, length_mm{};  ///< largest area without a mat, along carriage and feed
  double margin_left_mm{}, margin_top_mm{};
  int tool_holders{1};
  bool autoblade{false};
  bool firmware_blade_offset{true};  ///< the firmware turns the blade at corners
  double blade_offset_mm{};          ///< of the blade in use; 0: take the material's
  SteppedScale force_gf;
  SteppedScale speed_mm_s;
  Motion motion;
  MarkSearch marks{};
  std::vector<Mat> mats;  ///< the first is the default
  std::uint32_t buffer_bytes{65536};
  std::uint16_t usb_vendor{}, usb_product{};
  std::string identity;  ///< reply to FG with its padding, without ETX; empty: never recorded
  Axes axes{Axes::FeedCarriage};
  /// The machine's coordinates are left-handed, seen from above; those of nearly all are
  /// right-handed.
  bool mirrored{false};
  /// What one mm that is sent comes out as, mm: 1 but for what `popcut calibrate` measured.
  double scale_carriage{1}, scale_feed{1};
  std::vector<MaterialForce> forces{};  ///< of the materials that were tried on it
  std::string calibrated{};             ///< the day of `popcut calibrate`; empty: never
  bool answers_limits{false};           ///< HPGL: it answers OH with the limits of its coordinates
  FoldMode folds{FoldMode::Perforate};  ///< how it folds; only where popcut does not drive it

  /// Whether its feed coordinate grows from the end of the page to its top. A page's x and y point
  /// right and down. So with right-handed coordinates, the feed grows downward exactly if it comes
  /// first; the other way round, the sheet would be a mirror image.
  [[nodiscard]] bool feed_up() const { return (axes == Axes::CarriageFeed) != mirrored; }
  /// Whether its coordinates may be negative.
  [[nodiscard]] bool takes_negative() const;
  /// Whether it reports which tool each holder has (ESC NAK).
  [[nodiscard]] bool reports_tools() const { return variant == "cameo4"; }
  /// Whether popcut writes programs for it and can move it.
  [[nodiscard]] bool driven() const { return language == "gpgl" || language == "hpgl"; }
};

/// The dashes of a perforated fold: cuts of `dash_mm` with `gap_mm` of paper between them. At least
/// `clearance_mm` of paper stays at both ends. No dash is shorter than `min_dash_mm`.
struct DashShape {
  double dash_mm{1.5};
  double gap_mm{1.0};
  double clearance_mm{0.5};
  double min_dash_mm{0.5};
};

/// What touches the sheet. The tip of a blade trails behind its axis; a pen and a stylus do not.
enum class ToolTip : std::uint8_t { Blade, Pen, Stylus };

/// Tool settings for one kind of stroke.
struct ToolSettings {
  int tool{1};
  double force_gf{};
  double speed_mm_s{};
  int passes{1};
  double force_step_gf{};  ///< force added on each further pass
  ToolTip tip{ToolTip::Blade};
};

/// Settings that a person gives for the lines of a colour or a layer, in place of those of what
/// the lines are for.
struct PenSettings {
  std::string name;  ///< as the person wrote it: "red", "layer Etch", "outline"
  std::optional<double> force_gf{}, speed_mm_s{}, force_step_gf{};
  std::optional<int> passes{}, tool{};

  /// `tool` with these settings.
  [[nodiscard]] ToolSettings over(ToolSettings tool) const;
};

/// Shape of a material's glue tabs. A tab is a trapezoid that lies flat under the panel beyond the
/// seam. Its root is the edge on the seam.
struct TabShape {
  double depth_mm{6.0};                 ///< depth where there is room
  double min_depth_mm{2.0};             ///< least depth: a shallower tab does not hold
  double side_rad{1.0471975511965976};  ///< angle between root and sides
  double pitch_mm{40.0};                ///< longest root
  double clearance_mm{0.5};  ///< free space at both ends of the root and to each line under the tab
  double min_root_mm{1.5};   ///< shortest root; roots too short for a trapezoid carry a triangle

  /// The shortest stretch of a seam that can hold a tab, mm.
  [[nodiscard]] double min_stretch_mm() const;
  friend bool operator==(const TabShape&, const TabShape&) = default;
};

/// A row of the material table (core/data/materials.json and the tables of users).
struct Material {
  std::string name;   ///< "paper-220"
  std::string title;  ///< "Paper, 220 gsm"
  double thickness_mm{};
  DashShape dashes;
  ToolSettings cut, fold, draw;
  std::optional<ToolSettings> score;  ///< stylus or wheel; none: this material cannot be scored
  std::optional<ToolSettings> light;  ///< a cut half through the material; none: not possible
  FoldMode folds{FoldMode::Perforate};
  double blade_offset_mm{0.9};
  double overcut_mm{0.5};         ///< how far closed cuts go on past their start
  double swivel_above_deg{15.0};  ///< where popcut turns the blade, sharper corners get an arc
  int autoblade_depth{};          ///< 0..10, for machines with an autoblade
  TabShape tabs;                  ///< glue tabs between the pieces of a split drawing
  std::vector<PenSettings> pens;  ///< of one job; `PenOperation::pen` counts them from 1
};

/// A material as this machine cuts it: with the force and depth that were found on it. The other
/// forces of blades change in proportion, those of pens and styluses do not.
[[nodiscard]] Material on_machine(Material material, const Machine& machine);

/// The blade offset in mm that popcut must compensate; 0 where the firmware does it.
[[nodiscard]] double host_blade_offset_mm(const Machine& machine, const Material& material);

/// "perforate", "score", "light"
[[nodiscard]] const char* fold_mode_name(FoldMode mode);

/// Finds a machine by name in the built-in table and in `user_tables` (JSON texts). A user's row
/// replaces a built-in row of the same name.
///
/// @retval OutOfRange  unknown name; the detail lists the names that are close
/// @retval Malformed   a user's table is not valid; place is a JSON pointer
[[nodiscard]] Result<Machine> find_machine(std::string_view name,
                                           const std::vector<std::string>& user_tables = {});
/// `find_machine` for one that popcut is to drive.
///
/// @retval OutOfRange  also a machine that is not `driven`; the detail says what to do instead
[[nodiscard]] Result<Machine> find_driven_machine(std::string_view name,
                                                  const std::vector<std::string>& user_tables = {});
/// What to do with a machine that is not `driven`, as an error without a place.
[[nodiscard]] Error not_driven(const Machine& machine);
/// The same for materials.
[[nodiscard]] Result<Material> find_material(std::string_view name,
                                             const std::vector<std::string>& user_tables = {});
/// All rows: the built-in ones, replaced and extended by those of `user_tables`.
[[nodiscard]] Result<std::vector<Machine>> all_machines(
    const std::vector<std::string>& user_tables = {});
[[nodiscard]] Result<std::vector<Material>> all_materials(
    const std::vector<std::string>& user_tables = {});

/// Checks that all sizes are within range.
///
/// @retval OutOfRange  a size is out of range; its place is `place`/FIELD
[[nodiscard]] Result<void> check_tab_shape(const TabShape& shape, const std::string& place);

}  // namespace popcut
