// SPDX-License-Identifier: MIT
#include "protocol/page_map.hpp"

#include <cmath>

#include <fmt/format.h>

namespace popcut {

Result<Dialect> dialect_of(const Machine& machine) {
  if (machine.language == "gpgl") return Dialect::Gpgl;
  if (machine.language == "hpgl") return Dialect::Hpgl;
  return fail(
      ErrorKind::OutOfRange, "/language",
      fmt::format("\"{}\" is not a language of cutters; use gpgl or hpgl", machine.language));
}

Result<PageMap> page_map(const Machine& machine, double page_length_mm) {
  const Result<Dialect> dialect = dialect_of(machine);
  if (!dialect) return tl::unexpected(dialect.error());
  if (!(machine.unit_mm > 0) || !std::isfinite(machine.unit_mm))
    return fail(ErrorKind::OutOfRange, "/unit_mm",
                fmt::format("a machine unit of {} mm; it must be above 0 (0.05 for GPGL, 0.025 for "
                            "HPGL)",
                            machine.unit_mm));
  if (machine.feed_up() && !(page_length_mm > 0))
    return fail(ErrorKind::OutOfRange, "/axes",
                fmt::format("{} counts the feed from the end of the page; give the length of the "
                            "page in mm",
                            machine.name));
  return PageMap{.dialect = *dialect,
                 .feed_unit_mm = machine.unit_mm * machine.scale_feed,
                 .carriage_unit_mm = machine.unit_mm * machine.scale_carriage,
                 .margin_left_mm = machine.margin_left_mm,
                 .margin_top_mm = machine.margin_top_mm,
                 .feed_first = machine.axes == Axes::FeedCarriage,
                 .feed_up = machine.feed_up(),
                 .page_length_mm = page_length_mm};
}

}  // namespace popcut
