// SPDX-License-Identifier: MIT
#include "core/plan/pens.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/text/near_names.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

/// A setting: its name, its range, and where it goes.
struct PenField {
  std::string_view name;
  double least, most;
  bool whole;
  void (*set)(ToolSettings& tool, double value);
};

constexpr std::array<PenField, 5> kFields{{
    {"force", 0, 10'000, false, [](ToolSettings& t, double v) { t.force_gf = v; }},
    {"speed", 0.1, 10'000, false, [](ToolSettings& t, double v) { t.speed_mm_s = v; }},
    {"passes", 1, 20, true, [](ToolSettings& t, double v) { t.passes = static_cast<int>(v); }},
    {"step", -10'000, 10'000, false, [](ToolSettings& t, double v) { t.force_step_gf = v; }},
    {"tool", 1, 8, true, [](ToolSettings& t, double v) { t.tool = static_cast<int>(v); }},
}};

tl::unexpected<Error> wrong(std::string detail) {
  return fail(ErrorKind::Usage, "/options/pen",
              std::move(detail) + "; write for example \"cut: force=90 passes=2; fold: speed=20\"");
}

Result<void> set_field(ToolSettings& tool, std::string_view given, const std::string& pen,
                       std::set<std::string>& seen) {
  const std::size_t equals = given.find('=');
  const std::string_view name = given.substr(0, equals);
  const auto* field = std::find_if(kFields.begin(), kFields.end(),
                                   [&](const PenField& known) { return known.name == name; });
  if (equals == std::string_view::npos || field == kFields.end()) {
    std::vector<std::string> names;
    for (const PenField& known : kFields) names.emplace_back(known.name);
    return wrong(fmt::format("\"{}\" is no setting of {}; {}", given.substr(0, 40), pen,
                             suggestion(std::string(name.substr(0, 40)), names)));
  }
  if (!seen.insert(fmt::format("{}.{}", pen, name)).second)
    return wrong(fmt::format("gives {} of {} twice", name, pen));
  const std::string_view text = given.substr(equals + 1);
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = fault == std::errc() && end == text.data() + text.size();
  if (!number || !(value >= field->least && value <= field->most) ||
      (field->whole && value != std::floor(value)))
    return wrong(fmt::format("{} of {} is \"{}\"; give a {} from {:g} to {:g}", name, pen,
                             text.substr(0, 40), field->whole ? "whole number" : "number",
                             field->least, field->most));
  field->set(tool, value);
  return {};
}

}  // namespace

Result<Material> with_pens(Material material, std::string_view pens) {
  std::set<std::string> seen;
  while (!trimmed(pens).empty()) {
    const std::string_view part = trimmed(take_word(pens, ";"));
    if (part.empty()) continue;
    const std::size_t colon = part.find(':');
    const std::string pen(trimmed(part.substr(0, std::min(colon, std::size_t{40}))));
    const std::array<std::pair<std::string_view, ToolSettings*>, 5> tools{
        {{"cut", &material.cut},
         {"fold", &material.fold},
         {"draw", &material.draw},
         {"score", material.score ? &*material.score : nullptr},
         {"light", material.light ? &*material.light : nullptr}}};
    const auto* found = std::find_if(tools.begin(), tools.end(),
                                     [&](const auto& tool) { return tool.first == pen; });
    if (colon == std::string_view::npos || found == tools.end())
      return wrong(
          fmt::format("\"{}\" is not cut, fold, draw, score or light with a colon after it", pen));
    if (found->second == nullptr)
      return wrong(fmt::format("material {} has no {}", material.name, pen));
    std::string_view settings = part.substr(colon + 1);
    while (!trimmed(settings).empty()) {
      settings = trimmed(settings);
      const std::string_view one = take_word(settings, " ");
      if (const auto set = set_field(*found->second, one, pen, seen); !set)
        return tl::unexpected(set.error());
    }
  }
  return material;
}

}  // namespace popcut
