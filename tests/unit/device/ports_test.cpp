// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <catch2/catch.hpp>

#include "device/port/device_id.hpp"
#include "device/port/file_transport.hpp"
#include "device/port/port_transport.hpp"
#include "device/port/ports.hpp"
#include "device/session/session.hpp"
#include "tests/support/process.hpp"
#include "tests/support/sim_bench.hpp"

namespace ports_test {

using namespace popcut;
using namespace popcut::testing;
using namespace std::chrono_literals;

namespace {

/// A pty: its slave end is the port, the test is the machine at the other.
struct Pty {
  int master{-1}, slave{-1};
  std::string path;

  Pty() {
    std::array<char, 64> name{};
    REQUIRE(::openpty(&master, &slave, nullptr, nullptr, nullptr) == 0);
    REQUIRE(::ttyname_r(slave, name.data(), name.size()) == 0);
    path = name.data();
    termios raw{};
    ::tcgetattr(slave, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(slave, TCSANOW, &raw);
  }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;
  ~Pty() { hang_up(); }
  void hang_up() {
    if (slave >= 0) ::close(slave);
    if (master >= 0) ::close(master);
    master = slave = -1;
  }
  /// What arrives until nothing came for 50 ms, but `least` bytes, which the kernel brings over in
  /// its own time; at most a minute.
  [[nodiscard]] std::string received(std::size_t least = 0) const {
    std::string text;
    std::array<char, 4096> room{};
    ::fcntl(master, F_SETFL, O_NONBLOCK);
    for (int quiet = 0; quiet < 10 || (text.size() < least && quiet < 12'000);) {
      const ssize_t count = ::read(master, room.data(), room.size());
      if (count > 0) {
        text.append(room.data(), static_cast<std::size_t>(count));
        quiet = 0;
      } else {
        ++quiet;
        std::this_thread::sleep_for(5ms);
      }
    }
    return text;
  }
  void say(std::string_view text) const {
    REQUIRE(::write(master, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
  }
};

std::string text(const std::vector<std::byte>& bytes) {
  std::string out;
  for (const std::byte byte : bytes) out += static_cast<char>(byte);
  return out;
}

template <typename T>
ErrorKind kind(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().kind;
}

}  // namespace

TEST_CASE("a serial port carries bytes both ways", "[device][serial]") {
  const Pty pty;
  const auto port = value(PortTransport::open_serial(pty.path, {19200, FlowControl::None}));
  termios set{};
  REQUIRE(::tcgetattr(pty.slave, &set) == 0);
  CHECK(::cfgetospeed(&set) == B19200);
  CHECK_FALSE(port->write(bytes("IN;PU0,0;"), port->now() + 20s).error);
  CHECK(pty.received(9) == "IN;PU0,0;");
  CHECK(port->in_transit() == 0);
  pty.say("0\x03");
  CHECK(text(value(port->read(port->now() + 20s))) == "0\x03");
  const auto before = port->now();
  CHECK(kind(port->read(before + 50ms)) == ErrorKind::Timeout);
  CHECK(port->now() - before >= 50ms);
  CHECK(kind(port->read(port->now())) == ErrorKind::Timeout);
}

TEST_CASE("a full serial port takes what fits and continues at the exact byte",
          "[device][serial]") {
  const Pty pty;
  const auto port = value(PortTransport::open_serial(pty.path, {}));
  std::string program;
  for (int i = 0; i < 200'000; ++i) program += static_cast<char>('A' + i % 26);
  const auto first = port->write(bytes(program), port->now() + 100ms);
  REQUIRE(first.error);
  CHECK(first.error->kind == ErrorKind::Timeout);
  CHECK(first.taken > 0);
  CHECK(first.taken < program.size());
  std::string got;
  std::size_t at = first.taken;
  while (at < program.size()) {
    got += pty.received();
    const auto end = port->write(bytes(program).subspan(at), port->now() + 20ms);
    at += end.taken;
    if (end.error) REQUIRE(end.error->kind == ErrorKind::Timeout);
  }
  got += pty.received(program.size() - got.size());
  CHECK(got == program);
}

TEST_CASE("software flow control holds the program back", "[device][serial]") {
  const Pty pty;
  const auto port = value(PortTransport::open_serial(pty.path, {9600, FlowControl::XonXoff}));
  pty.say("\x13");
  // The kernel brings it over in its own time, and then has no room.
  const auto has_room = [&] {
    pollfd line{pty.slave, POLLOUT, 0};
    return ::poll(&line, 1, 0) == 1;
  };
  for (int i = 0; i < 12'000 && has_room(); ++i) std::this_thread::sleep_for(5ms);
  CHECK_FALSE(has_room());
  const auto held = port->write(bytes("PD1,1;"), port->now() + 100ms);
  REQUIRE(held.error);
  CHECK(held.error->kind == ErrorKind::Timeout);
  CHECK(held.taken == 0);
  pty.say("\x11");
  CHECK_FALSE(port->write(bytes("PD1,1;"), port->now() + 20s).error);
  CHECK(pty.received(6) == "PD1,1;");
}

TEST_CASE("a serial port can be open in one program only", "[device][serial]") {
  const Pty pty;
  {
    const auto port = value(PortTransport::open_serial(pty.path, {}));
    const auto second = PortTransport::open_serial(pty.path, {});
    CHECK(kind(second) == ErrorKind::Refused);
    CHECK(second.error().detail.find("another program") != std::string::npos);
  }
  CHECK(PortTransport::open_serial(pty.path, {}));
}

TEST_CASE("a port that hangs up fails reading and writing", "[device][serial]") {
  Pty pty;
  const auto port = value(PortTransport::open_serial(pty.path, {}));
  std::thread pull([&] {
    std::this_thread::sleep_for(50ms);
    pty.hang_up();
  });
  CHECK(kind(port->read(port->now() + 60s)) == ErrorKind::DeviceGone);
  pull.join();
  const auto end = port->write(bytes("PU;"), port->now() + 20s);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::DeviceGone);
  CHECK(end.taken == 0);
}

TEST_CASE("a printer port carries bytes both ways and hangs up", "[device][serial]") {
  Pty pty;
  const auto port = value(PortTransport::open_printer(pty.path));
  const std::string program(3000, 'G');
  CHECK_FALSE(port->write(bytes(program), port->now() + 20s).error);
  CHECK(pty.received(program.size()) == program);
  pty.say("1\x03");
  CHECK(text(value(port->read(port->now() + 20s))) == "1\x03");
  CHECK(kind(PortTransport::open_printer(pty.path)) == ErrorKind::Refused);
  pty.hang_up();
  CHECK(kind(port->read(port->now() + 20s)) == ErrorKind::DeviceGone);
}

TEST_CASE("a port that cannot be opened is reported with reason and remedy", "[device][serial]") {
  const TempFolder folder;
  write_file(folder / "plain", "");
  const auto absent = PortTransport::open_serial("/dev/ttyUSB99", {});
  CHECK(kind(absent) == ErrorKind::DeviceGone);
  CHECK(absent.error().detail.find("popcut devices") != std::string::npos);
  const auto plain = PortTransport::open_serial((folder / "plain").string(), {});
  CHECK(kind(plain) == ErrorKind::Refused);
  CHECK(plain.error().detail.find("not a serial port") != std::string::npos);
  const auto printer = PortTransport::open_printer((folder / "plain").string());
  CHECK(kind(printer) == ErrorKind::Refused);
  CHECK(printer.error().detail.find("not a printer port") != std::string::npos);
  const Pty pty;
  const auto odd = PortTransport::open_serial(pty.path, {250'001, FlowControl::None});
  CHECK(kind(odd) == ErrorKind::Refused);
  CHECK(odd.error().detail.find("250001 baud") != std::string::npos);
}

TEST_CASE("a file holds the complete program or does not exist", "[device][file]") {
  const TempFolder folder;
  const std::string path = (folder / "sheet.gpgl").string();
  {
    const auto file = value(FileTransport::create(path));
    CHECK_FALSE(file->write(bytes("M0,0\x03"), file->now()).error);
  }
  CHECK(files_below(folder.path()).empty());
  {
    const auto file = value(FileTransport::create(path));
    CHECK_FALSE(file->write(bytes("M0,0\x03"), file->now()).error);
    CHECK(file->in_transit() == 5);
    CHECK(kind(file->read(file->now() + 1s)) == ErrorKind::Timeout);
    CHECK(file->now() == 1s);
    CHECK(file->finish());
  }
  CHECK(text_of_file(path) == "M0,0\x03");
  CHECK(files_below(folder.path()) == std::vector<std::string>{"sheet.gpgl"});
  CHECK(kind(FileTransport::create("/dev/null")) == ErrorKind::Refused);
  CHECK(kind(FileTransport::create(folder.path().string())) == ErrorKind::Refused);
  CHECK(kind(FileTransport::create((folder / "no/sheet").string())) == ErrorKind::Unwritable);
}

TEST_CASE("a session with a file streams only the program and reports nothing as cut",
          "[device][file][session]") {
  const TempFolder folder;
  std::mt19937 random(3);
  const SimJob job(machine("cameo3"), random, 50, 300);
  const std::string name = (folder / "sheet.gpgl").string();
  const auto file = value(FileTransport::create(name));
  const SessionEnd end = run_session(*file, job.machine, job.program);
  REQUIRE_FALSE(end.error);
  CHECK(file->finish());
  CHECK(text_of_file(name) == job.program.bytes);
  CHECK_FALSE(end.confirmed);
  for (const StrokeFate fate : end.fates) CHECK(fate != StrokeFate::Certain);
}

TEST_CASE("programs that have a file open are named", "[device][doctor]") {
  const TempFolder folder;
  const std::string path = (folder / "lp0").string();
  write_file(path, "");
  CHECK(who_has_open({path}).empty());
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const int file = ::open(path.c_str(), O_RDWR);
    if (file >= 0 && ::write(ready[1], "x", 1) == 1) ::pause();
    ::_exit(0);
  }
  char sign{};
  CHECK(::read(ready[0], &sign, 1) == 1);
  const std::vector<std::string> programs = who_has_open({path});
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  REQUIRE(programs.size() == 1);
  CHECK(programs.front().find(fmt::format("({})", child)) != std::string::npos);
}

TEST_CASE("device ids are parsed or refused with the valid form", "[device][id]") {
  CHECK(value(parse_device_id("sim:cameo3")).name == "cameo3");
  CHECK(value(parse_device_id("usb:51053P")).name == "usb:51053P");
  CHECK(value(parse_device_id("file:a:b")).name == "a:b");
  CHECK(value(parse_device_id("lp:/dev/usb/lp0")).kind == DeviceKind::Printer);
  const DeviceId plain = value(parse_device_id("serial:/dev/ttyUSB0"));
  CHECK(plain.name == "/dev/ttyUSB0");
  CHECK(plain.serial.baud == 9600);
  CHECK(plain.serial.flow == FlowControl::None);
  const DeviceId set =
      value(parse_device_id("serial:/dev/serial/by-path/a,b:1,baud=38400,flow=rtscts"));
  CHECK(set.name == "/dev/serial/by-path/a,b:1");
  CHECK(set.serial.baud == 38400);
  CHECK(set.serial.flow == FlowControl::RtsCts);
  for (const char* wrong :
       {"", "cameo3", "usb:", "usb", "serial:", "bluetooth:x", "serial:/dev/ttyS0,baud=fast",
        "serial:/dev/ttyS0,baud=0", "serial:/dev/ttyS0,flow=maybe",
        "serial:/dev/ttyS0,baud=9600,parity=odd", "serial:/dev/ttyS0,baud=99999999999"}) {
    CAPTURE(wrong);
    const auto id = parse_device_id(wrong);
    REQUIRE_FALSE(id);
    CHECK(id.error().kind == ErrorKind::Usage);
    CHECK(id.error().place == "--device");
    CHECK(id.error().detail.find("; ") != std::string::npos);
  }
}

}  // namespace ports_test
