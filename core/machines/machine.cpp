// SPDX-License-Identifier: MIT
#include "core/machines/machine.hpp"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/machines/table.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr double kMaxLength = 100'000.0;  // mm; no sheet is longer than 100 m

SteppedScale read_scale(FieldReader& fields) {
  SteppedScale scale;
  scale.min_step = fields.integer("min_step", {}, 0, 100'000);
  scale.max_step = fields.integer("max_step", {}, scale.min_step, 100'000);
  scale.per_step = fields.number("per_step", {}, 0.0, 10'000.0);
  return scale;
}

Motion read_motion(FieldReader& fields) {
  Motion motion;
  motion.accel_mm_s2 = fields.number("accel_mm_s2", {}, 1.0, 1e6);
  motion.travel_mm_s = fields.number("travel_mm_s", {}, 1.0, 1e5);
  motion.corner_mm = fields.number("corner_mm", {}, 0.0, 10.0);
  motion.drop_s = fields.number("drop_s", {}, 0.0, 60.0);
  motion.lift_s = fields.number("lift_s", {}, 0.0, 60.0);
  motion.setup_s = fields.number("setup_s", {}, 0.0, 600.0);
  motion.trailer_s = fields.number("trailer_s", {}, 0.0, 600.0);
  motion.autoblade_reset_s = fields.number("autoblade_reset_s", {}, 0.0, 600.0);
  motion.autoblade_tap_s = fields.number("autoblade_tap_s", {}, 0.0, 60.0);
  motion.swivel_mm_s = fields.number("swivel_mm_s", 20.0, 0.1, 10'000.0);
  motion.spread = fields.number("spread", {}, 0.0, 0.9);
  return motion;
}

MarkSearch read_marks(FieldReader& fields) {
  MarkSearch marks;
  marks.before_left_mm =
      fields.number("before_left_mm", marks.before_left_mm, -kFarthestSearchMm, kFarthestSearchMm);
  marks.before_top_mm =
      fields.number("before_top_mm", marks.before_top_mm, -kFarthestSearchMm, kFarthestSearchMm);
  if (const nlohmann::json* again = fields.value("again_mm"); again != nullptr) {
    const auto is_valid = [](const nlohmann::json& mm) {
      return mm.is_number() && std::abs(mm.get<double>()) <= kFarthestSearchMm;
    };
    if (again->is_array() && again->size() <= kMostSearches &&
        std::all_of(again->begin(), again->end(), is_valid))
      marks.again_mm = again->get<std::vector<double>>();
    else
      fields.refuse("again_mm", ErrorKind::OutOfRange,
                    fmt::format("must be a list of at most {} numbers from {:g} to {:g}",
                                kMostSearches, -kFarthestSearchMm, kFarthestSearchMm));
  }
  marks.sensor_mm_s = fields.number("sensor_mm_s", marks.sensor_mm_s, 1.0, 10'000.0);
  marks.longest_s = fields.number("longest_s", marks.longest_s, 0.0, 600.0);
  return marks;
}

Mat read_mat(FieldReader& fields, bool driven) {
  Mat mat;
  mat.name = fields.text("name", {});
  mat.code = driven ? fields.integer("code", {}, 0, 1000) : 0;
  mat.width_mm = fields.number("width_mm", {}, 1.0, kMaxLength);
  mat.length_mm = fields.number("length_mm", {}, 1.0, kMaxLength);
  return mat;
}

void read_size(FieldReader& fields, Machine& machine) {
  machine.width_mm = fields.number("width_mm", {}, 1.0, kMaxLength);
  machine.length_mm = fields.number("length_mm", {}, 1.0, kMaxLength);
  fields.objects(
      "mats", [&](FieldReader& mat) { machine.mats.push_back(read_mat(mat, machine.driven())); });
}

void read_place(FieldReader& fields, Machine& machine) {
  machine.unit_mm = fields.number("unit_mm", {}, 1e-4, 1.0);
  machine.margin_left_mm = fields.number("margin_left_mm", {}, -100.0, machine.width_mm / 2);
  machine.margin_top_mm = fields.number("margin_top_mm", {}, -100.0, machine.length_mm / 2);
  const std::vector<std::string> axes{"feed-carriage", "carriage-feed"};
  machine.axes = static_cast<Axes>(fields.word("axes", 0, axes));
  machine.mirrored = fields.boolean("mirrored", false);
  fields.optional_object("scale", [&](FieldReader& inner) {
    machine.scale_carriage = inner.number("carriage", 1.0, 0.8, 1.25);
    machine.scale_feed = inner.number("feed", 1.0, 0.8, 1.25);
  });
  const bool gpgl = machine.language == "gpgl";
  if (gpgl && machine.axes != Axes::FeedCarriage)
    fields.refuse("axes", ErrorKind::OutOfRange,
                  "is carriage-feed, but GPGL names the feed first; use feed-carriage");
  if (gpgl && machine.mirrored)
    fields.refuse("mirrored", ErrorKind::OutOfRange,
                  "is true, but no GPGL machine mirrors its sheet; use false");
  if (fields.boolean("y_up", false))
    fields.refuse("y_up", ErrorKind::OutOfRange,
                  "is no longer used; for an origin at the lower left with x along the carriage, "
                  "use \"axes\": \"carriage-feed\"");
}

// What lies outside of the machine's window could never be cut.
void check_window(FieldReader& fields, const Machine& machine) {
  for (const Mat& mat : machine.mats)
    if (mat.width_mm > machine.width_mm || mat.length_mm > machine.length_mm)
      fields.refuse(
          "mats", ErrorKind::OutOfRange,
          fmt::format("mat {} is {:g} x {:g} mm, larger than the machine's {:g} x {:g} "
                      "mm; correct the mat, or width_mm and length_mm",
                      mat.name, mat.width_mm, mat.length_mm, machine.width_mm, machine.length_mm));
  const auto check_margin = [&](const char* name, double margin_mm) {
    if (margin_mm < 0 && !machine.takes_negative())
      fields.refuse(name, ErrorKind::OutOfRange,
                    fmt::format("is {:g}, but variant {} takes no negative coordinates; use 0 or "
                                "more, or add +negative to the variant",
                                margin_mm, machine.variant));
  };
  check_margin("margin_left_mm", machine.margin_left_mm);
  check_margin("margin_top_mm", machine.margin_top_mm);
}

// A variant of GPGL, or the variants of an HPGL machine: words joined by "+".
void read_variant(FieldReader& fields, Machine& machine) {
  machine.variant = fields.text("variant", {});
  const bool hpgl = machine.language == "hpgl";
  const auto known = hpgl ? std::span<const std::string_view>(kHpglWords) : kGpglVariants;
  std::string_view rest = machine.variant;
  for (bool more = true; more;) {
    more = hpgl && rest.find('+') != std::string_view::npos;
    const std::string_view word = hpgl ? take_word(rest, "+") : rest;
    if (std::find(known.begin(), known.end(), word) != known.end()) continue;
    fields.refuse("variant", ErrorKind::OutOfRange,
                  fmt::format("\"{}\" is not a variant of {}; use {}{}", word.substr(0, 40),
                              hpgl ? "HPGL" : "GPGL", fmt::join(known, ", "),
                              hpgl ? " (join several with +)" : ""));
    return;
  }
}

// What popcut must know of a machine to move it.
void read_driving(FieldReader& fields, Machine& machine) {
  read_variant(fields, machine);
  read_place(fields, machine);
  check_window(fields, machine);
  machine.tool_holders = fields.integer("tool_holders", {}, 1, 8);
  machine.autoblade = fields.boolean("autoblade", false);
  machine.firmware_blade_offset = fields.boolean("firmware_blade_offset", true);
  machine.blade_offset_mm = fields.number("blade_offset_mm", 0.0, 0.0, 5.0);
  fields.object("force_gf", [&](FieldReader& inner) { machine.force_gf = read_scale(inner); });
  fields.object("speed_mm_s", [&](FieldReader& inner) { machine.speed_mm_s = read_scale(inner); });
  fields.object("motion", [&](FieldReader& inner) { machine.motion = read_motion(inner); });
  fields.optional_object("marks", [&](FieldReader& inner) { machine.marks = read_marks(inner); });
  machine.buffer_bytes =
      static_cast<std::uint32_t>(fields.integer("buffer_bytes", {}, 64, 1 << 30));
  machine.usb_vendor = static_cast<std::uint16_t>(fields.integer("usb_vendor", 0, 0, 0xFFFF));
  machine.usb_product = static_cast<std::uint16_t>(fields.integer("usb_product", 0, 0, 0xFFFF));
  machine.identity = fields.text("identity", "");
  fields.optional_objects(
      "forces",
      [&](FieldReader& inner) {
        MaterialForce force;
        force.material = inner.text("material", {});
        force.cut_gf = inner.number("cut_gf", {}, 0.0, 10'000.0, true);
        if (const auto depth = inner.optional_integer("depth", 0, 10))
          force.depth = static_cast<int>(*depth);
        machine.forces.push_back(std::move(force));
      },
      1000);
  machine.calibrated = fields.text("calibrated", "");
  machine.answers_limits = fields.boolean("answers_limits", false);
  if (machine.answers_limits && machine.language != "hpgl")
    fields.refuse("answers_limits", ErrorKind::OutOfRange,
                  "is true, but only HPGL machines are asked OH; remove it");
}

Result<Machine> read_machine(const TableRow& row) {
  Machine machine;
  FieldReader fields(row.row, row.pointer);
  machine.name = fields.text("name", {});
  machine.title = fields.text("title", {});
  machine.source = fields.text("source", "");
  machine.built_in = row.table < 0;
  const std::vector<std::string> languages{"gpgl", "hpgl", "cricut", "hand"};
  machine.language = languages[fields.word("language", 0, languages)];
  read_size(fields, machine);
  if (machine.driven()) {
    read_driving(fields, machine);
  } else {
    machine.folds = static_cast<FoldMode>(fields.word("folds", 1, {"perforate", "score"}));
    machine.tool_holders = 2;
  }
  if (const auto whole = fields.finish(); !whole)
    return tl::unexpected(in_table(row, whole.error()));
  return machine;
}

DashShape read_dashes(FieldReader& fields) {
  DashShape dashes;
  dashes.dash_mm = fields.number("dash_mm", {}, 0.05, 100.0);
  dashes.gap_mm = fields.number("gap_mm", {}, 0.05, 100.0);
  dashes.clearance_mm = fields.number("clearance_mm", {}, 0.0, 100.0);
  dashes.min_dash_mm = fields.number("min_dash_mm", {}, 0.01, dashes.dash_mm);
  return dashes;
}

ToolSettings read_tool(FieldReader& fields, ToolTip usual) {
  ToolSettings tool;
  tool.tool = fields.integer("tool", {}, 1, 8);
  tool.force_gf = fields.number("force_gf", {}, 0.0, 10'000.0);
  tool.speed_mm_s = fields.number("speed_mm_s", {}, 0.1, 10'000.0);
  tool.passes = fields.integer("passes", {}, 1, 20);
  tool.force_step_gf = fields.number("force_step_gf", 0.0, -10'000.0, 10'000.0);
  tool.tip = static_cast<ToolTip>(
      fields.word("tip", static_cast<std::size_t>(usual), {"blade", "pen", "stylus"}));
  return tool;
}

std::optional<ToolSettings> read_optional_tool(FieldReader& fields, const char* name,
                                               ToolTip usual) {
  const nlohmann::json* given = fields.value(name);
  if (given == nullptr || given->is_null()) return std::nullopt;
  std::optional<ToolSettings> tool;
  fields.object(name, [&](FieldReader& inner) { tool = read_tool(inner, usual); });
  return tool;
}

void read_folds(FieldReader& fields, Material& material) {
  material.folds = static_cast<FoldMode>(fields.word("folds", 0, {"perforate", "score", "light"}));
  const bool missing = (material.folds == FoldMode::Score && !material.score) ||
                       (material.folds == FoldMode::Light && !material.light);
  if (missing)
    fields.refuse("folds", ErrorKind::Malformed,
                  fmt::format("is {0}, but this material has no settings \"{0}\"; add them",
                              fold_mode_name(material.folds)));
}

TabShape read_tabs(FieldReader& fields) {
  TabShape tabs;
  tabs.depth_mm = fields.number("depth_mm", tabs.depth_mm, 0.5, 200.0);
  tabs.min_depth_mm =
      fields.number("min_depth_mm", std::min(tabs.min_depth_mm, tabs.depth_mm), 0.2, tabs.depth_mm);
  tabs.side_rad = radians(fields.number("side_deg", degrees(tabs.side_rad), 20.0, 89.9));
  tabs.pitch_mm = fields.number("pitch_mm", tabs.pitch_mm, 5.0, 10'000.0);
  tabs.clearance_mm = fields.number("clearance_mm", tabs.clearance_mm, 0.0, tabs.pitch_mm / 4);
  tabs.min_root_mm = fields.number("min_root_mm", tabs.min_root_mm, 0.2, tabs.pitch_mm / 4);
  return tabs;
}

Result<Material> read_material(const TableRow& row) {
  Material material;
  FieldReader fields(row.row, row.pointer);
  material.name = fields.text("name", {});
  material.title = fields.text("title", {});
  fields.value("source");
  material.thickness_mm = fields.number("thickness_mm", {}, 0.001, 20.0);
  fields.object("dashes", [&](FieldReader& inner) { material.dashes = read_dashes(inner); });
  const auto read_blade = [](FieldReader& inner) { return read_tool(inner, ToolTip::Blade); };
  fields.object("cut", [&](FieldReader& inner) { material.cut = read_blade(inner); });
  fields.object("fold", [&](FieldReader& inner) { material.fold = read_blade(inner); });
  fields.object("draw",
                [&](FieldReader& inner) { material.draw = read_tool(inner, ToolTip::Pen); });
  material.score = read_optional_tool(fields, "score", ToolTip::Stylus);
  material.light = read_optional_tool(fields, "light", ToolTip::Blade);
  read_folds(fields, material);
  material.overcut_mm = fields.number("overcut_mm", 0.5, 0.0, 10.0);
  material.swivel_above_deg = fields.number("swivel_above_deg", 15.0, 1.0, 90.0);
  material.blade_offset_mm = fields.number("blade_offset_mm", {}, 0.0, 5.0);
  material.autoblade_depth = fields.integer("autoblade_depth", {}, 0, 10);
  fields.optional_object("tabs", [&](FieldReader& inner) { material.tabs = read_tabs(inner); });
  if (const auto whole = fields.finish(); !whole)
    return tl::unexpected(in_table(row, whole.error()));
  return material;
}

}  // namespace

Result<std::vector<Machine>> all_machines(const std::vector<std::string>& user_tables) {
  static const auto built_in = table_values("machines", kMachinesJson, {}, read_machine);
  return user_tables.empty() ? built_in
                             : table_values("machines", kMachinesJson, user_tables, read_machine);
}

Result<Machine> find_machine(std::string_view name, const std::vector<std::string>& user_tables) {
  return value_named(name, all_machines(user_tables), "machine");
}

Error not_driven(const Machine& machine) {
  const std::string how =
      machine.language == "cricut"
          ? fmt::format("'popcut plan FILE -o sheets --machine {}' writes the drawing for it",
                        machine.name)
          : fmt::format("'popcut plan FILE -o sheets --machine {}' writes pages to print",
                        machine.name);
  return {ErrorKind::OutOfRange, "",
          fmt::format("{} takes no programs from popcut; {}, or choose a machine with gpgl or hpgl "
                      "in 'popcut machines'",
                      machine.title, how)};
}

Result<Machine> find_driven_machine(std::string_view name,
                                    const std::vector<std::string>& user_tables) {
  auto machine = find_machine(name, user_tables);
  if (machine && !machine->driven()) return tl::unexpected(not_driven(*machine));
  return machine;
}

// The words of a variant (see kHpglWords) say it; in GPGL they always may.
bool Machine::takes_negative() const {
  const auto has = [&](const char* word) { return variant.find(word) != std::string::npos; };
  return language == "gpgl" || has("negative") || has("camm");
}

ToolSettings PenSettings::over(ToolSettings with) const {
  with.force_gf = force_gf.value_or(with.force_gf);
  with.speed_mm_s = speed_mm_s.value_or(with.speed_mm_s);
  with.force_step_gf = force_step_gf.value_or(with.force_step_gf);
  with.passes = passes.value_or(with.passes);
  with.tool = tool.value_or(with.tool);
  return with;
}

Material on_machine(Material material, const Machine& machine) {
  const auto found =
      std::find_if(machine.forces.rbegin(), machine.forces.rend(),
                   [&](const MaterialForce& force) { return force.material == material.name; });
  if (found == machine.forces.rend()) return material;
  const double ratio = material.cut.force_gf > 0 ? found->cut_gf / material.cut.force_gf : 1;
  const auto change = [&](ToolSettings& tool) {
    if (tool.tip != ToolTip::Blade) return;
    tool.force_gf *= ratio;
    tool.force_step_gf *= ratio;
  };
  for (ToolSettings* tool : {&material.cut, &material.fold, &material.draw}) change(*tool);
  if (material.score) change(*material.score);
  if (material.light) change(*material.light);
  if (found->depth) material.autoblade_depth = *found->depth;
  return material;
}

double host_blade_offset_mm(const Machine& machine, const Material& material) {
  if (machine.firmware_blade_offset) return 0.0;
  return machine.blade_offset_mm > 0.0 ? machine.blade_offset_mm : material.blade_offset_mm;
}

const char* axes_name(Axes axes) {
  return axes == Axes::FeedCarriage ? "feed-carriage" : "carriage-feed";
}

const char* fold_mode_name(FoldMode mode) {
  constexpr std::array kNames{"perforate", "score", "light"};
  return kNames[static_cast<std::size_t>(mode)];
}

Result<std::vector<Material>> all_materials(const std::vector<std::string>& user_tables) {
  static const auto built_in = table_values("materials", kMaterialsJson, {}, read_material);
  return user_tables.empty()
             ? built_in
             : table_values("materials", kMaterialsJson, user_tables, read_material);
}

Result<Material> find_material(std::string_view name, const std::vector<std::string>& user_tables) {
  return value_named(name, all_materials(user_tables), "material");
}

double TabShape::min_stretch_mm() const { return min_root_mm + 2 * clearance_mm; }

Result<void> check_tab_shape(const TabShape& shape, const std::string& place) {
  const auto wrong = [&](const char* field, double value, const char* right) {
    return fail(ErrorKind::OutOfRange, place + "/" + field,
                fmt::format("{:g} is out of range; use {}", value, right));
  };
  if (!(shape.depth_mm > 0.0 && shape.depth_mm <= 200.0))
    return wrong("depth_mm", shape.depth_mm, "more than 0 and at most 200 mm");
  if (!(shape.min_depth_mm > 0.0 && shape.min_depth_mm <= shape.depth_mm))
    return wrong("min_depth_mm", shape.min_depth_mm, "more than 0 and at most depth_mm");
  if (!(shape.side_rad >= 0.3 && shape.side_rad <= 1.5707))
    return wrong("side_deg", degrees(shape.side_rad), "18 to 89.9 degrees");
  if (!(shape.pitch_mm >= 5.0 && shape.pitch_mm <= 10000.0))
    return wrong("pitch_mm", shape.pitch_mm, "5 to 10000 mm");
  if (!(shape.clearance_mm >= 0.0 && shape.clearance_mm <= 20.0))
    return wrong("clearance_mm", shape.clearance_mm, "0 to 20 mm");
  if (!(shape.min_root_mm > 0.0 && shape.min_root_mm <= shape.pitch_mm))
    return wrong("min_root_mm", shape.min_root_mm, "more than 0 and at most pitch_mm");
  if (shape.min_stretch_mm() > shape.pitch_mm)
    return wrong("pitch_mm", shape.pitch_mm, "more than min_root_mm plus both clearances");
  return {};
}

}  // namespace popcut
