// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/nesting.hpp"
#include "core/plan/order/order.hpp"

namespace popcut {

/// Lines of which each may come after any other, but for what lies inside what.
struct OrderGroup {
  std::vector<std::uint32_t> lines;
  std::optional<PagePoint> start, end;
  std::uint64_t moves{0};
  std::vector<Visit> known{};  ///< an order that is to be made better; empty: there is none yet
};

/// A short way through one group, see `order`. Costs are those of the group from its start to its
/// end.
///
/// @param scratch  a zero for each line of `work`; left as it was
[[nodiscard]] Ordered order_group(const LineWork& work, const Nesting& nesting,
                                  const OrderGroup& group, const OrderOptions& options,
                                  const KeepGoing& keep_going, std::vector<std::uint32_t>& scratch);

}  // namespace popcut
