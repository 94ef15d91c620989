// SPDX-License-Identifier: MIT
#include "daemon/popcutd/service_manager.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cctype>
#include <cstddef>
#include <cstdlib>

namespace popcut::daemon {
namespace {

std::string take(const char* name) {
  const char* const value = std::getenv(name);
  std::string text = value != nullptr ? value : "";
  ::unsetenv(name);
  return text;
}

/// A variable of this process ("..._PID" names it) as a number, else 0.
long take_own(const char* name, const char* pid_name) {
  const std::string value = take(name), pid = take(pid_name);
  if (!pid.empty() && std::strtol(pid.c_str(), nullptr, 10) != ::getpid()) return 0;
  return std::strtol(value.c_str(), nullptr, 10);
}

}  // namespace

ServiceManager ServiceManager::from_environment() {
  constexpr int kFirst = 3;  // SD_LISTEN_FDS_START
  constexpr long kMost = 64;
  ServiceManager manager;
  manager.socket_ = take("NOTIFY_SOCKET");
  if (!manager.socket_.empty() && manager.socket_.front() == '@') manager.socket_.front() = '\0';
  if (const long usec = take_own("WATCHDOG_USEC", "WATCHDOG_PID"); usec > 0)
    manager.watchdog_s_ = static_cast<double>(usec) / 1e6;
  const bool named = std::getenv("LISTEN_PID") != nullptr;
  const long count = take_own("LISTEN_FDS", "LISTEN_PID");
  take("LISTEN_FDNAMES");
  for (int fd = kFirst; named && fd < kFirst + std::min(count, kMost); ++fd) {
    int listens = 0;
    socklen_t size = sizeof listens;
    if (::getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) != 0 || listens == 0) continue;
    (void)::fcntl(fd, F_SETFD, FD_CLOEXEC);
    manager.sockets_.push_back(fd);
  }
  return manager;
}

bool ServiceManager::tell(std::string_view state) const {
  if (socket_.empty()) return true;
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  if (socket_.size() >= sizeof to.sun_path) return false;
  socket_.copy(to.sun_path, socket_.size());
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  const ssize_t sent = ::sendto(fd, state.data(), state.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                                reinterpret_cast<const sockaddr*>(&to), size);
  ::close(fd);
  return sent == static_cast<ssize_t>(state.size());
}

bool ServiceManager::tell_status(const std::string& text) const {
  std::string line = "STATUS=" + text;
  for (char& c : line)
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  return tell(line);
}

}  // namespace popcut::daemon
