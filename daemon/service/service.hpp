// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/service/access.hpp"
#include "daemon/service/designs.hpp"
#include "daemon/service/devices.hpp"
#include "daemon/service/jobs.hpp"
#include "daemon/service/operations.hpp"

namespace popcut::daemon {

/// All that people may ask of popcutd. HTTP is a shell around it; the store below it is its only
/// memory.
///
/// Every member function is called on the service's thread (see `ServiceThread`), which owns the
/// store. What takes long (checking a design, planning, cutting) runs elsewhere and comes back as
/// an event. Functions that change something run in one transaction; what follows from it (starting
/// a planner, starting a knife) happens after the commit.
///
/// Where an `Answer` is given, a database that cannot be read is a problem (Unavailable, Internal).
/// Functions that give a plain value, and all of them within `Operations::once`, throw something
/// derived from std::exception instead: callers answer 503.
struct Service {
  Access& access;
  Designs& designs;
  Plans& plans;
  Jobs& jobs;
  Cutting& cutting;
  Devices& devices;
  Materials& materials;
  Operations& operations;
};

}  // namespace popcut::daemon
