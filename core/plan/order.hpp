// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/plan/linework.hpp"

namespace popcut {

enum class OrderEffort { Quick, Best };

struct OrderOptions {
  OrderEffort effort{OrderEffort::Quick};
  PagePoint home{};  ///< where the tool comes from
};

/// One stroke of an order: a line, and how it is entered.
struct Visit {
  std::uint32_t line{};
  bool reversed{false};    ///< open lines: from the last point to the first
  std::uint32_t start{0};  ///< closed lines: the vertex at which the tool goes down and up
};

/// The order in which the lines are made. Draw, score, folds, cuts, outline; within cuts and
/// outlines what lies inside a closed line before that line; within such a group the way between
/// strokes is made short: nearest neighbour (either end of an open line, any vertex of a closed
/// one), then 2-opt and Or-opt moves among near neighbours. The way is never longer than that of
/// the drawing's own order with the same groups. Deterministic.
[[nodiscard]] std::vector<Visit> order(const LineWork& work, const OrderOptions& options);

/// The group of each line in the order of cutting, from 0.
[[nodiscard]] std::vector<std::uint32_t> cutting_groups(const LineWork& work);

[[nodiscard]] PagePoint entry(const LineWork& work, const Visit& visit);
[[nodiscard]] PagePoint leave(const LineWork& work, const Visit& visit);

/// Sum of the gaps between consecutive strokes, mm; without the way from and to home.
[[nodiscard]] double travel_mm(const LineWork& work, const std::vector<Visit>& visits);

}  // namespace popcut
