// SPDX-License-Identifier: MIT
#include "daemon/model/wall_clock.hpp"

#include <ctime>

namespace popcut::daemon {

TimeMs wall_clock_ms() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return TimeMs{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

}  // namespace popcut::daemon
