// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/service/cut_desk.hpp"
#include "daemon/service/job_book.hpp"

namespace popcut::daemon {

/// What is asked of the cutters themselves, not of a job: which there are, and enable, disable,
/// reset, test-cut.
class DeviceDesk {
 public:
  struct Parts {
    Memory& memory;
    ServiceThread& thread;
    Cutters& cutters;
    DeviceBook& devices;
    JobBook& jobs;
    CutDesk& desk;
    std::shared_ptr<void> alive;
  };
  explicit DeviceDesk(Parts parts) : parts_(std::move(parts)) {}
  ~DeviceDesk();  ///< waits for a reset that is under way
  DeviceDesk(const DeviceDesk&) = delete;
  DeviceDesk& operator=(const DeviceDesk&) = delete;

  /// All, each with the job whose sheet lies in it.
  [[nodiscard]] std::vector<DeviceRecord> list();
  [[nodiscard]] Answer<DeviceRecord> find(const std::string& id);
  [[nodiscard]] Answer<DeviceRecord> act(const Principal& who, const std::string& id,
                                         std::int64_t if_match, const DeviceWish& wish);
  /// Asks the cutters anew: sheets that were armed in those that went away are armed no more.
  void look() { parts_.desk.devices_gone(parts_.devices.refresh()); }

 private:
  [[nodiscard]] Answer<void> take(const Principal& who, const DeviceRecord& device,
                                  const DeviceWish& wish, std::string& test_job);
  void reset(const std::string& id);
  Parts parts_;
  std::thread errand_;
  bool errand_running_{false};
};

}  // namespace popcut::daemon
