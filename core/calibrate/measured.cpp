// SPDX-License-Identifier: MIT
#include "core/calibrate/measured.hpp"

#include <cmath>

#include <fmt/format.h>

namespace popcut::calibrate {
namespace {

Way opposite(Way way) {
  switch (way) {
    case Way::Right:
      return Way::Left;
    case Way::Left:
      return Way::Right;
    case Way::Up:
      return Way::Down;
    case Way::Down:
      break;
  }
  return Way::Up;
}

/// Whither a machine's tool goes on the sheet as its coordinate along the feed grows.
Way feed_way(const Machine& machine) { return machine.feed_up() ? Way::Up : Way::Down; }

/// Whither the lines of an angle run that is written for `written` and drawn by `real`.
std::array<Way, 2> ways(const Machine& written, const Machine& real) {
  const bool same = written.axes == real.axes;
  // Written for the carriage: drawn along the carriage, or along the feed.
  const Way across = same ? Way::Right : feed_way(real);
  const Way along = same ? feed_way(real) : Way::Right;
  return {across, written.feed_up() ? opposite(along) : along};
}

Result<double> ratio(const char* what, double meant_mm, double mm) {
  if (std::isfinite(mm) && mm > 0.8 * meant_mm && mm < 1.2 * meant_mm) return mm / meant_mm;
  return fail(
      ErrorKind::OutOfRange, what,
      fmt::format("is {:g} mm, where {:g} mm were sent; measure it again, in mm", mm, meant_mm));
}

}  // namespace

Result<Machine> with_ways(const Machine& machine, Way one_tick, Way two_ticks) {
  for (const Axes axes :
       {machine.axes, machine.axes == Axes::FeedCarriage ? Axes::CarriageFeed : Axes::FeedCarriage})
    for (const bool mirrored : {machine.mirrored, !machine.mirrored}) {
      Machine real = machine;
      real.axes = axes;
      real.mirrored = mirrored;
      if (ways(machine, real) != std::array{one_tick, two_ticks}) continue;
      if (machine.language == "gpgl" && (axes != machine.axes || mirrored != machine.mirrored))
        return fail(
            ErrorKind::OutOfRange, "",
            "these directions are not possible for GPGL; look again, with the edge that went in "
            "first away from you and the cut side up");
      return real;
    }
  const auto flat = [](Way way) { return way == Way::Right || way == Way::Left; };
  return fail(ErrorKind::Infeasible, "",
              flat(one_tick) == flat(two_ticks)
                  ? "the two lines cannot run the same way or opposite ways; look again"
                  : "these directions are not possible; look again, with the edge that went in "
                    "first away from "
                    "you and the cut side up");
}

Result<Machine> with_ruled(const Machine& machine, const Angle& angle, const Ruled& ruled,
                           double page_length_mm, std::vector<std::string>& remarks) {
  const auto across = ratio("the line with one tick", angle.right_mm, ruled.right_mm);
  if (!across) return tl::unexpected(across.error());
  const auto along = ratio("the line with two ticks", angle.down_mm, ruled.down_mm);
  if (!along) return tl::unexpected(along.error());
  constexpr double kFarthestMm = 60;
  const std::array<std::pair<const char*, std::array<double, 2>>, 2> places{
      {{"the distance from the left edge", {ruled.from_left_mm, angle.corner.x}},
       {"the distance from the upper edge", {ruled.from_top_mm, angle.corner.y}}}};
  for (const auto& [what, mm] : places)
    if (!(std::abs(mm[0] - mm[1]) <= kFarthestMm))
      return fail(ErrorKind::OutOfRange, what,
                  fmt::format("is {:g} mm, where {:g} mm were sent; measure it again, in mm", mm[0],
                              mm[1]));
  Machine real = machine;
  real.scale_carriage *= *across;
  real.scale_feed *= *along;
  // The machine puts a coordinate c on the sheet at c scale - margin, and the corner's was written
  // with the margin and scale of before; y counts from the page's end where the feed grows upward.
  const bool up = machine.feed_up();
  const double y = up ? page_length_mm - angle.corner.y : angle.corner.y;
  const double seen_y = up ? page_length_mm - ruled.from_top_mm : ruled.from_top_mm;
  real.margin_left_mm = (angle.corner.x + machine.margin_left_mm) * *across - ruled.from_left_mm;
  real.margin_top_mm = (y + machine.margin_top_mm) * *along - seen_y;
  if (machine.takes_negative()) return real;
  if (real.margin_left_mm < 0)
    remarks.push_back(
        fmt::format("load the sheet {:.1f} mm further to the right: this machine "
                    "cannot cut left of its zero",
                    -real.margin_left_mm));
  if (real.margin_top_mm < 0)
    remarks.push_back(
        fmt::format("load the sheet with {} {:.1f} mm further {}: this machine "
                    "cannot cut beyond its zero",
                    up ? "its end" : "its upper edge", -real.margin_top_mm, up ? "out" : "in"));
  real.margin_left_mm = std::max(real.margin_left_mm, 0.0);
  real.margin_top_mm = std::max(real.margin_top_mm, 0.0);
  return real;
}

}  // namespace popcut::calibrate
