// SPDX-License-Identifier: MIT
#include "tests/support/usb_testbed.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

// The thread sanitizer cannot see into these libraries, whose locks are not those of pthread: what
// they do and call back counts as not locked. libusb, and popcut's threads, are looked at in full.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "race:libumockdev.so\nrace:libglib-2.0.so\nrace:libgobject-2.0.so\nrace:libudev.so\n";
}

namespace popcut::testing {
namespace {

// The calls of usbfs only reach an emulated device through umockdev's preloaded library: a test
// that is started without it starts itself again with it.
__attribute__((constructor)) void preload(int, char** argv, char**) {
  constexpr const char* kLibrary = "libumockdev-preload.so.0";
  const char* const before = std::getenv("LD_PRELOAD");
  if (before != nullptr && std::strstr(before, kLibrary) != nullptr) return;
  const std::string all =
      before == nullptr ? kLibrary : std::string(kLibrary) + " " + std::string(before);
  ::setenv("LD_PRELOAD", all.c_str(), 1);
  const char* const asan = std::getenv("ASAN_OPTIONS");  // the library comes before its runtime
  const std::string options =
      (asan == nullptr ? "" : std::string(asan) + ":") + "verify_asan_link_order=0";
  ::setenv("ASAN_OPTIONS", options.c_str(), 1);
  ::execv("/proc/self/exe", argv);
}

}  // namespace

UsbTestbed::UsbTestbed() : testbed_(umockdev_testbed_new()) {
  // Others than the owner may use it (hotplug makes a socket in it), so that a test can play an
  // unprivileged user.
  ::chmod(root().c_str(), 0777);
}

UsbTestbed::~UsbTestbed() { g_object_unref(testbed_); }

std::string UsbTestbed::root() const {
  gchar* const path = umockdev_testbed_get_root_dir(testbed_);
  std::string text = path;
  g_free(path);
  return text;
}

}  // namespace popcut::testing
