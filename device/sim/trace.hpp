// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// One path with the tool down, as the program commands it.
struct TraceStroke {
  std::uint32_t first{};  ///< points `first .. first + count` of the trace
  std::uint32_t count{};  ///< 1 if the tool came down without moving
  int tool{1};            ///< tool holder or pen
  double force_steps{};   ///< as sent; 0: never set
  double force_gf{};      ///< 0 if the machine's scale is not known
  double speed_mm_s{};
  double clipped_mm{};         ///< length outside the window
  std::uint64_t begin_byte{};  ///< of the command that lowered the tool
};

/// A setting that the machine received, in order of arrival.
struct TraceSetting {
  std::string name;  ///< "speed", "force", "tool", ... or the mnemonic of any other
  std::vector<double> values;
};

/// What a cutter did. Points are in mm on the page: x along the carriage, y along the feed.
struct Trace {
  std::string machine;
  double unit_mm{};
  double page_width_mm{};
  double page_length_mm{};
  std::vector<PagePoint> points;
  std::vector<TraceStroke> strokes;
  std::vector<PagePoint> clipped;  ///< pairs of ends: drawn in the program, outside the window
  std::vector<TraceSetting> settings;
  std::vector<std::string> unknown;  ///< commands not understood; none was executed
  std::vector<std::string> remarks;  ///< invalid values, and what the machine used instead
  std::uint64_t unknown_count{};     ///< may exceed the length of the list
  double cut_mm{};                   ///< length of all strokes, clipped parts included
  double clipped_mm{};               ///< of that, outside the window
  double travel_mm{};                ///< sum of the gaps between consecutive strokes
  double home_mm{};                  ///< from home to the first stroke and from the last one back
  std::uint64_t lifts{};             ///< number of strokes
  double seconds{};                  ///< from the first command to rest
  double starved_s{};                ///< longest wait for bytes with the tool down

  [[nodiscard]] std::span<const PagePoint> points_of(const TraceStroke& stroke) const {
    return std::span(points).subspan(stroke.first, stroke.count);
  }
};

/// `trace.json`: a JSON document with all of the above; lengths in mm rounded to 1e-6 mm.
[[nodiscard]] std::string trace_json(const Trace& trace);
/// The same without the strokes, as values.
[[nodiscard]] nlohmann::ordered_json trace_summary(const Trace& trace);

/// `cut.svg`: what the knife did, at true scale. Each force has a colour, listed in the legend;
/// travel is a hairline; lines outside the window are grey.
[[nodiscard]] std::string trace_svg(const Trace& trace);

}  // namespace popcut
