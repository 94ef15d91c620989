// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace popcut::daemon {

/// One thing about a node and its database, in plain sentences.
struct FleetFinding {
  enum class Level : std::uint8_t {
    Fine,     ///< as it should be
    Note,     ///< worth knowing, stops nothing
    Problem,  ///< nothing can be cut until this is fixed
  };
  Level level{};
  std::string what;
  std::string remedy{};  ///< what to do; empty: nothing
};

struct FleetProbe {
  std::string url, password, node;
  std::function<std::int64_t()> now_ms{};  ///< this machine's clock; empty: the system's
};

/// Looks from a node's machine at its fleet, with its own login: whether the database answers,
/// takes the login and has tables that fit; the node's lease, whether it drains, how its clock
/// differs; nodes that have not compared their journals, or are silent; what a failover may lose.
/// Changes nothing.
[[nodiscard]] std::vector<FleetFinding> fleet_findings(const FleetProbe& probe);

}  // namespace popcut::daemon
