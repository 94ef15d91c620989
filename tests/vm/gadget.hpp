// SPDX-License-Identifier: MIT
#pragma once

#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "device/sim/sim_cutter.hpp"

namespace popcut::testing {

struct [[gnu::packed]] Endpoints {
  usb_interface_descriptor interface;
  usb_endpoint_descriptor_no_audio out, in;
};

inline Endpoints endpoints(std::uint16_t packet) {
  return {{sizeof(usb_interface_descriptor), USB_DT_INTERFACE, 0, 0, 2, USB_CLASS_PRINTER, 1, 2, 1},
          {sizeof(usb_endpoint_descriptor_no_audio), USB_DT_ENDPOINT, 1, USB_ENDPOINT_XFER_BULK,
           htole16(packet), 0},
          {sizeof(usb_endpoint_descriptor_no_audio), USB_DT_ENDPOINT, 2 | USB_DIR_IN,
           USB_ENDPOINT_XFER_BULK, htole16(packet), 0}};
}

struct [[gnu::packed]] Descriptors {
  usb_functionfs_descs_head_v2 head;
  __le32 full_speed, high_speed;
  Endpoints full, high;
};

struct [[gnu::packed]] Strings {
  usb_functionfs_strings_head head;
  __le16 language;
  char name[7];
};

/// The simulated cutter behind a USB gadget. Its kernel side is made in configfs by `init` or
/// `service_test`, its endpoints are served here.
class Gadget {
 public:
  /// @param speedup  the cutter's clock runs so many times as fast as the machine's
  explicit Gadget(SimCutter cutter, double speedup = 1)
      : speedup_(speedup), cutter_(std::move(cutter)) {
    control_ = ::open("/dev/ffs/ep0", O_RDWR);
    Descriptors d{{htole32(FUNCTIONFS_DESCRIPTORS_MAGIC_V2), htole32(sizeof(Descriptors)),
                   htole32(FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC)},
                  htole32(3),
                  htole32(3),
                  endpoints(64),
                  endpoints(512)};
    Strings s{{htole32(FUNCTIONFS_STRINGS_MAGIC), htole32(sizeof(Strings)), htole32(1), htole32(1)},
              htole16(0x409),
              "Cutter"};
    lawful_ =
        ::write(control_, &d, sizeof d) == sizeof d && ::write(control_, &s, sizeof s) == sizeof s;
    out_ = ::open("/dev/ffs/ep1", O_RDWR);
    in_ = ::open("/dev/ffs/ep2", O_RDWR);
    events_ = std::thread([this] { serve_control(); });
    data_ = std::thread([this] { serve_out(); });
    clock_ = std::thread([this] { serve_in(); });
    events_.detach();  // both block in the kernel until the machine goes off
    data_.detach();
    clock_.detach();
  }

  /// The kernel took the descriptors.
  [[nodiscard]] bool lawful() const { return lawful_; }
  static void plug(bool in) {
    std::ofstream("/sys/kernel/config/usb_gadget/c/UDC") << (in ? "dummy_udc.0\n" : "\n");
  }
  void deaf_after(std::uint64_t bytes) { deaf_after_ = bytes; }

  /// Calls `look` with the cutter, which stands still meanwhile.
  template <typename Look>
  auto with_cutter(Look look) {
    const std::lock_guard lock(mutex_);
    return look(cutter_);
  }
  /// A sheet laid in: the cutter as new, its clock at zero.
  void fresh(SimCutter cutter) {
    const std::lock_guard lock(mutex_);
    cutter_ = std::move(cutter);
    base_ = {};
    begun_ = Clock::now();
  }
  /// From now on its clock runs so many times as fast as the machine's.
  void run_at(double speedup) {
    const std::lock_guard lock(mutex_);
    base_ = time();
    begun_ = Clock::now();
    speedup_ = speedup;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kMoment{1};

  [[nodiscard]] SimCutter::Time time() const {
    return base_ + std::chrono::duration_cast<SimCutter::Time>((Clock::now() - begun_) * speedup_);
  }

  void serve_control() {
    for (usb_functionfs_event event{};;) {
      if (::read(control_, &event, sizeof event) <= 0) {
        std::this_thread::sleep_for(kMoment);
        continue;
      }
      if (event.type != FUNCTIONFS_SETUP) continue;
      const char status = 0x18;  // GET_PORT_STATUS
      if ((event.u.setup.bRequestType & USB_DIR_IN) != 0)
        static_cast<void>(::write(control_, &status, 1) + 0);
      else
        static_cast<void>(::read(control_, nullptr, 0) + 0);
    }
  }
  void serve_out() {
    std::array<std::byte, 512> room{};
    for (;;) {
      while (taken_ >= deaf_after_) std::this_thread::sleep_for(kMoment);  // the host gets NAKs
      const ssize_t count = ::read(out_, room.data(), room.size());
      if (count <= 0) {
        std::this_thread::sleep_for(2 * kMoment);
        continue;
      }
      taken_ += static_cast<std::uint64_t>(count);
      std::span<const std::byte> rest(room.data(), static_cast<std::size_t>(count));
      while (!rest.empty()) {
        {
          const std::lock_guard lock(mutex_);
          cutter_.run_until(time());
          rest = rest.subspan(cutter_.accept(rest));
        }
        if (!rest.empty()) std::this_thread::sleep_for(kMoment);
      }
    }
  }
  void serve_in() {
    for (;; std::this_thread::sleep_for(kMoment)) {
      std::vector<std::byte> replies;
      {
        const std::lock_guard lock(mutex_);
        cutter_.run_until(time());
        replies = cutter_.take_replies();
      }
      if (!replies.empty()) static_cast<void>(::write(in_, replies.data(), replies.size()) + 0);
    }
  }

  double speedup_;
  bool lawful_{false};
  int control_{-1}, out_{-1}, in_{-1};
  std::mutex mutex_;
  SimCutter cutter_;
  SimCutter::Time base_{};
  Clock::time_point begun_{Clock::now()};
  std::atomic<std::uint64_t> taken_{0}, deaf_after_{~std::uint64_t{0}};
  std::thread events_, data_, clock_;
};

}  // namespace popcut::testing
