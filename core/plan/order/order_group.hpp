// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/nesting.hpp"
#include "core/plan/order/order.hpp"

namespace popcut {

/// Lines that may come in any order, except that inner lines come before outer ones.
struct OrderGroup {
  std::vector<std::uint32_t> lines;
  std::optional<PagePoint> start, end;
  std::uint64_t moves{0};
  std::vector<Visit> known{};  ///< an order to improve; empty: none yet
};

/// Finds a cheap order of one group; see `order`. Costs cover the group from its start to its end.
///
/// @param scratch  a zero for each line of `work`; is all zeros again afterwards
[[nodiscard]] Ordered order_group(const LineWork& work, const Nesting& nesting,
                                  const OrderGroup& group, const OrderOptions& options,
                                  const KeepGoing& keep_going, std::vector<std::uint32_t>& scratch);

}  // namespace popcut
