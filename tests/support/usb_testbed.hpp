// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include <umockdev.h>

namespace popcut::testing {

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

}  // namespace popcut::testing
