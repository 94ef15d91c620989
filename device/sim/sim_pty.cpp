// SPDX-License-Identifier: MIT
#include "device/sim/sim_pty.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace popcut {
namespace {

using Clock = std::chrono::steady_clock;

Error no_terminal(const char* what) {
  return {ErrorKind::Unwritable, "",
          fmt::format("no pseudo terminal: {} ({}); check that /dev/pts is mounted", what,
                      std::strerror(errno))};
}

}  // namespace

Result<SimPty> SimPty::open(SimTransport cable, double speedup) {
  if (!(speedup > 0 && speedup <= 1e6))
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("a speed-up of {}; it must be above 0 and at most 1000000", speedup));
  SimPty pty(std::move(cable), speedup);
  pty.main_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (pty.main_ < 0) return tl::unexpected(no_terminal("none can be opened"));
  std::array<char, 128> name{};
  if (::grantpt(pty.main_) != 0 || ::unlockpt(pty.main_) != 0 ||
      ::ptsname_r(pty.main_, name.data(), name.size()) != 0)
    return tl::unexpected(no_terminal("it cannot be unlocked"));
  pty.path_ = name.data();
  pty.held_ = ::open(pty.path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios raw{};
  if (pty.held_ < 0 || ::tcgetattr(pty.held_, &raw) != 0)
    return tl::unexpected(no_terminal("its other end cannot be opened"));
  ::cfmakeraw(&raw);
  ::tcsetattr(pty.held_, TCSANOW, &raw);
  return pty;
}

SimPty::SimPty(SimPty&& other) noexcept
    : cable_(std::move(other.cable_)),
      speedup_(other.speedup_),
      main_(std::exchange(other.main_, -1)),
      held_(std::exchange(other.held_, -1)),
      path_(std::move(other.path_)),
      waiting_(std::move(other.waiting_)),
      answers_(std::move(other.answers_)),
      begun_(other.begun_) {}

SimPty::~SimPty() { close(); }

void SimPty::close() {
  for (int* end : {&held_, &main_})
    if (*end >= 0) ::close(std::exchange(*end, -1));
}

/// One turn: the cutter's clock follows ours, bytes in, replies out.
bool SimPty::step() {
  const std::chrono::duration<double, std::nano> due = (Clock::now() - begun_) * speedup_;
  cable_.wait(std::chrono::nanoseconds(static_cast<std::int64_t>(due.count())) - cable_.now());
  if (waiting_.empty()) {  // else the cutter's buffer is full, and the terminal's fills up
    std::array<std::byte, 512> room{};
    const ssize_t got = ::read(main_, room.data(), room.size());
    if (got > 0) waiting_.assign(room.begin(), room.begin() + got);
  }
  if (!waiting_.empty()) {
    const Transport::WriteEnd end = cable_.write(waiting_, cable_.now());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(end.taken));
    if (end.error && end.error->kind == ErrorKind::DeviceGone) return false;
  }
  const auto replies = cable_.read(cable_.now());
  if (!replies && replies.error().kind == ErrorKind::DeviceGone) return false;
  if (replies) answers_.insert(answers_.end(), replies->begin(), replies->end());
  if (!answers_.empty()) {
    const ssize_t sent = ::write(main_, answers_.data(), answers_.size());
    if (sent > 0) answers_.erase(answers_.begin(), answers_.begin() + sent);
    constexpr std::size_t kMostUnread = 65536;  // nobody reads; a real cutter drops replies too
    if (answers_.size() > kMostUnread) answers_.clear();
  }
  return true;
}

bool SimPty::serve(std::chrono::milliseconds duration) {
  const Clock::time_point until = Clock::now() + duration;
  do {
    if (main_ < 0) return false;
    if (!step()) {
      close();
      return false;
    }
    // Replies arrive within a millisecond, and a full buffer drains at that pace.
    pollfd wake{main_, static_cast<short>(waiting_.empty() ? POLLIN : 0), 0};
    ::poll(&wake, 1, waiting_.empty() && !cable_.cutter().next_reply() ? 5 : 1);
  } while (Clock::now() < until);
  return true;
}

}  // namespace popcut
