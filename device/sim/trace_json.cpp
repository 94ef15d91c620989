// SPDX-License-Identifier: MIT
// Part of device/sim/trace.hpp.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/sim/trace.hpp"

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

/// 1e-6 mm is far below any machine's step and keeps float noise out of the file.
double tidy(double value) {
  constexpr double kLongest = 1e12;  // and keeps the file JSON, which knows no infinity
  value = std::isfinite(value) ? std::clamp(value, -kLongest, kLongest) : 0.0;
  const double rounded = std::round(value * 1e6) / 1e6;
  return rounded == 0.0 ? 0.0 : rounded;
}

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(tidy(value));
  return list;
}

}  // namespace

nlohmann::ordered_json trace_summary(const Trace& trace) {
  Json head = {
      {"popcut", 1},
      {"machine", trace.machine},
      {"cut_mm", tidy(trace.cut_mm)},
      {"travel_mm", tidy(trace.travel_mm)},
      {"home_mm", tidy(trace.home_mm)},
      {"clipped_mm", tidy(trace.clipped_mm)},
      {"lifts", trace.lifts},
      {"unit_mm", trace.unit_mm},
      {"page_mm", {tidy(trace.page_width_mm), tidy(trace.page_length_mm)}},
      {"seconds", std::round(trace.seconds * 1e3) / 1e3},
      {"starved_s", std::round(trace.starved_s * 1e3) / 1e3},
      {"unknown", trace.unknown},
      {"unknown_count", trace.unknown_count},
      {"remarks", trace.remarks},
  };
  Json settings = Json::array();
  for (const TraceSetting& setting : trace.settings)
    settings.push_back({{"name", setting.name}, {"values", numbers(setting.values)}});
  head["settings"] = std::move(settings);
  return head;
}

std::string trace_json(const Trace& trace) {
  // Replies and unknown commands may hold any bytes: they are replaced, never an error.
  std::string text =
      trace_summary(trace).dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
  text.resize(text.rfind('\n'));  // reopened for the strokes, which are written flat
  text += ",\n \"strokes\": [";
  auto out = std::back_inserter(text);
  const char* separator = "\n";
  for (const TraceStroke& stroke : trace.strokes) {
    fmt::format_to(out,
                   "{}  {{\"tool\": {}, \"force\": {}, \"force_gf\": {}, \"speed_mm_s\": {}, "
                   "\"clipped_mm\": {}, \"points\": [",
                   separator, stroke.tool, tidy(stroke.force_steps), tidy(stroke.force_gf),
                   tidy(stroke.speed_mm_s), tidy(stroke.clipped_mm));
    const char* comma = "";
    for (const PagePoint& point : trace.points_of(stroke)) {
      fmt::format_to(out, "{}[{}, {}]", comma, tidy(point.x), tidy(point.y));
      comma = ", ";
    }
    text += "]}";
    separator = ",\n";
  }
  text += trace.strokes.empty() ? "]\n}\n" : "\n ]\n}\n";
  return text;
}

}  // namespace popcut
