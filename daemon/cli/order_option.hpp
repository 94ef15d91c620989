// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/plan/order.hpp"
#include "core/result.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

struct OrderWords {
  std::string method{"quick"};
  double effort{1.0};
  std::uint64_t seed{1};
  bool mat_free{false};
  bool progress{true};  ///< on a terminal, once it takes over two seconds
};

/// Adds --order, --effort, --seed and --mat-free.
void add_order_options(CLI::App& command, OrderWords& words);

/// The search that they ask for. It ends at the latest after a minute a unit of effort, and shows
/// how far it is.
///
/// @retval Usage  the word is not known, or the effort is not from 0.01 to 1000
[[nodiscard]] Result<OrderOptions> order_options(const OrderWords& words);

}  // namespace popcut::cli
