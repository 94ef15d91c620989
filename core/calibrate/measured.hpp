// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/calibrate/figures.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"

namespace popcut::calibrate {

/// What a person measured, applied to a machine's row.

enum class Way : std::uint8_t { Right, Left, Up, Down };

/// The machine with the axes that make an angle's lines run as they did. The person sees the sheet
/// as it lies in the machine: the edge that went in first is up, the cut side faces them.
///
/// @param one_tick, two_ticks  the ways in which the lines ran from their corner, with `machine`'s
///                             present axes
/// @retval Infeasible  no machine draws so: the lines are parallel, or the sheet was turned
/// @retval OutOfRange  the axes differ from those that its language allows (GPGL)
[[nodiscard]] Result<Machine> with_ways(const Machine& machine, Way one_tick, Way two_ticks);

/// What a ruler says of an `Angle`, mm.
struct Ruled {
  double right_mm{}, down_mm{};          ///< lengths of the lines
  double from_left_mm{}, from_top_mm{};  ///< of the corner, from the sheet's left and upper edge
};

/// The machine with margins and scales that put an angle where it should have been, with the
/// lengths it should have had.
///
/// @param page_length_mm  along the feed
/// @param remarks   what the row cannot hold: "load the sheet 2 mm further to the left"
/// @retval OutOfRange  a length is more than 20 % off, or a distance more than 60 mm: measured
///                     wrongly, or another unit
[[nodiscard]] Result<Machine> with_ruled(const Machine& machine, const Angle& angle,
                                         const Ruled& ruled, double page_length_mm,
                                         std::vector<std::string>& remarks);

/// A run and how long it took.
struct Timing {
  const TimedRun* run{};
  double seconds{};  ///< as of `run_seconds`
};

/// How well a machine's motion explains timings.
struct MotionFit {
  Machine machine;   ///< with the motion and the speed of a step that fit best
  double worst{};    ///< largest relative error over the runs it was fitted to
  double checked{};  ///< relative error of the last run, which was left out
};

/// The time that the end of a program takes beside lifting the tool and the way home from `run`,
/// where `trailer_s` was measured for all three.
[[nodiscard]] double parking_seconds(const TimedRun& run, double trailer_s, const Machine& machine);

/// Fits acceleration, travel speed, deviation at corners, time to lower and lift the tool, speed of
/// the swivel (where the firmware turns a blade) and of a speed step: least squares of the
/// logarithm of the ratio, by NLopt's subplex. Sets `Motion::spread` to twice the larger error, 5 %
/// at least. The last timing is not fitted but checks the others.
///
/// @param blade_offset_mm  of the blade that the firmware turns at corners; 0: a pen
/// @retval OutOfRange  fewer than seven timings, or one of 0.5 s or less
/// @retval Infeasible  no motion explains them within 20 %: a wrong time
[[nodiscard]] Result<MotionFit> fit_motion(const Machine& machine,
                                           const std::vector<Timing>& timings,
                                           double blade_offset_mm);

/// Seconds of a run by a machine's model: from home until the last line ends, with the tool still
/// down.
[[nodiscard]] double run_seconds(const TimedRun& run, const Machine& machine,
                                 double blade_offset_mm);

/// Which properties of a machine were measured.
struct Measured {
  bool axes{}, places{}, motion{}, force{};
};

/// The row of a calibrated machine, for a table of machines: what was measured, as JSON; the rest
/// is like `before`.
[[nodiscard]] std::string machine_row(const Machine& machine, const Machine& before,
                                      const Measured& measured);

/// The text of a table of machines with a row in it; one of the same name is replaced.
///
/// @param table  the text of the present table; empty: none yet
/// @retval Malformed  it is no table
[[nodiscard]] Result<std::string> table_with(const std::string& table, const std::string& row);

}  // namespace popcut::calibrate
