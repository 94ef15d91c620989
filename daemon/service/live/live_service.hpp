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

/// The service over a store, and what its owner asks of it besides.
class LiveService : public Service {
 public:
  virtual ~LiveService() = default;
  /// Cuts that end from now on do so because popcutd stops: interrupted, reason `shutdown`. No new
  /// cut begins. Then `Cutters::stop_all`, from any thread but the service's.
  virtual void stopping() = 0;
  /// In a fleet: another node told this one something (`kAccessChanged`, else: there are events).
  virtual void on_fleet_notice(const std::string& news) = 0;
  /// In a fleet: ends this node in order. After the cuts have ended.
  virtual void leave_fleet() = 0;
  /// Periodic work: expired arms, old rows, the disk. `make_service` calls it once
  /// a second.
  virtual void tick() = 0;
  /// What the check of all of the database says, which goes on while the service begins: empty, it
  /// is sound, and knives may be armed; else nothing is written any more. On the service's thread.
  virtual void checked(const std::string& damage) = 0;
  /// Changes the options; queued, armed and cutting jobs stay as they are. On the service's thread.
  virtual void retune(ServiceTuning tuning) = 0;

 protected:
  explicit LiveService(const Service& parts) : Service(parts) {}
};

/// Starts the service on `thread`. First, one transaction corrects what the last
/// run left (cutting and paused jobs are interrupted, armed ones ready, planning ones queued), then
/// planning goes on. Never starts or resumes a cut.
///
/// The parts must outlive the service; it is destroyed after `thread` was stopped, or on it.
/// Planner and cutters go before `thread`, since they may still post to it.
///
/// @retval Unwritable  the store could not be read or written
/// @retval Malformed   the database is damaged, and a copy was set aside: popcutd exits 78
[[nodiscard]] Result<std::unique_ptr<LiveService>> make_service(Store& store, ServiceThread& thread,
                                                                Planner& planner, Cutters& cutters,
                                                                ServiceOptions options);

}  // namespace popcut::daemon
