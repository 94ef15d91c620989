// SPDX-License-Identifier: MIT
#include "tests/support/usb_cutter.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace popcut::testing {
namespace {

SimCutter::Time seconds(double value) { return SimCutter::Time(std::llround(value * 1e9)); }

}  // namespace

UsbCutter::UsbCutter(UsbfsDevice& device, SimCutter cutter, std::vector<UsbFault> faults)
    : device_(device), cutter_(std::move(cutter)), faults_(std::move(faults)) {
  std::stable_sort(faults_.begin(), faults_.end(),
                   [](const UsbFault& a, const UsbFault& b) { return a.at_byte < b.at_byte; });
  device_.on_out = [this](std::span<const std::byte> bytes) { return take(bytes); };
  thread_ = std::thread([this] { run(); });
}

UsbCutter::~UsbCutter() {
  stop();
  device_.on_out = nullptr;
}

void UsbCutter::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

void UsbCutter::take_again() {
  const std::lock_guard lock(mutex_);
  nak_until_ = {};
}

std::uint64_t UsbCutter::accepted_bytes() {
  const std::lock_guard lock(mutex_);
  return cutter_.accepted_bytes();
}

std::size_t UsbCutter::strokes() {
  const std::lock_guard lock(mutex_);
  return cutter_.trace().strokes.size();
}

/// Faults that are due now; what the transfer under way ends with, or 0.
int UsbCutter::strike() {
  int status = 0;
  while (next_fault_ < faults_.size() && faults_[next_fault_].at_byte <= cutter_.accepted_bytes() &&
         status == 0) {
    const UsbFault& fault = faults_[next_fault_++];
    const SimCutter::Time later = elapsed() + seconds(fault.seconds);
    using Kind = UsbFault::Kind;
    switch (fault.kind) {
      case Kind::Stall:
        status = -EPIPE;
        break;
      case Kind::BusError:
        status = -EPROTO;
        break;
      case Kind::Nak:
        nak_until_ = later;
        break;
      case Kind::Silence:
        silent_until_ = later;
        break;
      case Kind::Pause:
        cutter_.pause();
        resume_at_ = later;
        break;
      case Kind::Cancel:
        cutter_.pause();
        cancel_at_ = later;
        break;
      case Kind::MediaOut:
        cutter_.unload_media();
        break;
      case Kind::Unplug:
      case Kind::UnplugLate:
        dead_ = true;
        due_.push_back(fault);
        break;
      default:
        due_.push_back(fault);
    }
  }
  return status;
}

UsbfsDevice::Took UsbCutter::take(std::span<const std::byte> bytes) {
  const std::lock_guard lock(mutex_);
  UsbfsDevice::Took took;
  while (took.bytes < bytes.size()) {
    took.status = strike();
    if (took.status != 0 || dead_ || elapsed() < nak_until_) return took;
    std::uint64_t most = bytes.size() - took.bytes;
    if (next_fault_ < faults_.size())
      most = std::min(most, faults_[next_fault_].at_byte - cutter_.accepted_bytes());
    const std::size_t got = cutter_.accept(bytes.subspan(took.bytes, most));
    took.bytes += got;
    if (got == 0) break;
  }
  return took;
}

void UsbCutter::run() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (stop_) return;
    }
    step();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void UsbCutter::step() {
  std::vector<UsbFault> due;
  std::vector<std::byte> replies;
  {
    const std::lock_guard lock(mutex_);
    const SimCutter::Time now = elapsed();
    if (now >= cancel_at_) {
      cutter_.cancel();
      cancel_at_ = SimCutter::Time::max();
    }
    if (now >= resume_at_) {
      cutter_.resume();
      resume_at_ = SimCutter::Time::max();
    }
    cutter_.run_until(now);
    replies = cutter_.take_replies();
    if (now < silent_until_ || dead_) replies.clear();
    due.swap(due_);
  }
  // The device is called without the lock: it may be calling `take` right now.
  for (const UsbFault& fault : due) {
    using Kind = UsbFault::Kind;
    if (fault.kind == Kind::Unplug) device_.unplug(-ESHUTDOWN);
    if (fault.kind == Kind::UnplugLate) device_.unplug(-EPROTO);
    if (fault.kind == Kind::SubmitFail) device_.fail_submit(ENOMEM);
    if (fault.kind == Kind::StallIn) device_.fail_in(-EPIPE);
    if (fault.kind == Kind::BusErrorIn) device_.fail_in(-EPROTO);
    if (fault.kind == Kind::Garbage) device_.send_in(std::as_bytes(std::span(fault.text)));
  }
  if (!replies.empty()) device_.send_in(replies);
  device_.retry();
}

}  // namespace popcut::testing
