// SPDX-License-Identifier: MIT
#pragma once

namespace popcut::testing {

/// A Cameo 3 and a paper a hundred times as fast as real ones, without a swivelling blade.
inline constexpr const char* kQuickMachine = R"j({"popcut": 1, "machines": [{"name": "quick",
  "title": "A quick Cameo 3", "like": "cameo3",
  "speed_mm_s": {"min_step": 1, "max_step": 10, "per_step": 1000},
  "motion": {"accel_mm_s2": 1000000, "travel_mm_s": 9000, "corner_mm": 0.05, "drop_s": 0.001,
             "lift_s": 0.001, "setup_s": 0.01, "trailer_s": 0.003, "autoblade_reset_s": 0.069,
             "autoblade_tap_s": 0.0045, "spread": 0.15}}]})j";
inline constexpr const char* kQuickPaper = R"j({"popcut": 1, "materials": [{"name": "quick-paper",
  "like": "paper-220", "blade_offset_mm": 0,
  "cut": {"tool": 1, "force_gf": 70, "speed_mm_s": 10000, "passes": 1},
  "fold": {"tool": 1, "force_gf": 70, "speed_mm_s": 10000, "passes": 1}}]})j";

}  // namespace popcut::testing
