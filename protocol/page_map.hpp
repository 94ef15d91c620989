// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// Converts between the page in mm and a machine's units. The margins are the position of the
/// page's corner on the machine.
struct PageMap {
  Dialect dialect{};
  double feed_unit_mm{0.05}, carriage_unit_mm{0.05};  ///< what one unit moves along each
  double margin_left_mm{};
  double margin_top_mm{};
  bool feed_first{true};    ///< the first coordinate is the feed: GPGL, roll cutters
  bool feed_up{false};      ///< the feed counts from the end of the page to its top
  double page_length_mm{};  ///< only for feed_up: the page's y = length is the machine's feed 0

  /// Not rounded; the encoder rounds to whole units, or to hundredths if the job asks for
  /// fractions.
  [[nodiscard]] constexpr MachinePoint to_machine(PagePoint page) const {
    const double y = feed_up ? page_length_mm - page.y : page.y;
    const double feed = (y + margin_top_mm) / feed_unit_mm;
    const double carriage = (page.x + margin_left_mm) / carriage_unit_mm;
    return feed_first ? MachinePoint{feed, carriage} : MachinePoint{carriage, feed};
  }

  [[nodiscard]] constexpr PagePoint to_page(MachinePoint point) const {
    const double feed = feed_first ? point.a : point.b;
    const double carriage = feed_first ? point.b : point.a;
    const double y = feed * feed_unit_mm - margin_top_mm;
    return {carriage * carriage_unit_mm - margin_left_mm, feed_up ? page_length_mm - y : y};
  }
};

/// The map of a page on `machine`.
///
/// @param page_length_mm  length of the page along the feed; used only if the machine's feed
/// counts upward
/// @retval OutOfRange     the machine's unit is not positive, its language is unknown, or its feed
///                        counts upward and no page length is given
[[nodiscard]] Result<PageMap> page_map(const Machine& machine, double page_length_mm = 0);

/// The dialect that a machine speaks.
///
/// @retval OutOfRange  `machine.language` is neither gpgl nor hpgl
[[nodiscard]] Result<Dialect> dialect_of(const Machine& machine);

}  // namespace popcut
