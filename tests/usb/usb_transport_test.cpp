// SPDX-License-Identifier: MIT
// The unmodified libusb against an emulated device, from finding it to losing it.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <future>
#include <thread>

#include <catch2/catch.hpp>

#include "device/usb/usb_bus.hpp"
#include "tests/support/sim_bench.hpp"
#include "tests/support/usbfs_device.hpp"

namespace usb_transport_test {

using namespace popcut;
using namespace popcut::testing;
using namespace std::chrono_literals;

namespace {

using Took = UsbfsDevice::Took;

struct Bus {
  UsbTestbed testbed;
  UsbfsDevice device;

  explicit Bus(UsbfsShape shape = {}) : device(testbed, std::move(shape)) { device.plug(); }
};

std::string text(const std::vector<std::byte>& bytes) {
  std::string out;
  for (const std::byte byte : bytes) out += static_cast<char>(byte);
  return out;
}

/// Takes bytes up to a limit and has the host wait from then on.
struct Limited {
  std::atomic<std::size_t> room{0};
  std::string got;

  Took take(std::span<const std::byte> bytes) {
    const std::size_t count = std::min(bytes.size(), room.load());
    room -= count;
    for (const std::byte byte : bytes.first(count)) got += static_cast<char>(byte);
    return {count, 0};
  }
};

template <typename T>
ErrorKind kind(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().kind;
}

double cpu_seconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec) * 1e-6;
}

}  // namespace

TEST_CASE("a cutter is found with its serial its name and its endpoints", "[device][usb]") {
  UsbfsShape portrait{.vendor = 0x0b4d, .product = 0x1123, .name = "Portrait"};
  portrait.interrupt_endpoint = true;
  portrait.out_endpoint = 0x02;
  portrait.in_endpoint = 0x81;
  Bus bus(portrait);
  const UsbBus usb = value(UsbBus::open());
  const std::vector<UsbDevice> devices = usb.devices();
  REQUIRE(devices.size() == 1);
  const UsbDevice& found = devices.front();
  CHECK(found.id == "usb:51053P");
  CHECK(found.port == "1-1");
  CHECK(found.node == "/dev/bus/usb/001/002");
  CHECK(found.vendor_id == 0x0b4d);
  CHECK(found.product_id == 0x1123);
  CHECK(found.manufacturer == "Silhouette");
  CHECK(found.product == "Portrait");
  CHECK(found.interface.printer);
  CHECK(found.interface.out_endpoint == 0x02);
  CHECK(found.interface.in_endpoint == 0x81);
  CHECK(found.interface.max_packet_bytes == 64);
  const auto machines = value(all_machines());
  const auto fits = recognise(found, machines);
  REQUIRE(fits.size() == 1);
  CHECK(fits.front()->name == "portrait");
  // Looking at it sent it nothing and took it from nobody.
  CHECK(bus.device.driver() == "usblp");
  CHECK(bus.device.counts().detaches == 0);
}

TEST_CASE("a device without a unique serial is named by its port", "[device][usb]") {
  UsbTestbed testbed;
  UsbfsDevice first(testbed, {.serial = "SAME", .port = 1, .address = 2});
  UsbfsDevice second(testbed, {.serial = "SAME", .port = 2, .address = 3});
  UsbfsDevice odd(testbed, {.serial = "a b", .port = 3, .address = 4});
  UsbfsDevice like_port(testbed, {.serial = "1-9", .port = 4, .address = 5});
  for (UsbfsDevice* device : {&first, &second, &odd, &like_port}) device->plug();
  const UsbBus usb = value(UsbBus::open());
  std::vector<std::string> ids;
  for (const UsbDevice& device : usb.devices()) ids.push_back(device.id);
  std::sort(ids.begin(), ids.end());
  CHECK(ids == std::vector<std::string>{"usb:1-1", "usb:1-2", "usb:1-3", "usb:1-4"});
  const auto both = usb.connect("usb:SAME");
  CHECK(kind(both) == ErrorKind::Refused);
  CHECK(both.error().detail.find("usb:1-1") != std::string::npos);
  CHECK(both.error().detail.find("usb:1-2") != std::string::npos);
  CHECK(usb.connect("usb:1-2"));
  CHECK(kind(usb.connect("usb:none")) == ErrorKind::DeviceGone);
}

TEST_CASE("a keyboard and a printer that only takes HTTP are not cutters", "[device][usb]") {
  UsbTestbed testbed;
  UsbfsDevice keyboard(testbed, {.port = 1, .address = 2, .interface_class = 3});
  UsbfsDevice ipp(testbed, {.port = 2, .address = 3, .interface_protocol = 4});
  keyboard.plug();
  ipp.plug();
  CHECK(value(UsbBus::open()).devices().empty());
}

TEST_CASE("bytes go out and replies come in through the real libusb", "[device][usb]") {
  Bus bus;
  std::string got;
  bus.device.on_out = [&](std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) got += static_cast<char>(byte);
    if (got.ends_with("\x1b\x05")) bus.device.send_in(testing::bytes("0\x03"));
    return Took{bytes.size(), 0};
  };
  const UsbBus usb = value(UsbBus::open());
  const auto cable = value(usb.connect("usb:51053P"));
  CHECK(cable->displaced_driver() == "usblp");
  std::string program(100'000, 'D');
  const auto sent = cable->write(bytes(program), cable->now() + 60s);
  CHECK_FALSE(sent.error);
  CHECK(sent.taken == program.size());
  CHECK(got == program);
  CHECK_FALSE(cable->write(bytes("\x1b\x05"), cable->now() + 20s).error);
  CHECK(text(value(cable->read(cable->now() + 20s))) == "0\x03");
  CHECK(kind(cable->read(cable->now())) == ErrorKind::Timeout);
  const auto before = cable->now();
  CHECK(kind(cable->read(before + 50ms)) == ErrorKind::Timeout);
  CHECK(cable->now() - before >= 50ms);
  // A long reply comes whole, in as many pieces as it takes.
  bus.device.send_in(testing::bytes(std::string(3000, 'x')));
  std::string long_reply;
  while (long_reply.size() < 3000) long_reply += text(value(cable->read(cable->now() + 20s)));
  CHECK(long_reply == std::string(3000, 'x'));
  CHECK(bus.device.counts().resets == 0);
}

TEST_CASE("the kernel driver is detached from the cutter and attached again at the end",
          "[device][usb]") {
  Bus bus;
  const UsbBus usb = value(UsbBus::open());
  CHECK(usb_use(usb.devices().front()).driver == "usblp");
  CHECK(usb_use(usb.devices().front()).state == UsbState::Free);
  {
    const auto cable = value(usb.connect("usb:51053P"));
    CHECK(bus.device.driver().empty());
    CHECK(usb_use(usb.devices().front()).state == UsbState::Busy);
    CHECK(usb_use(usb.devices().front()).driver == "usbfs");
  }
  CHECK(bus.device.driver() == "usblp");
  CHECK(bus.device.counts().detaches == 1);
  CHECK(bus.device.counts().attaches == 1);
  CHECK(usb_use(usb.devices().front()).state == UsbState::Free);
}

TEST_CASE("opening a cutter that another program uses is refused", "[device][usb]") {
  Bus bus;
  const UsbBus usb = value(UsbBus::open());
  auto first = value(usb.connect("usb:51053P"));
  const UsbBus elsewhere = value(UsbBus::open());
  const auto second = elsewhere.connect("usb:51053P");
  CHECK(kind(second) == ErrorKind::Refused);
  CHECK(second.error().detail.find("another program uses the cutter") != std::string::npos);
  CHECK(second.error().place == "usb:51053P");
  first.reset();
  CHECK(elsewhere.connect("usb:51053P"));
}

TEST_CASE("a missing permission has its own error that names the device node", "[device][usb]") {
  Bus bus;
  const UsbBus usb = value(UsbBus::open());
  const UsbDevice found = usb.devices().front();
  const bool root = ::geteuid() == 0;
  if (root)
    REQUIRE(::seteuid(65534) == 0);  // the pty behind the node belongs to root
  else
    REQUIRE(::chmod((bus.testbed.root() + bus.device.node()).c_str(), 0) == 0);
  const auto refused = usb.connect(found.id);
  const UsbUse use = usb_use(found);
  if (root) REQUIRE(::seteuid(0) == 0);
  CHECK(kind(refused) == ErrorKind::Refused);
  CHECK(refused.error().detail.find("no permission to use /dev/bus/usb/001/002") !=
        std::string::npos);
  CHECK(refused.error().detail.find("popcut doctor") != std::string::npos);
  CHECK(use.state == UsbState::NoPermission);
}

TEST_CASE("a timeout counts exactly what the cutter took and the rest follows", "[device][usb]") {
  Bus bus;
  Limited limited;
  limited.room = 1000;
  bus.device.on_out = [&](std::span<const std::byte> bytes) { return limited.take(bytes); };
  const UsbBus usb = value(UsbBus::open());
  const auto cable = value(usb.connect("usb:51053P"));
  std::string program;
  for (int i = 0; i < 10'000; ++i) program += static_cast<char>('A' + i % 26);
  const double cpu = cpu_seconds();
  const auto start = cable->now();
  const auto first = cable->write(bytes(program), start + 1500ms);
  REQUIRE(first.error);
  CHECK(first.error->kind == ErrorKind::Timeout);
  CHECK(first.taken == 1000);
  CHECK(first.in_doubt == 0);
  CHECK(cable->now() - start < 20s);
  CHECK(cpu_seconds() - cpu < 0.1);  // it waited, it did not spin
  limited.room = 100'000;
  const auto rest = cable->write(bytes(program).subspan(first.taken), cable->now() + 60s);
  CHECK_FALSE(rest.error);
  CHECK(limited.got == program);
  CHECK(cable->write(bytes("x"), cable->now() - 1s).taken == 0);
}

TEST_CASE("a slow cutter takes a long program byte by byte as it drains", "[device][usb]") {
  Bus bus;
  Limited limited;
  bus.device.on_out = [&](std::span<const std::byte> bytes) { return limited.take(bytes); };
  const UsbBus usb = value(UsbBus::open());
  const auto cable = value(usb.connect("usb:51053P"));
  const std::string program(20'000, 'd');
  std::atomic<bool> stop{false};
  std::thread drain([&] {
    while (!stop) {
      if (limited.room < 137) limited.room += 137;  // it buffers no more while nobody sends
      bus.device.retry();
      std::this_thread::sleep_for(1ms);
    }
  });
  std::size_t at = 0;
  int timeouts = 0;
  while (at < program.size()) {
    const auto end = cable->write(bytes(program).subspan(at), cable->now() + 20ms);
    at += end.taken;
    if (!end.error) break;
    REQUIRE(end.error->kind == ErrorKind::Timeout);
    ++timeouts;
  }
  stop = true;
  drain.join();
  CHECK(limited.got == program);
  CHECK(timeouts > 1);
}

TEST_CASE("a stall ends the write after the bytes before it and is cleared once", "[device][usb]") {
  Bus bus;
  std::size_t got = 0;
  bool struck = false;
  bus.device.on_out = [&](std::span<const std::byte> bytes) {
    const std::size_t count = struck ? bytes.size() : std::min<std::size_t>(bytes.size(), 640);
    got += count;
    const int status = struck ? 0 : -EPIPE;
    struck = true;
    return Took{count, status};
  };
  const UsbBus usb = value(UsbBus::open());
  const auto cable = value(usb.connect("usb:51053P"));
  const std::string program(2000, 'p');
  const auto end = cable->write(bytes(program), cable->now() + 20s);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::Refused);
  CHECK(end.error->reason == ErrorReason::Stalled);
  CHECK(end.taken == 640);
  CHECK(end.in_doubt == 64);
  CHECK(got == 640);  // nothing went out again
  CHECK(bus.device.counts().clear_halts == 1);
  CHECK_FALSE(cable->write(bytes("\x1b\x05"), cable->now() + 20s).error);  // it can be asked again
}

TEST_CASE("a stall or a lost transfer inward loses no later reply", "[device][usb]") {
  for (const int status : {-EPIPE, -EPROTO}) {
    CAPTURE(status);
    Bus bus;
    const UsbBus usb = value(UsbBus::open());
    const auto cable = value(usb.connect("usb:51053P"));
    bus.device.fail_in(status);
    std::this_thread::sleep_for(20ms);
    bus.device.send_in(testing::bytes("1\x03"));
    CHECK(text(value(cable->read(cable->now() + 20s))) == "1\x03");
    CHECK(bus.device.counts().clear_halts == (status == -EPIPE ? 1 : 0));
  }
}

TEST_CASE("an endpoint that always fails is an error and not an endless loop", "[device][usb]") {
  const auto [status, reason] =
      GENERATE(table<int, ErrorReason>({{-EPROTO, ErrorReason::None},
                                        {-EPIPE, ErrorReason::Stalled},
                                        {-EOVERFLOW, ErrorReason::Overflow}}));
  CAPTURE(status);
  Bus bus;
  const UsbBus usb = value(UsbBus::open());
  const auto cable = value(usb.connect("usb:51053P"));
  std::atomic<bool> stop{false};
  std::thread faults([&, how = status] {
    while (!stop) {
      bus.device.fail_in(how);
      std::this_thread::sleep_for(1ms);
    }
  });
  const double cpu = cpu_seconds();
  const auto reply = cable->read(cable->now() + 60s);
  stop = true;
  faults.join();
  CHECK(kind(reply) == ErrorKind::Refused);
  CHECK(reply.error().reason == reason);
  CHECK(reply.error().detail.find("do not arrive") != std::string::npos);
  CHECK(cpu_seconds() - cpu < 1.5);
}

TEST_CASE("an unplugged cutter ends a write with what it certainly took", "[device][usb]") {
  for (const int status : {-ESHUTDOWN, -EPROTO}) {
    CAPTURE(status);
    Bus bus;
    Limited limited;
    limited.room = 5000;
    bus.device.on_out = [&](std::span<const std::byte> bytes) { return limited.take(bytes); };
    const UsbBus usb = value(UsbBus::open());
    const auto cable = value(usb.connect("usb:51053P"));
    const std::string program(10'000, 'u');
    auto written = std::async(std::launch::async,
                              [&] { return cable->write(bytes(program), cable->now() + 60s); });
    for (int i = 0; i < 60'000 && limited.room > 0; ++i) std::this_thread::sleep_for(1ms);
    REQUIRE(limited.room == 0);
    bus.device.unplug(status);
    REQUIRE(written.wait_for(60s) == std::future_status::ready);
    const auto end = written.get();
    REQUIRE(end.error);
    CHECK(end.error->kind == ErrorKind::DeviceGone);
    // The word of the hub may come too late for it on a busy machine.
    if (status == -ESHUTDOWN) CHECK(end.error->detail.find("unplugged") != std::string::npos);
    CHECK(end.taken == 5000);
    CHECK(end.in_doubt == 8192 - 5000);  // of the transfer that was under way
    // For good, even if the cutter is plugged in again.
    bus.device.plug();
    const auto later = cable->write(bytes(program), cable->now() + 20s);
    REQUIRE(later.error);
    CHECK(later.error->kind == ErrorKind::DeviceGone);
    CHECK(later.taken == 0);
    CHECK(kind(cable->read(cable->now() + 20s)) == ErrorKind::DeviceGone);
  }
}

TEST_CASE("an unplugged cutter ends a read and a rest at once", "[device][usb]") {
  Bus bus;
  const UsbBus usb = value(UsbBus::open());
  const auto cable = value(usb.connect("usb:51053P"));
  std::thread unplug([&] {
    std::this_thread::sleep_for(50ms);
    bus.device.unplug();
  });
  const auto start = cable->now();
  CHECK(kind(cable->read(start + 200s)) == ErrorKind::DeviceGone);
  cable->wait(200s);
  CHECK(cable->now() - start < 100s);
  unplug.join();
}

TEST_CASE("devices that are unplugged and plugged in again are noticed and usable",
          "[device][usb]") {
  UsbTestbed testbed;
  UsbfsDevice device(testbed);
  UsbBus usb = value(UsbBus::open());
  std::atomic<int> calls{0};
  usb.on_change([&] { ++calls; });
  CHECK(usb.devices().empty());
  for (int round = 0; round < 3; ++round) {
    CAPTURE(round);
    std::uint64_t seen = usb.changes();
    device.plug();
    REQUIRE(usb.wait_for_change(seen, 60s));
    REQUIRE(usb.devices().size() == 1);
    {
      const auto cable = value(usb.connect("usb:51053P"));
      device.send_in(testing::bytes("0\x03"));
      CHECK(text(value(cable->read(cable->now() + 20s))) == "0\x03");
    }
    seen = usb.changes();
    device.unplug();
    REQUIRE(usb.wait_for_change(seen, 60s));
    CHECK(usb.devices().empty());
    CHECK(kind(usb.connect("usb:51053P")) == ErrorKind::DeviceGone);
  }
  for (int i = 0; i < 6000 && calls < 1; ++i) std::this_thread::sleep_for(10ms);
  CHECK(calls >= 1);
  CHECK_FALSE(usb.wait_for_change(usb.changes(), 1ms));
}

TEST_CASE("a transfer that the kernel has no memory for sends nothing and is an error",
          "[device][usb]") {
  Bus bus;
  const UsbBus usb = value(UsbBus::open());
  const auto cable = value(usb.connect("usb:51053P"));
  bus.device.fail_submit(ENOMEM);
  const auto end = cable->write(bytes("M0,0\x03"), cable->now() + 20s);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::Refused);
  CHECK(end.taken == 0);
  CHECK(end.in_doubt == 0);
  CHECK_FALSE(cable->write(bytes("M0,0\x03"), cable->now() + 20s).error);
}

TEST_CASE("a controller that hangs is reported and affects nothing else", "[device][usb]") {
  Bus bus;
  Limited limited;
  limited.room = 100;
  bus.device.on_out = [&](std::span<const std::byte> bytes) { return limited.take(bytes); };
  const UsbBus usb = value(UsbBus::open());
  auto cable = value(usb.connect("usb:51053P"));
  bus.device.keep_discarded(true);
  const auto start = cable->now();
  const auto end = cable->write(bytes(std::string(500, 'h')), start + 100ms);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::DeviceGone);
  CHECK(end.error->detail.find("does not return a transfer") != std::string::npos);
  CHECK(end.taken == 0);
  CHECK(end.in_doubt == 500);
  CHECK(cable->now() - start < 60s);
  cable.reset();        // its memory stays with the kernel
  bus.device.unplug();  // and comes back at last
  std::this_thread::sleep_for(50ms);
  CHECK(value(UsbBus::open()).devices().empty());  // which lets go of it
}

TEST_CASE("a hundred plugs in a row leave no file open", "[device][usb]") {
  const auto open_files = [] {
    int count = 0;
    for (int fd = 0; fd < 1024; ++fd) count += ::fcntl(fd, F_GETFD) != -1;
    return count;
  };
  UsbTestbed testbed;
  UsbfsDevice device(testbed);
  const UsbBus usb = value(UsbBus::open());
  int before = 0;
  for (int round = 0; round < 100; ++round) {
    const std::uint64_t seen = usb.changes();
    device.plug();
    REQUIRE(usb.wait_for_change(seen, 60s));
    if (round % 10 == 0) CHECK(usb.connect("usb:51053P"));
    const std::uint64_t plugged = usb.changes();
    device.unplug();
    REQUIRE(usb.wait_for_change(plugged, 60s));
    if (round == 10) before = open_files();
  }
  for (int i = 0; i < 6000 && open_files() > before + 1; ++i) std::this_thread::sleep_for(10ms);
  CHECK(open_files() <= before + 1);
}

}  // namespace usb_transport_test
