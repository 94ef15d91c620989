// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/machines/motion.hpp"

namespace popcut {

/// Quick: one good order. Best: the Quick order, improved according to `effort`. Keep: as drawn.
enum class OrderMethod { Quick, Best, Keep };

/// Called now and then with the share of the work that is done, 0 to 1. Returns false to stop now.
using KeepGoing = std::function<bool(double done)>;

/// Options of `order`.
struct OrderOptions {
  OrderMethod method{OrderMethod::Quick};
  double effort{1.0};     ///< search effort of Best: multiplies its moves, see `order_moves`
  std::uint64_t seed{1};  ///< random seed; the same seed gives the same order
  TravelCost cost{};      ///< millimetres by default
  std::optional<PagePoint> start{PagePoint{}};  ///< where the tool starts; none: anywhere
  std::optional<PagePoint> end{PagePoint{}};    ///< where it ends; none: anywhere
  bool any_seam{true};     ///< closed lines may start at any vertex, else at their first
  bool inner_first{true};  ///< lines inside a closed cut come before that cut
  /// For cutting without a mat: cut the sheet in bands of this many mm along the feed. Then the
  /// sheet does not move to and fro, and the machine does not pull on finished cuts. 0: no bands.
  /// Outlines come last.
  double band_mm{0.0};
  /// Cuts end at corners sharper than this and continue as a new stroke, because a blade that turns
  /// in the paper lifts it. 0: no splitting. The turn of a straight line is 0.
  double corner_deg{0.0};
  KeepGoing keep_going{};
};

/// One stroke of an order: a line or a part of one, and where it starts.
struct Visit {
  std::uint32_t line{};
  bool reversed{false};    ///< open lines and parts: from the last point to the first
  std::uint32_t start{0};  ///< closed lines: the vertex where the tool goes down and up
  std::uint32_t count{0};  ///< number of points of a part that begins at `start`; 0: the whole line
};

/// An order of strokes and its cost.
struct Ordered {
  std::vector<Visit> visits;
  double cost{};      ///< of the moves between strokes, including from the start and to the end
  double own_cost{};  ///< the same for the drawing's own order, with the same groups and precedence
  std::uint64_t moves{0}, moves_wanted{0};  ///< moves tried, and moves that the effort allows
  bool finished{true};                      ///< false: `keep_going` stopped it early
};

/// Finds an order in which to make the lines: draw, score, folds, cuts, outlines; among cuts and
/// among outlines, lines inside a closed line come before it. Within these rules it makes the moves
/// between strokes cheap. Open lines may start at either end, closed lines at any vertex. The order
/// never costs more than the drawing's own order under the same rules, and Best never more than
/// Quick. The same options give the same order unless `keep_going` stops it early, which it cannot
/// do before the Quick order is complete.
///
/// `Keep` changes nothing: the order is that of the drawing.
///
/// Quick is O(n log n). Memory: about 250 bytes per line, and 24 per vertex of closed lines (of at
/// most 32 vertices each).
[[nodiscard]] Ordered order(const LineWork& work, const OrderOptions& options);

/// Number of moves that Best tries on `lines` lines.
[[nodiscard]] std::uint64_t order_moves(std::size_t lines, double effort);

/// The group of each line in cutting order, from 0: draw, score, folds, cuts, outlines.
[[nodiscard]] std::vector<std::uint32_t> cutting_groups(const LineWork& work);

/// How many lines come after a closed line of their group that they lie inside of.
[[nodiscard]] std::size_t outer_before_inner(const LineWork& work,
                                             const std::vector<Visit>& visits);

/// Sets `out` to the points of a visit in the order in which they are made.
void points_of_visit(const LineWork& work, const Visit& visit, std::vector<PagePoint>& out);

/// Where the tool goes down, and where it goes up, in page mm.
[[nodiscard]] PagePoint entry(const LineWork& work, const Visit& visit);
[[nodiscard]] PagePoint leave(const LineWork& work, const Visit& visit);

/// Sum of the gaps between consecutive strokes in mm, without the moves from and to home.
[[nodiscard]] double travel_mm(const LineWork& work, const std::vector<Visit>& visits);

/// Cost of the moves of an order, including those from the start and to the end.
[[nodiscard]] double travel_cost(const LineWork& work, const std::vector<Visit>& visits,
                                 const OrderOptions& options);

}  // namespace popcut
