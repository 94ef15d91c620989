// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut::daemon {

/// The damage of a write-ahead log that its last process did not close; empty: none.
///
/// A log may end in the middle of its last transaction, which was never reported as done. But what
/// stands before another commit was synced before that commit was written, so it must be whole.
[[nodiscard]] std::string log_damage(const std::string& path);

}  // namespace popcut::daemon
