// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/service/live/cut_dispatcher.hpp"
#include "daemon/service/repositories/job_repository.hpp"

namespace popcut::daemon {

/// Carries out requests for a cutter instead of a job: list, enable, disable, reset, test-cut.
class DeviceDispatcher : public Devices {
 public:
  struct Parts {
    ServiceStore& store;
    Poster post;
    Cutters& cutters;
    DeviceRegistry& devices;
    JobRepository& jobs;
    RunningCuts& cuts;
    CutDispatcher& dispatcher;
  };
  explicit DeviceDispatcher(Parts parts) : parts_(std::move(parts)) {}
  ~DeviceDispatcher() override;  ///< waits for a reset that has begun
  DeviceDispatcher(const DeviceDispatcher&) = delete;
  DeviceDispatcher& operator=(const DeviceDispatcher&) = delete;

  std::vector<DeviceRecord> list() override;
  Answer<DeviceRecord> find(const std::string& id) override;
  Answer<DeviceRecord> act(const Principal& who, const std::string& id, std::int64_t if_match,
                           const DeviceRequest& request) override;
  /// Reads the cutters again: sheets that were armed in a cutter that went away are disarmed.
  void refresh() { parts_.dispatcher.devices_gone(parts_.devices.refresh()); }

 private:
  [[nodiscard]] Answer<void> carry_out(const Principal& who, const DeviceRecord& device,
                                       const DeviceRequest& request, std::string& test_job);
  void reset(const std::string& id);
  void reset_ended(const std::string& id, const Result<void>& done);
  Parts parts_;
  std::thread reset_thread_;
  std::atomic<bool> resetting_{false};
};

}  // namespace popcut::daemon
