// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "daemon/planning/plan_words.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

using planning::OrderWords;

/// Adds --order, --effort, --seed and --mat-free.
void add_order_options(CLI::App& command, OrderWords& words);

/// For `OrderOptions::keep_going`: shows how far the search is, and ends it at the latest after a
/// minute a unit of effort.
[[nodiscard]] std::function<bool(double)> watched_search(const OrderWords& words);

}  // namespace popcut::cli
