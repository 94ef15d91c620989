// SPDX-License-Identifier: MIT
// Runs inside the virtual machine: the simulated cutter behind a USB gadget (FunctionFS), joined by
// dummy_hcd to the same kernel's host side, where popcut's transport finds it through real usbfs.
#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <thread>

#include "device/session.hpp"
#include "device/sim_cutter.hpp"
#include "device/usb_bus.hpp"
#include "tests/support/ledger_checks.hpp"

using namespace popcut;
using namespace popcut::testing;
using namespace std::chrono_literals;

namespace {

int failures = 0;

void check(bool held, const std::string& claim, const std::string& more = "") {
  std::printf("%s: %s%s%s\n", held ? "PASS" : "FAIL", claim.c_str(), more.empty() ? "" : ": ",
              more.c_str());
  failures += held ? 0 : 1;
}

struct [[gnu::packed]] Endpoints {
  usb_interface_descriptor interface;
  usb_endpoint_descriptor_no_audio out, in;
};

Endpoints endpoints(std::uint16_t packet) {
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

/// The gadget: its kernel side is made by `init`, its endpoints are served here.
class Gadget {
 public:
  explicit Gadget(SimCutter cutter) : cutter_(std::move(cutter)) {
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
    check(
        ::write(control_, &d, sizeof d) == sizeof d && ::write(control_, &s, sizeof s) == sizeof s,
        "the gadget's descriptors are lawful");
    out_ = ::open("/dev/ffs/ep1", O_RDWR);
    in_ = ::open("/dev/ffs/ep2", O_RDWR);
    events_ = std::thread([this] { serve_control(); });
    data_ = std::thread([this] { serve_out(); });
    clock_ = std::thread([this] { serve_in(); });
    events_.detach();  // both block in the kernel until the machine goes off
    data_.detach();
    clock_.detach();
  }

  static void plug(bool in) {
    std::ofstream("/sys/kernel/config/usb_gadget/c/UDC") << (in ? "dummy_udc.0\n" : "\n");
  }
  void deaf_after(std::uint64_t bytes) { deaf_after_ = bytes; }

  CutLines lines(const MeantLines& meant, bool all = false) {
    const std::lock_guard lock(mutex_);
    if (all) cutter_.run_dry();
    return cut_lines(cutter_.trace(), meant);
  }
  void fresh(SimCutter cutter) {
    const std::lock_guard lock(mutex_);
    cutter_ = std::move(cutter);
    begun_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void serve_control() {
    for (usb_functionfs_event event{};;) {
      if (::read(control_, &event, sizeof event) <= 0) {
        std::this_thread::sleep_for(1ms);
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
      while (taken_ >= deaf_after_) std::this_thread::sleep_for(1ms);  // the host gets NAKs
      const ssize_t count = ::read(out_, room.data(), room.size());
      if (count <= 0) {
        std::this_thread::sleep_for(2ms);
        continue;
      }
      taken_ += static_cast<std::uint64_t>(count);
      std::span<const std::byte> rest(room.data(), static_cast<std::size_t>(count));
      while (!rest.empty()) {
        {
          const std::lock_guard lock(mutex_);
          cutter_.run_until(Clock::now() - begun_);
          rest = rest.subspan(cutter_.accept(rest));
        }
        if (!rest.empty()) std::this_thread::sleep_for(1ms);
      }
    }
  }
  void serve_in() {
    for (;; std::this_thread::sleep_for(1ms)) {
      std::vector<std::byte> replies;
      {
        const std::lock_guard lock(mutex_);
        cutter_.run_until(Clock::now() - begun_);
        replies = cutter_.take_replies();
      }
      if (!replies.empty()) static_cast<void>(::write(in_, replies.data(), replies.size()) + 0);
    }
  }

  int control_{-1}, out_{-1}, in_{-1};
  std::mutex mutex_;
  SimCutter cutter_;
  Clock::time_point begun_{Clock::now()};
  std::atomic<std::uint64_t> taken_{0}, deaf_after_{~std::uint64_t{0}};
  std::thread events_, data_, clock_;
};

Machine quick() {
  Machine machine = *find_machine("cameo3");
  Motion& m = machine.motion;
  m.accel_mm_s2 = 1e6;
  m.travel_mm_s = 10000;
  m.drop_s = m.lift_s = 0.001;
  m.setup_s = m.trailer_s = m.autoblade_reset_s = m.autoblade_tap_s = 0.01;
  machine.speed_mm_s.per_step = 1000;
  return machine;
}

/// A hundred and fifty zigzags.
Toolpath zigzags() {
  Toolpath path;
  for (std::uint32_t k = 0; k < 150; ++k) {
    Stroke stroke;
    stroke.operation = Operation::Cut;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = 6;
    stroke.line = k;
    stroke.force_gf = 70;
    stroke.speed_mm_s = 5000;
    for (std::uint32_t i = 0; i < stroke.count; ++i)
      path.points.push_back({10.0 + 30 * i, 5.0 + k + 0.5 * (i % 2)});
    path.strokes.push_back(stroke);
  }
  return path;
}

std::string said(const SessionEnd& end) { return end.error ? message(*end.error) : "done"; }

std::string kernel_driver() {
  std::array<char, 256> target{};
  if (::readlink("/sys/bus/usb/devices/1-1:1.0/driver", target.data(), target.size() - 1) <= 0)
    return "none";
  const std::string path = target.data();
  return path.substr(path.rfind('/') + 1);
}

/// A fresh look at the bus: there is no udevd here to tell of changes.
std::unique_ptr<UsbTransport> connect() {
  for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(50ms)) {
    const auto bus = UsbBus::open();
    if (!bus || bus->devices().empty() || kernel_driver() == "none") continue;
    auto cable = bus->connect("usb:51053P");
    if (cable) return std::move(*cable);
    std::printf("note: %s\n", message(cable.error()).c_str());
  }
  return nullptr;
}

}  // namespace

int main() {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const Machine machine = quick();
  Material paper = *find_material("paper-220");
  paper.blade_offset_mm = 0;
  const Toolpath path = zigzags();
  const EncodedProgram program = *encode(path, machine, paper, {});
  const MeantLines meant(path, machine.unit_mm);
  SessionOptions options;
  options.window_s = 0.5;
  options.poll_s = 0.05;
  const auto cutter = [&] { return *SimCutter::make(machine); };
  Gadget gadget(cutter());
  Gadget::plug(true);

  // 1. A whole sheet.
  auto cable = connect();
  check(cable != nullptr, "the cutter is found and claimed through the kernel's usbfs");
  if (cable == nullptr) return 1;
  check(cable->displaced_driver() == "usblp", "usblp had it and let go", cable->displaced_driver());
  const UsbInterface& interface = cable->device().interface;
  check(interface.printer && interface.out_endpoint != 0 && (interface.in_endpoint & 0x80) != 0,
        "its endpoints are those of its descriptors");
  check(UsbBus::open()->connect("usb:51053P").error().detail.find("another program") == 0,
        "a second opener is refused");
  SessionEnd end = run_session(*cable, machine, program, options);
  check(!end.error && end.confirmed, "a whole sheet is streamed", said(end));
  std::string wrong = untrue(end, gadget.lines(meant), gadget.lines(meant, true), meant);
  check(wrong.empty() && gadget.lines(meant).whole == meant.lines.size(),
        "the cutter drew every line once", wrong);
  cable.reset();
  for (int i = 0; i < 40 && kernel_driver() != "usblp"; ++i) std::this_thread::sleep_for(50ms);
  check(kernel_driver() == "usblp", "usblp has it back", kernel_driver());

  // 2. Unplugged in the middle, then plugged in again.
  gadget.fresh(cutter());
  cable = connect();
  std::thread hand([&] {
    for (int i = 0; i < 2000 && gadget.lines(meant).begun < 40; ++i)
      std::this_thread::sleep_for(1ms);
    Gadget::plug(false);
  });
  end = run_session(*cable, machine, program, options);
  hand.join();
  check(end.error && end.error->kind == ErrorKind::DeviceGone, "unplugging ends the sheet",
        said(end));
  wrong = untrue(end, gadget.lines(meant), gadget.lines(meant, true), meant);
  check(wrong.empty(), "the ledger is true", wrong);
  cable.reset();
  gadget.fresh(cutter());
  Gadget::plug(true);
  cable = connect();
  check(cable != nullptr && gadget.lines(meant, true).begun == 0,
        "plugged in again it is sent nothing");
  end = run_session(*cable, machine, program, options);
  check(!end.error, "and cuts the next sheet", said(end));

  // 3. A cutter that takes no more: the count of a timeout is exact.
  gadget.deaf_after(0);
  std::this_thread::sleep_for(20ms);
  const std::string ahead(8192, '\x03');
  const auto write = cable->write(std::as_bytes(std::span(ahead)), cable->now() + 500ms);
  check(write.error && write.error->kind == ErrorKind::Timeout && write.taken <= 512,
        "a deaf cutter is a timeout with an exact count", std::to_string(write.taken));
  std::printf("%s\n", failures == 0 ? "ALL PASSED" : "SOME FAILED");
  std::fflush(stdout);
  std::_Exit(failures == 0 ? 0 : 1);
}
