// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace popcut::daemon {

/// Answers waiting clients of these sockets with 503 because popcutd cannot start, with the reason:
/// the reason itself on unix sockets, whose callers are known. Else systemd, which keeps the
/// sockets, would start popcutd again and again for the same requests. Takes a second at most.
void turn_away(const std::vector<int>& sockets, const std::string& reason);

}  // namespace popcut::daemon
