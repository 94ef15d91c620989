// SPDX-License-Identifier: MIT
#include "device/usb/usb_bus.hpp"

#include <algorithm>
#include <span>

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include "device/usb/usb_error.hpp"
#include "device/usb/usb_line.hpp"
#include "device/usb/usb_shared.hpp"

namespace popcut {

namespace {

/// The devices on the bus, held until destruction.
class DeviceList {
 public:
  explicit DeviceList(libusb_context* context)
      : count_(libusb_get_device_list(context, &devices_)) {}
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;
  ~DeviceList() {
    if (count_ >= 0) libusb_free_device_list(devices_, 1);
  }
  [[nodiscard]] std::span<libusb_device* const> view() const {
    return {devices_, static_cast<std::size_t>(std::max<ssize_t>(count_, 0))};
  }

 private:
  libusb_device** devices_{};
  ssize_t count_;
};

/// The usable devices with their ids, and the libusb device of each.
std::vector<UsbDevice> usable(const DeviceList& list, std::vector<libusb_device*>* raw = nullptr) {
  std::vector<UsbDevice> found;
  for (libusb_device* const device : list.view()) {
    UsbDevice described = describe(device);
    if (described.node.empty()) continue;
    found.push_back(std::move(described));
    if (raw != nullptr) raw->push_back(device);
  }
  name_devices(found);
  return found;
}

/// The index of the device that an id names by serial or by port.
Result<std::size_t> find(const std::vector<UsbDevice>& devices, const std::string& id) {
  std::vector<std::size_t> fits;
  std::string others;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const UsbDevice& device = devices[i];
    const bool by_serial = !device.serial.empty() && id == "usb:" + device.serial;
    if (id == device.id || id == "usb:" + device.port || by_serial) {
      fits.push_back(i);
      others += (others.empty() ? "" : ", ") + device.id;
    }
  }
  if (fits.empty())
    return fail(ErrorKind::DeviceGone, id,
                "no such device is plugged in; 'popcut devices' lists what is");
  if (fits.size() > 1)
    return fail(
        ErrorKind::Refused, id,
        fmt::format("{} devices have this serial; name one by its port: {}", fits.size(), others));
  return fits.front();
}

}  // namespace

Result<UsbBus> UsbBus::open() {
  UsbLine::release_retired();
  auto shared = std::make_shared<Shared>();
  if (const Result<void> started = shared->start(); !started)
    return tl::unexpected(started.error());
  return UsbBus(std::move(shared));
}

std::vector<UsbDevice> UsbBus::devices() const { return usable(DeviceList(shared_->context())); }

Result<UsbDevice> UsbBus::find(const std::string& id) const {
  std::vector<UsbDevice> found = devices();
  return popcut::find(found, id).map([&](std::size_t i) { return std::move(found[i]); });
}

Result<std::unique_ptr<UsbTransport>> UsbBus::connect(const std::string& id) const {
  const DeviceList list(shared_->context());
  std::vector<libusb_device*> raw;
  const std::vector<UsbDevice> found = usable(list, &raw);
  const Result<std::size_t> index = popcut::find(found, id);
  if (!index) return tl::unexpected(index.error());
  libusb_device_handle* handle = nullptr;
  const int code = libusb_open(raw[*index], &handle);
  if (code != 0) {
    const bool forbidden = usb_use(found[*index]).state == UsbState::NoPermission;
    return tl::unexpected(
        usb_error(forbidden ? LIBUSB_ERROR_ACCESS : code, found[*index], "opened"));
  }
  Result<std::shared_ptr<UsbLine>> line = UsbLine::claim(shared_, handle, found[*index]);
  if (!line) return tl::unexpected(line.error());
  return std::make_unique<UsbTransport>(std::move(*line));
}

std::uint64_t UsbBus::changes() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->changes;
}

bool UsbBus::wait_for_change(std::uint64_t seen, std::chrono::milliseconds most) const {
  std::unique_lock lock(shared_->mutex);
  return shared_->changed.wait_for(lock, most, [&] { return shared_->changes > seen; });
}

void UsbBus::on_change(std::function<void()> call) {
  const std::lock_guard lock(shared_->mutex);
  shared_->on_change = std::move(call);
}

}  // namespace popcut
