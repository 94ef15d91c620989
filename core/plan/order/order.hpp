// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/plan/order/travel_cost.hpp"

namespace popcut {

/// Quick: one good order. Best: that one, improved for as long as `effort` says. Keep: as drawn.
enum class OrderMethod { Quick, Best, Keep };

/// Called now and then with how much of the work is done, 0 to 1; false: enough, stop now.
using KeepGoing = std::function<bool(double done)>;

struct OrderOptions {
  OrderMethod method{OrderMethod::Quick};
  double effort{1.0};     ///< of Best: a factor of the number of its moves, see `order_moves`
  std::uint64_t seed{1};  ///< of the moves that use chance
  TravelCost cost{};      ///< millimetres unless told
  std::optional<PagePoint> start{PagePoint{}};  ///< where the tool comes from; none: anywhere
  std::optional<PagePoint> end{PagePoint{}};    ///< where it goes in the end
  bool any_seam{true};     ///< closed lines may be entered at any vertex, else at their first
  bool inner_first{true};  ///< what lies inside a closed cut comes before that cut
  /// Without a mat: the sheet is done in bands of this many mm along the feed, so that it is not
  /// moved to and fro and what is cut is not pulled again; 0: the sheet at once. Outlines are last.
  double band_mm{0.0};
  /// Cuts end at corners sharper than this and go on as strokes of their own, since a blade that
  /// turns in the paper lifts it; 0: they are not split. The turn of a straight line is 0.
  double corner_deg{0.0};
  KeepGoing keep_going{};
};

/// One stroke of an order: a line, or a piece of one, and how it is entered.
struct Visit {
  std::uint32_t line{};
  bool reversed{false};    ///< open lines and pieces: from the last point to the first
  std::uint32_t start{0};  ///< closed lines: the vertex at which the tool goes down and up
  std::uint32_t count{0};  ///< points of a piece, which begins at `start`; 0: the whole line
};

struct Ordered {
  std::vector<Visit> visits;
  double cost{};      ///< of the moves between strokes, from the start and to the end
  double own_cost{};  ///< of the drawing's own order with the same groups and precedence
  std::uint64_t moves{0}, moves_wanted{0};  ///< tried, and due for the effort
  bool finished{true};                      ///< false: `keep_going` ended it early
};

/// The order in which the lines are made. Draw, score, folds, cuts, outline; of cuts and outlines
/// what lies inside a closed line before that line. Within these bounds what the moves between the
/// strokes cost is made small: open lines from either end, closed ones from any vertex. It is never
/// dearer than the drawing's own order within the same bounds, and Best is never dearer than Quick.
/// The same options give the same order, unless `keep_going` ends it early; it cannot end Best
/// before what Quick finds is there.
///
/// `Keep` changes nothing: what is returned is the drawing as it is.
///
/// Quick: O(n log n). Memory: about 250 bytes a line, and 24 a vertex of closed lines (of at most
/// 32 each).
[[nodiscard]] Ordered order(const LineWork& work, const OrderOptions& options);

/// Moves that Best tries on `lines` lines.
[[nodiscard]] std::uint64_t order_moves(std::size_t lines, double effort);

/// The group of each line in the order of cutting, from 0: draw, score, folds, cuts, outlines.
[[nodiscard]] std::vector<std::uint32_t> cutting_groups(const LineWork& work);

/// How many lines come after a closed line of the same group that they lie inside of.
[[nodiscard]] std::size_t outer_before_inner(const LineWork& work,
                                             const std::vector<Visit>& visits);

/// The points of a visit in the order they are made.
void points_of_visit(const LineWork& work, const Visit& visit, std::vector<PagePoint>& out);

[[nodiscard]] PagePoint entry(const LineWork& work, const Visit& visit);
[[nodiscard]] PagePoint leave(const LineWork& work, const Visit& visit);

/// Sum of the gaps between consecutive strokes, mm; without the way from and to home.
[[nodiscard]] double travel_mm(const LineWork& work, const std::vector<Visit>& visits);

/// What the moves of an order cost, with those from the start and to the end.
[[nodiscard]] double travel_cost(const LineWork& work, const std::vector<Visit>& visits,
                                 const OrderOptions& options);

}  // namespace popcut
