// SPDX-License-Identifier: MIT
#include <algorithm>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "core/machines/machine.hpp"
#include "core/machines/table.hpp"
#include "core/machines/tables.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/near_names.hpp"

namespace popcut {
namespace {

constexpr double kMaxLength = 100'000.0;  // mm; nothing that is cut is longer than 100 m

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

Mat read_mat(FieldReader& fields) {
  Mat mat;
  mat.name = fields.text("name", {});
  mat.code = fields.integer("code", {}, 0, 1000);
  mat.width_mm = fields.number("width_mm", {}, 1.0, kMaxLength);
  mat.length_mm = fields.number("length_mm", {}, 1.0, kMaxLength);
  return mat;
}

void read_place(FieldReader& fields, Machine& machine) {
  machine.unit_mm = fields.number("unit_mm", {}, 1e-4, 1.0);
  machine.width_mm = fields.number("width_mm", {}, 1.0, kMaxLength);
  machine.length_mm = fields.number("length_mm", {}, 1.0, kMaxLength);
  machine.margin_left_mm = fields.number("margin_left_mm", {}, -100.0, machine.width_mm / 2);
  machine.margin_top_mm = fields.number("margin_top_mm", {}, -100.0, machine.length_mm / 2);
  fields.objects("mats", [&](FieldReader& mat) { machine.mats.push_back(read_mat(mat)); });
  machine.y_up = fields.boolean("y_up", false);
}

// A variant of GPGL, or habits of an HPGL machine: words joined by "+".
void read_variant(FieldReader& fields, Machine& machine) {
  machine.variant = fields.text("variant", {});
  const bool hpgl = machine.language == "hpgl";
  const auto known = hpgl ? std::span<const std::string_view>(kHpglWords) : kGpglVariants;
  std::string_view rest = machine.variant;
  for (bool more = true; more;) {
    const std::string_view word = hpgl ? rest.substr(0, rest.find('+')) : rest;
    more = word.size() < rest.size();
    if (more) rest.remove_prefix(word.size() + 1);
    if (std::find(known.begin(), known.end(), word) != known.end()) continue;
    fields.refuse("variant", ErrorKind::OutOfRange,
                  fmt::format("\"{}\" is not a variant of {}; {}{}", word.substr(0, 40),
                              hpgl ? "HPGL" : "GPGL", fmt::join(known, ", "),
                              hpgl ? " are known, joined by +" : " are known"));
    return;
  }
}

Result<Machine> read_machine(const TableRow& row) {
  Machine machine;
  FieldReader fields(row.row, row.pointer);
  machine.name = fields.text("name", {});
  machine.title = fields.text("title", {});
  fields.value("source");
  const std::vector<std::string> languages{"gpgl", "hpgl"};
  machine.language = languages[fields.word("language", 0, languages)];
  read_variant(fields, machine);
  read_place(fields, machine);
  machine.tool_holders = fields.integer("tool_holders", {}, 1, 8);
  machine.autoblade = fields.boolean("autoblade", false);
  machine.firmware_blade_offset = fields.boolean("firmware_blade_offset", true);
  machine.blade_offset_mm = fields.number("blade_offset_mm", 0.0, 0.0, 5.0);
  fields.object("force_gf", [&](FieldReader& inner) { machine.force_gf = read_scale(inner); });
  fields.object("speed_mm_s", [&](FieldReader& inner) { machine.speed_mm_s = read_scale(inner); });
  fields.object("motion", [&](FieldReader& inner) { machine.motion = read_motion(inner); });
  machine.buffer_bytes =
      static_cast<std::uint32_t>(fields.integer("buffer_bytes", {}, 64, 1 << 30));
  machine.usb_vendor = static_cast<std::uint16_t>(fields.integer("usb_vendor", 0, 0, 0xFFFF));
  machine.usb_product = static_cast<std::uint16_t>(fields.integer("usb_product", 0, 0, 0xFFFF));
  machine.identity = fields.text("identity", "");
  if (const auto whole = fields.finish(); !whole)
    return tl::unexpected(in_table(row, whole.error()));
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
