// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace popcut::daemon {

/// Tells who waits at these listening sockets that popcutd does not start, with 503 and why: the
/// reason itself on unix sockets, whose callers are known. Else systemd, which keeps the sockets,
/// would start popcutd again and again for the same requests. Takes a second at most.
void turn_away(const std::vector<int>& sockets, const std::string& reason);

}  // namespace popcut::daemon
