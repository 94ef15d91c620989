// SPDX-License-Identifier: MIT
#include "core/hands/strip.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"

namespace popcut::hands {

Pattern folding_strip() {
  constexpr double kBetween_mm = 5, kEdge_mm = 8, kFlap_mm = 18;
  Pattern strip;
  strip.name = "folding test";
  strip.wall_mm = kEdge_mm + kFlap_mm;
  strip.ground_mm = kEdge_mm;
  double v = kEdge_mm;
  const double top = kEdge_mm, base = kEdge_mm + kFlap_mm;
  bool is_mountain = true;
  for (const StripFolds& group : kStrip)
    for (int k = 0; k < group.folds; ++k, is_mountain = !is_mountain) {
      const double end = v + group.length_mm;
      strip.lines.push_back(
          {base, v, base, end, is_mountain ? EdgeRole::Mountain : EdgeRole::Valley});
      strip.lines.push_back({base, v, top, v, EdgeRole::Slit});
      strip.lines.push_back({top, v, top, end, EdgeRole::Slit});
      strip.lines.push_back({top, end, base, end, EdgeRole::Slit});
      v = end + kBetween_mm;
    }
  strip.width_mm = v - kBetween_mm + kEdge_mm;
  const double bottom = strip.wall_mm + strip.ground_mm, right = strip.width_mm;
  strip.lines.push_back({0, 0, bottom, 0, EdgeRole::Outline});
  strip.lines.push_back({bottom, 0, bottom, right, EdgeRole::Outline});
  strip.lines.push_back({bottom, right, 0, right, EdgeRole::Outline});
  strip.lines.push_back({0, right, 0, 0, EdgeRole::Outline});
  return strip;
}

std::string own_hands_json(const std::array<double, kStrip.size()>& seconds) {
  auto folds = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < kStrip.size(); ++k)
    folds.push_back({{"from_mm", kStrip[k].from_mm},
                     {"fold_s", std::round(10 * seconds[k] / kStrip[k].folds) / 10}});
  return json_file(
      nlohmann::ordered_json{{"popcut", 1},
                             {"hands",
                              {{"source", "measured with the strip of 'popcut calibrate --hands'"},
                               {"folds", std::move(folds)}}}});
}

}  // namespace popcut::hands
