// SPDX-License-Identifier: MIT
#include "daemon/service/live/device_dispatcher.hpp"

#include <exception>

#include <fmt/format.h>

namespace popcut::daemon {

DeviceDispatcher::~DeviceDispatcher() {
  if (reset_thread_.joinable()) reset_thread_.join();
}

std::vector<DeviceRecord> DeviceDispatcher::list() {
  std::vector<DeviceRecord> all = parts_.devices.list();
  try {
    for (DeviceRecord& one : all)
      if (const auto row = parts_.jobs.table().on_device(one.id)) one.job = row->id;
  } catch (const StoreFault& fault) {
    // The cutters of this node do not need the database of the fleet.
    if (!parts_.store.in_fleet()) throw;
    parts_.store.handle_fault(fault);
    for (DeviceRecord& one : all) one.job = parts_.cuts.job_on(one.id);
  }
  return all;
}

Answer<DeviceRecord> DeviceDispatcher::find(const std::string& id) {
  return parts_.store.read([&]() -> Answer<DeviceRecord> {
    auto found = parts_.devices.find(id);
    if (!found) return refuse(ProblemKind::NotFound, parts_.devices.unknown(id, "/device").detail);
    try {
      if (const auto row = parts_.jobs.table().on_device(id)) found->job = row->id;
    } catch (const StoreFault&) {
      if (!parts_.store.in_fleet()) throw;
      found->job = parts_.cuts.job_on(id);
    }
    return *found;
  });
}

Answer<DeviceRecord> DeviceDispatcher::act(const Principal& who, const std::string& id,
                                           std::int64_t if_match, const DeviceRequest& request) {
  const bool enabling = request.action == "enable" || request.action == "disable";
  if (who.role < (enabling ? Role::Admin : Role::Operator))
    return refuse(ProblemKind::Forbidden, enabling ? "only an admin may enable or disable devices"
                                                   : "only an operator may use devices");
  Answer<DeviceRecord> device = find(id);
  if (!device) return device;
  if (device->rev != if_match) {
    Problem stale{ProblemKind::Stale, "the device has changed; read it again"};
    stale.rev = device->rev;
    stale.state = device->state;
    return tl::unexpected(std::move(stale));
  }
  std::string test_job;
  const Answer<void> done = parts_.store.change([&]() -> Answer<void> {
    if (const auto taken = carry_out(who, *device, request, test_job); !taken) return taken;
    parts_.store.audit(who.name, request.action, id, test_job);
    return {};
  });
  if (!done) return tl::unexpected(done.error());
  if (enabling) {
    // The registry changes only after the commit, and an outer transaction may not be committed
    // yet.
    const bool enabled = request.action == "enable";
    if (device->enabled != enabled) ++device->rev;
    device->enabled = enabled;
  }
  device->test_job = test_job;
  return device;
}

Answer<void> DeviceDispatcher::carry_out(const Principal& who, const DeviceRecord& device,
                                         const DeviceRequest& request, std::string& test_job) {
  const std::string& id = device.id;
  if (parts_.devices.is_elsewhere(id) && request.action != "test-cut")
    return tl::unexpected(parts_.devices.elsewhere(id, "enable, disable or reset it there"));
  if (request.action == "enable" || request.action == "disable") {
    const bool enables = request.action == "enable";
    parts_.devices.set_enabled(id, enables);
    // Disarm the sheet in the device only after the commit, because the transaction may be rolled
    // back.
    if (!enables) parts_.store.after_commit([this, id] { parts_.dispatcher.devices_gone({id}); });
  } else if (request.action == "reset") {
    if (!device.job.empty()) {
      const Answer<JobRow> row = parts_.jobs.row(device.job);
      Problem busy{ProblemKind::StateConflict, id + " holds a sheet of job " + device.job};
      // To free the device, disarm the sheet or cancel the job.
      if (row)
        busy.next_actions = {next_action(
            row->state == JobState::Armed ? JobAction::Disarm : JobAction::Cancel, {}, row->id)};
      return tl::unexpected(std::move(busy));
    }
    if (resetting_)
      return refuse(ProblemKind::StateConflict,
                    "another reset is running; try again when it has ended");
    parts_.store.after_commit([this, id] { reset(id); });
  } else if (request.action == "test-cut") {
    if (const auto there = parts_.devices.usable(id); !there) {
      Problem unusable = there.error();
      unusable.next_actions = parts_.devices.remedies(id);
      return tl::unexpected(std::move(unusable));
    }
    const Answer<Job> job = parts_.jobs.create_test(who, id, request.material);
    if (!job) return tl::unexpected(job.error());
    test_job = job->id;
  } else {
    return refuse(ProblemKind::NotFound,
                  "the actions of a device are enable, disable, reset and test-cut");
  }
  return {};
}

// A reset waits for the device, so it has its own thread.
void DeviceDispatcher::reset(const std::string& id) {
  if (reset_thread_.joinable()) reset_thread_.join();
  resetting_ = true;
  try {
    reset_thread_ = std::thread([this, id, post = parts_.post, cutters = &parts_.cutters] {
      try {
        const Result<void> done = cutters->reset(id);
        post([this, id, done] { reset_ended(id, done); });
      } catch (const std::exception&) {  // out of memory; an uncaught exception would end popcutd
        resetting_ = false;
      }
    });
  } catch (...) {  // the thread did not start, so it will not clear the flag
    resetting_ = false;
    throw;
  }
}

void DeviceDispatcher::reset_ended(const std::string& id, const Result<void>& done) {
  resetting_ = false;
  (void)parts_.store.change([&]() -> Answer<void> {
    parts_.store.emit("notice", "",
                      JsonObject()
                          .text("device", id)
                          .text("what", "reset")
                          .text_or_null("error", done ? "" : message(done.error())));
    return {};
  });
  refresh();
}

}  // namespace popcut::daemon
