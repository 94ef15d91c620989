// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "core/result.hpp"
#include "daemon/devices/cutters.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/service/service.hpp"
#include "daemon/service/service_options.hpp"
#include "daemon/service/service_thread.hpp"
#include "daemon/store/store.hpp"

namespace popcut::daemon {

/// The service over a store, with what its owner needs besides.
class LiveService : public Service {
 public:
  virtual ~LiveService() = default;
  /// popcutd stops: no new cut begins, and cuts that end from now on are interrupted with the
  /// reason `shutdown`. Call `Cutters::stop_all` next, on any thread but the service's.
  virtual void stopping() = 0;
  /// In a fleet: another node notified this one, of `kAccessChanged` or (any other text) of events.
  virtual void on_fleet_notice(const std::string& notice) = 0;
  /// In a fleet: gives up the lease of this node. Call this after the cuts have ended.
  virtual void leave_fleet() = 0;
  /// Periodic work: expired arms, old rows, the disk. `make_service` has it called once a second.
  virtual void tick() = 0;
  /// The check of the whole database, which runs while the service begins, is over. If `damage` is
  /// empty, sheets may be armed; else nothing is written any more. On the service's thread.
  virtual void check_ended(const std::string& damage) = 0;
  /// Changes options. Queued, armed and cutting jobs keep theirs. On the service's thread.
  virtual void retune(ServiceTuning tuning) = 0;

 protected:
  explicit LiveService(const Service& parts) : Service(parts) {}
};

/// Starts the service on `thread`. First it corrects the jobs that the last run left (see
/// `recover`), then planning continues. It never starts or resumes a cut.
///
/// The parts must outlive the service. Destroy the service on `thread`, or after `thread` was
/// stopped. Destroy planner and cutters before `thread`, since they may still post to it.
///
/// @retval Unwritable  the store could not be read or written
/// @retval Malformed   the database is damaged, and a copy was set aside: popcutd exits 78
[[nodiscard]] Result<std::unique_ptr<LiveService>> make_service(Store& store, ServiceThread& thread,
                                                                Planner& planner, Cutters& cutters,
                                                                ServiceOptions options);

}  // namespace popcut::daemon
