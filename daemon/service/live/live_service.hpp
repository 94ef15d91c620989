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

/// The service, with the functions that only its owner calls: popcutd or a test.
class LiveService : public Service {
 public:
  virtual ~LiveService() = default;
  /// popcutd stops: no new cut begins, and cuts that end from now on are interrupted with the
  /// reason `shutdown`. Call `Cutters::stop_all` next, on any thread but the service's.
  virtual void stopping() = 0;
  /// In a fleet: another node sent a notice. `kAccessChanged` is about credentials; any other text
  /// says that there are new events.
  virtual void on_fleet_notice(const std::string& notice) = 0;
  /// In a fleet: gives up the lease of this node. Call this after the cuts have ended.
  virtual void leave_fleet() = 0;
  /// Periodic work, for example with expired arms, old rows and the disk. The service's thread
  /// calls this once a second.
  virtual void tick() = 0;
  /// The check of the whole database, which may run longer than the start of the service, has
  /// ended. If `damage` is empty, sheets may be armed; otherwise nothing more is written. Call this
  /// on the service's thread.
  virtual void check_ended(const std::string& damage) = 0;
  /// Changes options, for new requests only: a job that exists is kept even if it exceeds a new
  /// limit. Call this on the service's thread.
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
