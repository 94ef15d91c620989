// SPDX-License-Identifier: MIT
#include "core/plan/machine_choice.hpp"

#include <utility>

#include "core/plan/marks.hpp"

namespace popcut {

nlohmann::ordered_json machine_choice(const Machine& machine) {
  using nlohmann::ordered_json;
  ordered_json mats = ordered_json::array();
  for (const Mat& mat : machine.mats)
    mats.push_back({{"name", mat.name}, {"width_mm", mat.width_mm}, {"length_mm", mat.length_mm}});
  ordered_json marks;
  if (machine.language == "gpgl") {  // no other one has a command to search for them
    constexpr double kPage_mm = 1000;
    const auto room = room_within_marks_mm({kPage_mm, kPage_mm});
    marks = {kPage_mm - room[0], kPage_mm - room[1]};
  }
  return {{"name", machine.name},         {"title", machine.title},
          {"driven", machine.driven()},   {"marks_take_mm", std::move(marks)},
          {"width_mm", machine.width_mm}, {"length_mm", machine.length_mm},
          {"mats", std::move(mats)}};
}

}  // namespace popcut
