// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <csignal>

namespace popcut::cli {

/// While it lives, Ctrl-C, SIGTERM and a closed terminal ask a session to stop at the end of a
/// stroke, with the tool up. A second one does not wait for the end of the stroke.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  static std::atomic<bool> stop_asked, give_up_asked;

 private:
  static constexpr std::array kStops{SIGINT, SIGTERM, SIGHUP};
  std::array<void (*)(int), kStops.size()> before_{};
  void (*pipe_before_)(int);
};

}  // namespace popcut::cli
