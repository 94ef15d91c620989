// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/exploration.hpp"
#include "tests/support/lease_world.hpp"

namespace popcut::testing {

/// Explores the lease protocol of a fleet, breadth first: every state within `bounds`. In each it
/// looks at all rules; at the end it looks whether from each state the job can end without another
/// fault.
[[nodiscard]] Exploration explore_leases(const lease::Bounds& bounds, lease::Flaw flaw);

}  // namespace popcut::testing
