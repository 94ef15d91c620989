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
/// Calls come from one thread at a time; libusb's from the bus's own. `mutex_` guards what both
/// touch, and is never held while libusb is called.
class UsbLine {
 public:
  /// Takes over an open handle, and closes it in any case.
  [[nodiscard]] static Result<std::shared_ptr<UsbLine>> claim(std::shared_ptr<UsbBus::Shared> bus,
                                                              libusb_device_handle* handle,
                                                              const UsbDevice& device);
  UsbLine(const UsbLine&) = delete;
  UsbLine& operator=(const UsbLine&) = delete;
  ~UsbLine();
  /// Lets go of the device. A line whose transfers a hung controller keeps is kept too.
  static void retire(std::shared_ptr<UsbLine> line);
  /// Those kept whose transfers have come back since.
  static void release_retired();

  [[nodiscard]] Transport::WriteEnd send(std::span<const std::byte> piece, Deadline until);
  [[nodiscard]] Result<std::vector<std::byte>> receive(Deadline until);
  /// Sleeps, but not on when the device goes away.
  void rest(std::chrono::nanoseconds duration);

  [[nodiscard]] const UsbDevice& device() const { return device_; }
  [[nodiscard]] const std::string& displaced_driver() const { return displaced_; }
  [[nodiscard]] libusb_device_handle* handle() const { return handle_; }
  /// The bus saw it leave.
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
  /// Waits for the end of the transfer under way, calling it back at the deadline.
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
  std::optional<Error> failed_;  ///< for good: of the caller's thread alone

  std::mutex mutex_;
  std::condition_variable changed_;
  bool out_busy_{false}, in_busy_{false}, gone_{false}, closing_{false};
  Inward inward_{Inward::Fine};
  int in_faults_{};  ///< in a row
  int in_empty_{};   ///< transfers without a byte, in a row
  std::vector<std::byte> received_;
};

}  // namespace popcut
