// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "device/port/transport.hpp"
#include "device/usb/usb_bus.hpp"
#include "device/usb/usb_device.hpp"

struct libusb_device_handle;
struct libusb_transfer;

namespace popcut {

/// A claimed interface with its two transfers: the part of `UsbTransport` that libusb calls back.
///
/// Call it from one thread at a time; libusb calls it from the bus's thread. `mutex_` guards what
/// both use, and is never held during a call of libusb.
class UsbLine {
 public:
  /// Claims the interface of an open handle. Always takes ownership of the handle.
  [[nodiscard]] static Result<std::shared_ptr<UsbLine>> claim(std::shared_ptr<UsbBus::Shared> bus,
                                                              libusb_device_handle* handle,
                                                              const UsbDevice& device);
  UsbLine(const UsbLine&) = delete;
  UsbLine& operator=(const UsbLine&) = delete;
  ~UsbLine();
  /// Releases the device. A line whose transfers a hung controller keeps is kept alive.
  static void retire(std::shared_ptr<UsbLine> line);
  /// Releases the kept lines whose transfers have returned since.
  static void release_retired();

  [[nodiscard]] Transport::WriteEnd send(std::span<const std::byte> piece, Deadline until);
  [[nodiscard]] Result<std::vector<std::byte>> receive(Deadline until);
  /// Sleeps; ends early if the device is unplugged.
  void rest(std::chrono::nanoseconds duration);

  [[nodiscard]] const UsbDevice& device() const { return device_; }
  [[nodiscard]] const std::string& displaced_driver() const { return displaced_; }
  [[nodiscard]] libusb_device_handle* handle() const { return handle_; }
  /// The bus reported that it was unplugged.
  void mark_gone();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Inward : std::uint8_t { Fine, Stalled, Overflowed, Failed };

  UsbLine(std::shared_ptr<UsbBus::Shared> bus, libusb_device_handle* handle,
          const UsbDevice& device);
  [[nodiscard]] Result<void> take_over();
  [[nodiscard]] bool call_back();
  static void out_done(libusb_transfer* transfer);
  static void in_done(libusb_transfer* transfer);
  void take_in(const libusb_transfer& transfer);
  void listen();
  [[nodiscard]] static ErrorReason reason_of(Inward state);
  [[nodiscard]] Result<void> mend_inward(std::unique_lock<std::mutex>& lock, Deadline until);
  /// Waits for the end of the current transfer and cancels it at the deadline.
  [[nodiscard]] bool come_back(Deadline until);
  [[nodiscard]] Transport::WriteEnd judge(std::size_t length);
  [[nodiscard]] Transport::WriteEnd fail_for_good(std::size_t taken, std::size_t in_doubt,
                                                  Error error);
  [[nodiscard]] Error gone() const;

  std::shared_ptr<UsbBus::Shared> bus_;
  libusb_device_handle* handle_;
  UsbDevice device_;
  std::string displaced_;
  bool claimed_{false};
  libusb_transfer* out_{};
  libusb_transfer* in_{};
  std::vector<unsigned char> out_buffer_, in_buffer_;
  std::optional<Error> failed_;  ///< permanent; used by the caller's thread only

  std::mutex mutex_;
  std::condition_variable changed_;
  bool out_busy_{false}, in_busy_{false}, gone_{false}, closing_{false};
  Inward inward_{Inward::Fine};
  int in_faults_{};  ///< in a row
  int in_empty_{};   ///< transfers without a byte, in a row
  std::vector<std::byte> received_;
};

}  // namespace popcut
