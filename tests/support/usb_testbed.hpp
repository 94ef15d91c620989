// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include <umockdev.h>

namespace popcut::testing {

/// A test must create one of these before it calls libusb. During its lifetime its folder replaces
/// /sys and /dev, also for programs that the test starts.
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

}  // namespace popcut::testing
