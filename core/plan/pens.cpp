// SPDX-License-Identifier: MIT
#include "core/plan/pens.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
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
  void (*set)(PenSettings& pen, double value);
};

constexpr std::array<PenField, 5> kFields{{
    {"force", 0, 10'000, false, [](PenSettings& p, double v) { p.force_gf = v; }},
    {"speed", 0.1, 10'000, false, [](PenSettings& p, double v) { p.speed_mm_s = v; }},
    {"passes", 1, 20, true, [](PenSettings& p, double v) { p.passes = static_cast<int>(v); }},
    {"step", -10'000, 10'000, false, [](PenSettings& p, double v) { p.force_step_gf = v; }},
    {"tool", 1, 8, true, [](PenSettings& p, double v) { p.tool = static_cast<int>(v); }},
}};

constexpr std::array<std::string_view, 5> kTools{"cut", "fold", "draw", "score", "light"};

/// What stands before the last colon of a part: layers may have colons in their names.
std::string name_of(std::string_view part) {
  return std::string(trimmed(part.substr(0, part.rfind(':'))));
}

bool is_tool(std::string_view name) {
  return std::find(kTools.begin(), kTools.end(), name) != kTools.end();
}

/// The tool of the material that is called `name`; null if the material has none.
ToolSettings* tool_of(Material& material, std::string_view name) {
  if (name == "cut") return &material.cut;
  if (name == "fold") return &material.fold;
  if (name == "draw") return &material.draw;
  auto& tool = name == "score" ? material.score : material.light;
  return tool ? &*tool : nullptr;
}

/// The operation that a pen's name says; none for colours and layers.
std::optional<Operation> operation_of(std::string_view name) {
  if (name == "mountain") return Operation::FoldMountain;
  if (name == "valley") return Operation::FoldValley;
  if (name == "outline") return Operation::Outline;
  return std::nullopt;
}

tl::unexpected<Error> wrong(std::string detail) {
  return fail(ErrorKind::Usage, "/options/pen",
              std::move(detail) + "; write for example \"cut: force=90 passes=2; fold: speed=20\"");
}

Result<void> set_field(PenSettings& pen, std::string_view given, std::set<std::string>& seen) {
  const std::size_t equals = given.find('=');
  const std::string_view name = given.substr(0, equals);
  const auto* field = std::find_if(kFields.begin(), kFields.end(),
                                   [&](const PenField& known) { return known.name == name; });
  if (equals == std::string_view::npos || field == kFields.end()) {
    std::vector<std::string> names;
    names.reserve(kFields.size());
    for (const PenField& known : kFields) names.emplace_back(known.name);
    return wrong(fmt::format("\"{}\" is no setting of {}; {}", given.substr(0, 40), pen.name,
                             suggestion(std::string(name.substr(0, 40)), names)));
  }
  if (!seen.insert(std::string(name)).second)
    return wrong(fmt::format("gives {} of {} twice", name, pen.name));
  const std::string_view text = given.substr(equals + 1);
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = fault == std::errc() && end == text.data() + text.size();
  if (!number || !(value >= field->least && value <= field->most) ||
      (field->whole && value != std::floor(value)))
    return wrong(fmt::format("{} of {} is \"{}\"; give a {} from {:g} to {:g}", name, pen.name,
                             text.substr(0, 40), field->whole ? "whole number" : "number",
                             field->least, field->most));
  field->set(pen, value);
  return {};
}

}  // namespace

std::vector<std::string> named_pens(std::string_view pens) {
  std::vector<std::string> names;
  while (!trimmed(pens).empty()) {
    const std::string_view part = trimmed(take_word(pens, ";"));
    if (part.empty()) continue;
    std::string name = name_of(part);
    if (is_tool(name) || std::find(names.begin(), names.end(), name) != names.end()) continue;
    names.push_back(std::move(name));
  }
  return names;
}

Result<Material> with_pens(Material material, std::string_view pens) {
  std::map<std::string, std::set<std::string>> seen;
  const auto find = [&](const std::string& name) {
    return std::find_if(material.pens.begin(), material.pens.end(),
                        [&](const PenSettings& pen) { return pen.name == name; });
  };
  for (std::string& name : named_pens(pens))
    if (find(name) == material.pens.end()) material.pens.push_back({.name = std::move(name)});
  if (material.pens.size() > kMostPens)
    return wrong(
        fmt::format("has {} colours and layers; give at most {}", material.pens.size(), kMostPens));
  while (!trimmed(pens).empty()) {
    const std::string_view part = trimmed(take_word(pens, ";"));
    if (part.empty()) continue;
    PenSettings given{.name = name_of(part)};
    if (part.rfind(':') == std::string_view::npos || given.name.empty())
      return wrong(
          fmt::format("\"{}\" has no name with a colon after it: cut, fold, draw, score, "
                      "light, mountain, valley, outline, a colour or a layer",
                      part.substr(0, 40)));
    const auto pen = find(given.name);
    ToolSettings* tool = pen == material.pens.end() ? tool_of(material, given.name) : nullptr;
    if (pen == material.pens.end() && tool == nullptr)
      return wrong(fmt::format("material {} has no {}", material.name, given.name));
    if (tool == nullptr) given = *pen;
    std::string_view settings = part.substr(part.rfind(':') + 1);
    while (!trimmed(settings).empty()) {
      settings = trimmed(settings);
      const std::string_view one = take_word(settings, " ");
      if (const auto set = set_field(given, one, seen[given.name]); !set)
        return tl::unexpected(set.error());
    }
    if (tool != nullptr)
      *tool = given.over(*tool);
    else
      *pen = std::move(given);
  }
  return material;
}

void give_pens(LineWork& drawing, std::span<const PenSettings> pens) {
  std::array<std::uint8_t, 6> pen_of{};  // by operation
  for (std::size_t i = pens.size(); i-- > 0;)
    if (const auto operation = operation_of(pens[i].name))
      pen_of.at(static_cast<std::size_t>(*operation)) = static_cast<std::uint8_t>(i + 1);
  for (DrawnLine& line : drawing.lines)
    if (line.operation.pen == 0)
      line.operation.pen = pen_of.at(static_cast<std::size_t>(line.operation.operation));
}

Result<void> check_pens(const LineWork& drawing, std::span<const PenSettings> pens) {
  std::array<std::uint8_t, 256> used{};
  for (const DrawnLine& line : drawing.lines) used.at(line.operation.pen) = 1;
  const std::uint8_t* const end = used.data() + 1 + pens.size();
  const std::uint8_t* const lost = std::find<const std::uint8_t*>(used.data() + 1, end, 0);
  if (lost == end) return {};
  const std::string& name = pens[static_cast<std::size_t>(lost - used.data() - 1)].name;
  const std::string shown = name.substr(0, 40);
  if (operation_of(name))
    return fail(ErrorKind::Usage, "/options/pen",
                fmt::format("the drawing has no {} that is not of another pen; leave \"{}\" out",
                            name == "outline" ? name : name + " fold", name));
  const std::string near = nearest_word(
      name, {"cut", "fold", "draw", "score", "light", "mountain", "valley", "outline"});
  return fail(
      ErrorKind::Usage, "/options/pen",
      fmt::format("\"{}\" is no colour or layer of a line; {}{}", shown,
                  drawing.looks.empty()
                      ? "this drawing has none; name cut, fold, draw, score, light, mountain, "
                        "valley or outline"
                      : fmt::format("the drawing has {}", fmt::join(drawing.looks, ", ")),
                  near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

}  // namespace popcut
