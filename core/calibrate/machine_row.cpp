// SPDX-License-Identifier: MIT
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/calibrate/measured.hpp"
#include "core/text/json_text.hpp"

// Part of core/calibrate/measured.hpp.

namespace popcut::calibrate {
namespace {

using Json = nlohmann::ordered_json;

/// Digits beyond what was measured say nothing.
double rounded(double value, double step) { return std::round(value / step) * step; }

double digits(double value) {
  if (value == 0) return 0;
  const double step = std::pow(10, std::floor(std::log10(std::abs(value))) - 3);
  // As text and back: 0.1234 and not 0.12340000000000001.
  return std::stod(fmt::format("{:.6g}", rounded(value, step)));
}

double hundredths(double value) { return std::stod(fmt::format("{:.2f}", value)); }

Json motion_json(const Motion& motion) {
  return {{"accel_mm_s2", digits(motion.accel_mm_s2)},
          {"travel_mm_s", digits(motion.travel_mm_s)},
          {"corner_mm", digits(motion.corner_mm)},
          {"swivel_mm_s", digits(motion.swivel_mm_s)},
          {"drop_s", digits(motion.drop_s)},
          {"lift_s", digits(motion.lift_s)},
          {"setup_s", digits(motion.setup_s)},
          {"trailer_s", digits(motion.trailer_s)},
          {"spread", digits(motion.spread)}};
}

Json forces_json(const std::vector<MaterialForce>& forces) {
  Json list = Json::array();
  for (const MaterialForce& force : forces) {
    Json one{{"material", force.material}, {"cut_gf", digits(force.cut_gf)}};
    if (force.depth) one["depth"] = *force.depth;
    list.push_back(std::move(one));
  }
  return list;
}

}  // namespace

std::string machine_row(const Machine& machine, const Machine& before, const Measured& measured) {
  Json row{{"name", machine.name}, {"like", before.name}};
  std::vector<std::string_view> what;
  const auto note = [&](bool done, std::string_view name) {
    if (done) what.push_back(name);
    return done;
  };
  row["source"] = "";
  if (note(measured.axes, "axes") && machine.language == "hpgl") {
    row["axes"] = axes_name(machine.axes);
    row["mirrored"] = machine.mirrored;
  }
  if (note(measured.places, "margins and scale")) {
    row["margin_left_mm"] = hundredths(machine.margin_left_mm);
    row["margin_top_mm"] = hundredths(machine.margin_top_mm);
    row["scale"] = {{"carriage", std::stod(fmt::format("{:.5f}", machine.scale_carriage))},
                    {"feed", std::stod(fmt::format("{:.5f}", machine.scale_feed))}};
  }
  if (note(measured.motion, "motion")) {
    if (machine.speed_mm_s.per_step > 0)
      row["speed_mm_s"] = {{"per_step", digits(machine.speed_mm_s.per_step)}};
    row["motion"] = motion_json(machine.motion);
  }
  if (note(measured.force, "force")) row["forces"] = forces_json(machine.forces);
  row["calibrated"] = machine.calibrated;
  row["source"] =
      fmt::format("Measured with popcut calibrate on {}: {}. {}", machine.calibrated,
                  fmt::join(what, ", "), before.calibrated.empty() ? before.source : "");
  return row.dump(2);
}

Result<std::string> table_with(const std::string& table, const std::string& row) {
  Json whole{{"popcut", 1}, {"machines", Json::array()}};
  if (!table.empty()) {
    // Checked without order of the fields, kept with it.
    if (const auto valid = parse_json(table, 16); !valid) return tl::unexpected(valid.error());
    whole = Json::parse(table, nullptr, false);
    if (!whole.is_object()) return fail(ErrorKind::Malformed, "", "must be an object");
    if (!whole.contains("machines")) whole["machines"] = Json::array();
    if (!whole["machines"].is_array())
      return fail(ErrorKind::Malformed, "/machines", "must be a list of rows");
  }
  Json added = Json::parse(row, nullptr, false);
  for (Json& present : whole["machines"]) {
    if (!present.is_object() || present.value("name", "") != added["name"]) continue;
    if (present.contains("like"))
      added["like"] = present["like"];
    else
      added.erase("like");
    for (const auto& [key, value] : added.items()) {
      if (present.contains(key) && present[key].is_object() && value.is_object())
        present[key].update(value);
      else
        present[key] = value;
    }
    return whole.dump(2) + "\n";
  }
  whole["machines"].push_back(std::move(added));
  return whole.dump(2) + "\n";
}

}  // namespace popcut::calibrate
