// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "core/result.hpp"
#include "device/usb/usb_bus.hpp"

struct libusb_context;
struct libusb_device;

namespace popcut {

/// libusb's context, the thread that serves it, and those who listen for changes.
class UsbBus::Shared {
 public:
  Shared() = default;
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  ~Shared();

  [[nodiscard]] Result<void> start();
  /// Callbacks for libusb.
  struct Hooks;
  [[nodiscard]] libusb_context* context() const { return context_; }
  /// From `add` until `remove`, a line is notified when its device is unplugged.
  void add(UsbLine* line);
  void remove(UsbLine* line);

  std::mutex mutex;
  std::condition_variable changed;
  std::uint64_t changes{};
  std::function<void()> on_change;

 private:
  void note(libusb_device* device, bool left);
  void serve();
  void notify();

  libusb_context* context_{};
  int hotplug_{};
  bool registered_{false};
  std::atomic<bool> stop_{false};
  std::thread thread_;
  std::vector<UsbLine*> lines_;  ///< guarded by `mutex`
  std::uint64_t notified_{};     ///< used by the thread only
};

}  // namespace popcut
