// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <umockdev.h>

#include "tests/support/usb_testbed.hpp"
#include "tests/support/usbfs_shape.hpp"

namespace popcut::testing {

/// A USB device behind an emulated usbfs node: the libusb under test is the unmodified one.
///
/// The node is the slave end of a pty, so that poll() tells what the kernel's does: writable while
/// a finished transfer waits to be fetched, hung up once the device is gone.
class UsbfsDevice {
 public:
  /// What the device does with bytes from the host: how many it takes now, and if not all of them,
  /// whether the host has to wait (0) or the transfer ends with an errno (-EPIPE, -EPROTO).
  struct Took {
    std::size_t bytes{};
    int status{};
  };

  UsbfsDevice(const UsbTestbed& testbed, UsbfsShape shape = {});
  UsbfsDevice(const UsbfsDevice&) = delete;
  UsbfsDevice& operator=(const UsbfsDevice&) = delete;
  ~UsbfsDevice();

  void plug();
  /// `plug`, if it is not plugged in.
  void plug_again();
  /// Transfers under way end with `status`: -ESHUTDOWN, or -EPROTO as many controllers say first.
  void unplug(int status = -108);

  /// Called with the device locked, on a thread of umockdev; takes everything by default.
  std::function<Took(std::span<const std::byte>)> on_out;
  /// There is room again: offers what waits to `on_out` once more.
  void retry();
  void send_in(std::span<const std::byte> bytes);
  /// One transfer inward ends with `status`; -EPIPE halts the endpoint until it is cleared.
  void fail_in(int status);
  /// The next transfer is not taken by the kernel.
  void fail_submit(int positive_errno);
  /// A controller that hangs: transfers that are called back are not given back.
  void keep_discarded(bool keep);
  /// The kernel's driver as it would be found now.
  [[nodiscard]] std::string driver() const;

  struct Counts {
    std::uint64_t detaches{}, attaches{}, clear_halts{}, resets{}, discards{}, idle_reaps{};
  };
  [[nodiscard]] Counts counts() const;
  [[nodiscard]] std::string node() const { return shape_.node(); }

 private:
  struct Transfer {
    UMockdevIoctlClient* client{};
    UMockdevIoctlData* urb{};
    UMockdevIoctlData* buffer{};
    std::size_t done{};
  };
  struct Endpoint {
    bool halted{false};
    int fail{};
  };
  /// Lets late callbacks of clients find out that the device is no more.
  struct Life {
    std::mutex mutex;
    UsbfsDevice* device{};
  };

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static void on_client_gone(gpointer life, GObject* client);
  gboolean serve(UMockdevIoctlClient* client);
  gboolean serve_driver(UMockdevIoctlClient* client, unsigned long request);
  gboolean serve_transfer(UMockdevIoctlClient* client, unsigned long request);
  gboolean submit(UMockdevIoctlClient* client);
  gboolean discard(UMockdevIoctlClient* client);
  gboolean reap(UMockdevIoctlClient* client);
  void control(Transfer transfer);
  void move_data();
  void move_once();
  int move_out(Transfer& transfer, Endpoint& endpoint);
  int move_in(Transfer& transfer, Endpoint& endpoint);
  void finish(const Transfer& transfer, int status);
  void show_poll();
  void forget(UMockdevIoctlClient* client);

  const UsbTestbed& testbed_;
  UsbfsShape shape_;
  UMockdevIoctlBase* handler_;
  std::shared_ptr<Life> life_ = std::make_shared<Life>();
  mutable std::recursive_mutex mutex_;
  std::deque<Transfer> pending_, finished_;
  std::map<std::uint8_t, Endpoint> endpoints_;
  std::vector<std::uint8_t> inward_;
  UMockdevIoctlClient* claimed_{};
  std::vector<UMockdevIoctlClient*> clients_;
  std::string driver_;
  bool plugged_{false}, attached_{false}, moving_{false}, again_{false}, keep_discarded_{false};
  int fail_submit_{};
  int master_{-1}, slave_{-1};
  Counts counts_;
};

}  // namespace popcut::testing
