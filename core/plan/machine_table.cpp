// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "core/plan/json_fields.hpp"
#include "core/plan/machine.hpp"
#include "core/plan/near_names.hpp"
#include "core/plan/table.hpp"
#include "core/plan/tables.hpp"

namespace popcut {
namespace {

constexpr double kMaxLength = 100'000.0;  // mm; nothing that is cut is longer than 100 m

SteppedScale read_scale(const nlohmann::json& json, std::string pointer,
                        std::optional<Error>& fault) {
  SteppedScale scale;
  JsonFields fields(json, std::move(pointer), fault);
  fields.whole("min_step", scale.min_step, 0, 100'000);
  fields.whole("max_step", scale.max_step, scale.min_step, 100'000);
  fields.number("per_step", scale.per_step, 0.0, 10'000.0);
  fields.nothing_else();
  return scale;
}

Motion read_motion(const nlohmann::json& json, std::string pointer, std::optional<Error>& fault) {
  Motion motion;
  JsonFields fields(json, std::move(pointer), fault);
  fields.number("accel_mm_s2", motion.accel_mm_s2, 1.0, 1e6);
  fields.number("travel_mm_s", motion.travel_mm_s, 1.0, 1e5);
  fields.number("corner_mm", motion.corner_mm, 0.0, 10.0);
  fields.number("drop_s", motion.drop_s, 0.0, 60.0);
  fields.number("lift_s", motion.lift_s, 0.0, 60.0);
  fields.number("setup_s", motion.setup_s, 0.0, 600.0);
  fields.number("trailer_s", motion.trailer_s, 0.0, 600.0);
  fields.number("autoblade_reset_s", motion.autoblade_reset_s, 0.0, 600.0);
  fields.number("autoblade_tap_s", motion.autoblade_tap_s, 0.0, 60.0);
  fields.number("spread", motion.spread, 0.0, 0.9);
  fields.nothing_else();
  return motion;
}

std::vector<Mat> read_mats(const nlohmann::json& json, const std::string& pointer,
                           std::optional<Error>& fault) {
  std::vector<Mat> mats;
  for (std::size_t i = 0; i < json.size() && !fault; ++i) {
    Mat mat;
    JsonFields fields(json[i], fmt::format("{}/{}", pointer, i), fault);
    fields.text("name", mat.name);
    fields.whole("code", mat.code, 0, 1000);
    fields.number("width_mm", mat.width_mm, 1.0, kMaxLength);
    fields.number("length_mm", mat.length_mm, 1.0, kMaxLength);
    fields.nothing_else();
    mats.push_back(std::move(mat));
  }
  return mats;
}

void check_language(const Machine& machine, JsonFields& fields) {
  if (machine.language != "gpgl" && machine.language != "hpgl")
    fields.reject(ErrorKind::OutOfRange, fields.at("language"),
                  fmt::format("is {}; gpgl or hpgl", machine.language));
  const std::vector<std::string> variants{"classic", "cameo3", "cameo4", "generic"};
  for (const std::string& known : variants)
    if (machine.variant == known) return;
  fields.reject(ErrorKind::OutOfRange, fields.at("variant"),
                fmt::format("is {}; one of {}", machine.variant, fmt::join(variants, ", ")));
}

Result<Machine> read_machine(const TableRow& row) {
  Machine machine;
  std::optional<Error> fault;
  JsonFields fields(row.row, row.pointer, fault);
  fields.text("name", machine.name);
  fields.text("title", machine.title);
  fields.also("source");
  fields.text("language", machine.language);
  fields.text("variant", machine.variant);
  fields.number("unit_mm", machine.unit_mm, 1e-4, 1.0);
  fields.number("width_mm", machine.width_mm, 1.0, kMaxLength);
  fields.number("length_mm", machine.length_mm, 1.0, kMaxLength);
  fields.number("margin_left_mm", machine.margin_left_mm, -100.0, machine.width_mm / 2);
  fields.number("margin_top_mm", machine.margin_top_mm, -100.0, machine.length_mm / 2);
  fields.whole("tool_holders", machine.tool_holders, 1, 8);
  fields.flag("autoblade", machine.autoblade);
  fields.flag("firmware_blade_offset", machine.firmware_blade_offset);
  if (const auto* scale = fields.object("force_gf"))
    machine.force_gf = read_scale(*scale, fields.at("force_gf"), fault);
  if (const auto* scale = fields.object("speed_mm_s"))
    machine.speed_mm_s = read_scale(*scale, fields.at("speed_mm_s"), fault);
  if (const auto* motion = fields.object("motion"))
    machine.motion = read_motion(*motion, fields.at("motion"), fault);
  if (const auto* mats = fields.array("mats"))
    machine.mats = read_mats(*mats, fields.at("mats"), fault);
  fields.whole("buffer_bytes", machine.buffer_bytes, 64, 1 << 30);
  fields.whole("usb_vendor", machine.usb_vendor, 0, 0xFFFF);
  fields.whole("usb_product", machine.usb_product, 0, 0xFFFF);
  fields.text("identity", machine.identity);
  fields.flag("y_up", machine.y_up);
  fields.nothing_else();
  if (!fault) check_language(machine, fields);
  if (fault) return tl::unexpected(in_table(row, *fault));
  return machine;
}

}  // namespace

Result<std::vector<Machine>> all_machines(const std::vector<std::string>& user_tables) {
  const auto rows = table_rows("machines", kMachinesJson, user_tables);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<Machine> machines;
  for (const TableRow& row : *rows) {
    auto machine = read_machine(row);
    if (!machine) return tl::unexpected(machine.error());
    machines.push_back(std::move(*machine));
  }
  return machines;
}

Result<Machine> find_machine(std::string_view name, const std::vector<std::string>& user_tables) {
  auto machines = all_machines(user_tables);
  if (!machines) return tl::unexpected(machines.error());
  std::vector<std::string> names;
  for (Machine& machine : *machines) {
    if (machine.name == name) return std::move(machine);
    names.push_back(machine.name);
  }
  return fail(
      ErrorKind::OutOfRange, "",
      fmt::format("no machine is called {}; {}", name.substr(0, 80), suggestion(name, names)));
}

}  // namespace popcut
