// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "protocol/program.hpp"

/// Machines, a material and a drawing for the tests of the protocol.
namespace popcut::samples {

/// A Cameo 3 with a mat of 12 x 12 inch.
inline Machine cameo3() {
  Machine machine;
  machine.name = "cameo3";
  machine.language = "gpgl";
  machine.variant = "cameo3";
  machine.unit_mm = 0.05;
  machine.width_mm = machine.length_mm = 304.8;
  machine.tool_holders = 2;
  machine.autoblade = true;
  machine.force_gf = {1, 33, 7};
  machine.speed_mm_s = {1, 10, 100};
  return machine;
}

/// A machine with one holder, of the variant and the unit of its language.
inline Machine one_holder(std::string language, std::string variant) {
  Machine machine = cameo3();
  machine.name = "one-holder";
  machine.unit_mm = language == "hpgl" ? 0.025 : 0.05;
  machine.language = std::move(language);
  machine.variant = std::move(variant);
  machine.tool_holders = 1;
  machine.autoblade = false;
  return machine;
}

inline Material paper() {
  Material material;
  material.name = "paper";
  material.blade_offset_mm = 0.9;
  material.autoblade_depth = 1;
  return material;
}

/// Appends a stroke through (x, y) in mm with 70 gf and 500 mm/s, steps 10 and 5 of a Cameo 3.
inline Stroke& add_stroke(Toolpath& toolpath, std::initializer_list<PagePoint> points) {
  Stroke stroke{.operation = Operation::Cut,
                .first = static_cast<std::uint32_t>(toolpath.points.size()),
                .count = static_cast<std::uint32_t>(points.size())};
  stroke.force_gf = 70;
  stroke.speed_mm_s = 500;
  toolpath.points.insert(toolpath.points.end(), points);
  toolpath.strokes.push_back(stroke);
  return toolpath.strokes.back();
}

/// Four squares of one inch in the corners of a page of 12 inch, with lead-in and overcut of 1 mm,
/// as in all captures of the Cameo 3.
inline Toolpath four_squares() {
  Toolpath toolpath;
  for (const double y : {0.0, 279.4}) {
    for (const double x : {0.0, 279.4})
      add_stroke(toolpath, {{x + 1, y},
                            {x, y},
                            {x, y + 25.4},
                            {x + 25.4, y + 25.4},
                            {x + 25.4, y},
                            {x, y},
                            {x, y + 1}});
  }
  return toolpath;
}

/// GPGL to read: `|` for ETX.
inline std::string readable(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    const char c = static_cast<char>(byte);
    text += c == '\x03' ? '|' : c;
  }
  return text;
}

/// The bytes of GPGL written with `|` for ETX.
inline std::string gpgl(std::string text) {
  std::replace(text.begin(), text.end(), '|', '\x03');
  return text;
}

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

}  // namespace popcut::samples
