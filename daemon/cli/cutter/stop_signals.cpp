// SPDX-License-Identifier: MIT
#include "daemon/cli/cutter/stop_signals.hpp"

namespace popcut::cli {

std::atomic<bool> StopSignals::stop_asked{false}, StopSignals::give_up_asked{false};

namespace {

static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");
extern "C" void ask_to_stop(int) {
  if (StopSignals::stop_asked.exchange(true)) StopSignals::give_up_asked = true;
}

}  // namespace

StopSignals::StopSignals() {
  stop_asked = give_up_asked = false;
  for (std::size_t k = 0; k < kStops.size(); ++k) before_[k] = std::signal(kStops[k], ask_to_stop);
  pipe_before_ = std::signal(SIGPIPE, SIG_IGN);  // who reads the progress must not end the cut
}

StopSignals::~StopSignals() {
  for (std::size_t k = 0; k < kStops.size(); ++k) std::signal(kStops[k], before_[k]);
  std::signal(SIGPIPE, pipe_before_);
}

}  // namespace popcut::cli
