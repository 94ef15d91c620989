// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <array>

#include <catch2/catch.hpp>

#include "device/sim/sim_pty.hpp"
#include "tests/support/sim_bench.hpp"

namespace sim_pty_test {

using namespace popcut;
using namespace popcut::testing;
using std::chrono::milliseconds;

namespace {

/// What another program would do at its end of the terminal.
class Guest {
 public:
  explicit Guest(const std::string& path) : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY)) {
    REQUIRE(fd_ >= 0);
    ::fcntl(fd_, F_SETFL, O_NONBLOCK);
  }
  ~Guest() { ::close(fd_); }
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;

  std::size_t send(std::string_view text) {
    const ssize_t sent = ::write(fd_, text.data(), text.size());
    return sent > 0 ? static_cast<std::size_t>(sent) : 0;
  }
  std::string answers() {
    std::array<char, 256> room{};
    const ssize_t got = ::read(fd_, room.data(), room.size());
    return got > 0 ? std::string(room.data(), static_cast<std::size_t>(got)) : std::string();
  }

 private:
  int fd_;
};

}  // namespace

TEST_CASE("another program can use the cutter at the pseudo terminal", "[device][pty]") {
  const Machine cameo = machine("cameo3");
  auto pty = SimPty::open(SimTransport(cutter(cameo)), 1000);
  if (!pty) {
    WARN("skipped: " << message(pty.error()));
    return;
  }
  Guest guest(pty->path());
  const auto ask = [&](std::string_view query) {
    guest.send(query);
    std::string reply;
    for (int k = 0; k < 10'000 && reply.find('\x03') == std::string::npos; ++k) {
      CHECK(pty->serve(milliseconds(2)));
      reply += guest.answers();
    }
    return reply;
  };
  CHECK(ask("\x1b\x05") == "0\x03");
  CHECK(ask("FG\x03") == "CAMEO 3 V1.60    \x03");
  guest.send(
      "M100,100\x03"
      "D200,200\x03"
      "M0,0\x03");
  // The kernel brings it over in its own time.
  const auto cut_mm = [&] { return pty->cable().cutter().trace().cut_mm; };
  for (int k = 0; k < 2'000 && cut_mm() < 7; ++k) CHECK(pty->serve(milliseconds(5)));
  CHECK(pty->cable().cutter().trace().strokes.size() == 1);
  CHECK(pty->cable().cutter().trace().cut_mm == Approx(7.0710678));
}

TEST_CASE("a full buffer blocks the other program at the terminal", "[device][pty]") {
  Machine small = machine("cameo3");
  small.buffer_bytes = 100;
  auto pty = SimPty::open(SimTransport(cutter(small)), 0.001);  // it draws nothing meanwhile
  if (!pty) {
    WARN("skipped: " << message(pty.error()));
    return;
  }
  Guest guest(pty->path());
  const std::string draws =
      "M0,0\x03"
      "D6000,6000\x03"
      "D0,0\x03"
      "D6000,6000\x03"
      "D0,0\x03";
  // The terminal itself holds tens of kilobytes; then it takes no byte any more.
  int refused = 0;  // in a row
  for (int k = 0; k < 100'000 && refused < 1000; ++k) {
    refused = guest.send(draws) == 0 ? refused + 1 : 0;
    CHECK(pty->serve(milliseconds(0)));
  }
  CHECK(refused == 1000);
  CHECK(pty->cable().cutter().accepted_bytes() < 400);
}

TEST_CASE("a cut cable hangs the terminal up", "[device][pty]") {
  auto pty = SimPty::open(
      SimTransport(cutter(machine("cameo3")), {{.at_byte = 10, .kind = SimFault::Kind::Unplug}}));
  if (!pty) {
    WARN("skipped: " << message(pty.error()));
    return;
  }
  Guest guest(pty->path());
  guest.send(
      "M100,100\x03"
      "D200,200\x03");
  bool serves = true;
  for (int k = 0; k < 2'000 && serves; ++k) serves = pty->serve(milliseconds(5));
  CHECK_FALSE(serves);
  CHECK_FALSE(pty->serve(milliseconds(0)));
  CHECK_FALSE(SimPty::open(SimTransport(cutter(machine("cameo3"))), 0));
}

}  // namespace sim_pty_test
