// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/fleet/node_lease.hpp"
#include "daemon/service/live/cut_dispatcher.hpp"
#include "daemon/service/service_options.hpp"

namespace popcut::daemon {

/// This popcutd as a node of a fleet. When the database answers, the node begins a new epoch: it
/// gets a lease and compares its journals with the database. Then it renews the lease, closes the
/// work of nodes that do not answer, and publishes the events of others. Call it on the service's
/// thread.
class FleetWatch {
 public:
  struct Parts {
    ServiceStore& store;
    JobRepository& jobs;
    DeviceRegistry& devices;
    IntentJournals& intents;
    RunningCuts& cuts;
    CutDispatcher& dispatcher;
    const ServiceOptions& options;
  };
  explicit FleetWatch(Parts parts);
  FleetWatch(const FleetWatch&) = delete;
  FleetWatch& operator=(const FleetWatch&) = delete;

  /// Begins an epoch. If the database does not answer, this succeeds, and `tick` begins one later.
  ///
  /// @retval StateConflict  another popcutd has this node's name
  [[nodiscard]] Answer<void> begin();
  /// Begins an epoch if none has begun, renews the lease, and publishes events of others. Call this
  /// about once a second.
  void tick();
  /// Gives up the lease.
  void end();
  /// Refuses while this node may neither arm nor start.
  [[nodiscard]] Answer<void> may_cut() const;
  [[nodiscard]] const NodeLease& lease() const { return lease_; }
  /// OpenMetrics lines about this node and the other ones.
  [[nodiscard]] std::string metrics();
  /// Called when the database answers for the first time; again later if it throws a StoreFault.
  std::function<void()> on_begun{};

 private:
  [[nodiscard]] bool is_held_by_own_lease() const;
  void begin_epoch();
  void log_generation() const;
  void check_open_attempts();
  void beat();
  void close_lost_nodes();
  void log_fault(const StoreFault& fault);

  Parts parts_;
  NodeLease lease_;
  bool has_begun_{false}, was_begun_{false}, has_left_{false};
  bool in_doubt_{false};
  std::int64_t beat_ms_{0};
  std::string why_{"it has not begun yet"}, logged_;
};

}  // namespace popcut::daemon
