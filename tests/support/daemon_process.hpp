// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/process.hpp"

namespace popcut::testing {

/// A popcutd in a folder of its own: a free port, a socket, a simulated cutter, its traces.
class DaemonProcess {
 public:
  /// Writes popcutd.toml (`more` at its end) and starts nothing yet. The simulated cutter is a
  /// Cameo 3, whatever its id.
  explicit DaemonProcess(std::string program, double time_scale = 0, const std::string& more = "",
                         const std::string& device = "sim:cameo3");
  ~DaemonProcess();  ///< kills it, if it still runs
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  /// Starts it and waits until it serves. False: it ended before, see `log`.
  [[nodiscard]] bool start(const std::vector<std::string>& environment = {});
  void signal(int number) const;
  /// Waits for its end: the exit code, or 128 + the signal; -1 if it does not end in a minute.
  int wait();
  [[nodiscard]] std::string log() const { return text_of_file(folder_ / "log"); }
  [[nodiscard]] std::string socket() const { return (folder_ / "popcut.sock").string(); }
  [[nodiscard]] std::string state() const { return (folder_ / "state").string(); }
  [[nodiscard]] std::string config() const { return (folder_ / "popcutd.toml").string(); }
  /// "http://127.0.0.1:PORT", from the log.
  [[nodiscard]] std::string url() const;
  [[nodiscard]] const TempFolder& folder() const { return folder_; }
  [[nodiscard]] pid_t pid() const { return pid_; }

  /// What stands before the rest of the configuration of every popcutd that names no [fleet]
  /// itself; what it sets `kept` to lives as long as the popcutd. daemon_in_fleet.cpp sets it.
  static std::string (*fleet_section)(std::shared_ptr<void>& kept);

 private:
  std::shared_ptr<void> kept_;  // gone after popcutd and its folder
  TempFolder folder_;
  std::string program_;
  pid_t pid_{-1};
};

}  // namespace popcut::testing
