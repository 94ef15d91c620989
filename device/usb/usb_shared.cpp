// SPDX-License-Identifier: MIT
#include "device/usb/usb_shared.hpp"

#include <sys/time.h>

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include "device/usb/usb_line.hpp"

namespace popcut {
namespace {

Error no_usb(int code) {
  return {ErrorKind::DeviceGone, "USB",
          fmt::format("not available on this computer (libusb: {}); pass the device through to the "
                      "container or virtual machine",
                      libusb_strerror(code))};
}

}  // namespace

struct UsbBus::Shared::Hooks {
  static int hotplug(libusb_context*, libusb_device* device, libusb_hotplug_event event,
                     void* self) {
    static_cast<Shared*>(self)->note(device, event == LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT);
    return 0;
  }
};

Result<void> UsbBus::Shared::start() {
  if (const int code = libusb_init(&context_); code != 0) {
    context_ = nullptr;
    return tl::unexpected(no_usb(code));
  }
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0)
    registered_ =
        libusb_hotplug_register_callback(
            context_, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0,
            LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
            Hooks::hotplug, this, &hotplug_) == LIBUSB_SUCCESS;
  thread_ = std::thread([this] { serve(); });
  return {};
}

UsbBus::Shared::~Shared() {
  if (context_ == nullptr) return;
  if (registered_) libusb_hotplug_deregister_callback(context_, hotplug_);
  stop_ = true;
  libusb_interrupt_event_handler(context_);
  if (thread_.joinable()) thread_.join();
  libusb_exit(context_);
}

void UsbBus::Shared::add(UsbLine* line) {
  const std::lock_guard lock(mutex);
  lines_.push_back(line);
}

void UsbBus::Shared::remove(UsbLine* line) {
  const std::lock_guard lock(mutex);
  std::erase(lines_, line);
}

void UsbBus::Shared::serve() {
  while (!stop_) {
    timeval most{1, 0};
    const int code = libusb_handle_events_timeout_completed(context_, &most, nullptr);
    // An error here belongs to no transfer: do nothing, but do not spin.
    if (code != 0 && code != LIBUSB_ERROR_INTERRUPTED)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    notify();
  }
}

void UsbBus::Shared::notify() {
  std::function<void()> call;
  {
    const std::lock_guard lock(mutex);
    if (changes == notified_) return;
    notified_ = changes;
    call = on_change;
  }
  if (call) call();
}

void UsbBus::Shared::note(libusb_device* device, bool left) {
  const std::lock_guard lock(mutex);
  ++changes;
  changed.notify_all();
  if (!left) return;
  for (UsbLine* const line : lines_)
    if (libusb_get_device(line->handle()) == device) line->mark_gone();
}

}  // namespace popcut
