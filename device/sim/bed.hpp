// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "device/sim/window.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// The bed of a simulated machine: where its coordinates lie on the sheet, and what the tool can
/// reach.
///
/// For the machines that popcut knows, axes, step and reach come from a table of the simulator's
/// own (bed.cpp). The encoder does not share it: a program with exchanged axes runs off this bed
/// instead of being read back by the mistake that wrote it. The beds of other machines, and of
/// those whose row a user has replaced, follow their rows.
class Bed {
 public:
  /// @param page_length_mm  length of the sheet; machines that count the feed upward have their
  ///                        zero at its end
  Bed(const Machine& machine, double page_length_mm);

  /// The place on the sheet, in mm from its upper left corner, of a point in machine steps.
  [[nodiscard]] PagePoint to_page(MachinePoint point) const;
  [[nodiscard]] MachinePoint to_machine(PagePoint place) const;
  /// What carriage and rollers can reach, on the sheet.
  [[nodiscard]] Window reach() const;
  [[nodiscard]] double carriage_mm() const { return carriage_mm_; }
  [[nodiscard]] double feed_mm() const { return feed_mm_; }

 private:
  double feed_step_mm_, carriage_step_mm_;
  bool feed_first_;
  bool feed_up_;
  double carriage_mm_, feed_mm_;  ///< reach
  double left_mm_, top_mm_;       ///< where the sheet's corner lies
  double page_length_mm_;
};

/// Whether the simulator's own table has a bed for a machine of this name.
[[nodiscard]] bool has_own_bed(std::string_view machine);

}  // namespace popcut
