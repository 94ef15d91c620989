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

namespace popcut::testing {

/// What an emulated USB device is, as it stands in its descriptors and in sysfs.
struct UsbfsShape {
  std::uint16_t vendor{0x0b4d}, product{0x112f};  ///< Cameo 3
  std::string serial{"51053P"}, manufacturer{"Silhouette"}, name{"CAMEO 3"};
  int bus{1}, port{1}, address{2};
  std::string driver{"usblp"};  ///< of the kernel, bound to interface 0; empty: none
  std::uint8_t out_endpoint{0x01}, in_endpoint{0x82};
  bool interrupt_endpoint{false};  ///< a third one, as the Portrait V1 has
  std::uint8_t interface_class{7}, interface_protocol{2};
};

/// A test must own one of these before anything of libusb is called. Its folder stands for /sys and
/// /dev as long as it lives; programs started meanwhile see it too.
class UsbTestbed {
 public:
  UsbTestbed();
  UsbTestbed(const UsbTestbed&) = delete;
  UsbTestbed& operator=(const UsbTestbed&) = delete;
  ~UsbTestbed();
  [[nodiscard]] UMockdevTestbed* get() const { return testbed_; }
  [[nodiscard]] std::string root() const;

 private:
  UMockdevTestbed* testbed_;
};

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
  [[nodiscard]] std::string node() const;

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
  [[nodiscard]] std::vector<std::uint8_t> descriptors() const;
  [[nodiscard]] std::string sysfs_path() const;
  [[nodiscard]] std::string sysfs_entry() const;

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
