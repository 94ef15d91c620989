// SPDX-License-Identifier: MIT
#include "daemon/client/wire.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include <fmt/format.h>

namespace popcut::client {
namespace {

Error not_there(const Address& address, int code) {
  if (code == EACCES || code == EPERM)
    return {
        ErrorKind::Refused, address.text(),
        "you may not use this socket; join its group: sudo usermod -aG popcut $USER, then log in "
        "again"};
  return {ErrorKind::DeviceGone, address.text(),
          fmt::format("popcutd does not answer there ({}); start it with 'popcutd' in another "
                      "terminal, or as a service with 'sudo systemctl start popcutd.socket'; "
                      "'systemctl status popcutd' shows why it stopped",
                      std::strerror(code))};
}

int start_connecting(int fd, const sockaddr* to, socklen_t size) {
  while (::connect(fd, to, size) != 0) {
    if (errno == EINTR) continue;
    // A unix socket whose backlog is full says EAGAIN and never becomes writable.
    return errno;
  }
  return 0;
}

int error_of(int fd) {
  int code = 0;
  socklen_t size = sizeof code;
  return ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &code, &size) == 0 ? code : errno;
}

int wait_connected(int fd, double seconds) {
  pollfd one{fd, POLLOUT, 0};
  const int ready = ::poll(&one, 1, static_cast<int>(seconds * 1000));
  return ready > 0 ? error_of(fd) : ready == 0 ? ETIMEDOUT : errno;
}

/// A descriptor, or an errno below 0.
int connect_to(int family, const sockaddr* to, socklen_t size, double seconds) {
  const int fd = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -errno;
  int code = start_connecting(fd, to, size);
  if (code == EINPROGRESS) code = wait_connected(fd, seconds);
  if (code == 0) return fd;
  ::close(fd);
  return -code;
}

int connect_unix(const std::string& path, double seconds) {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  if (path.size() >= sizeof to.sun_path) return -ENAMETOOLONG;
  path.copy(to.sun_path, path.size());
  return connect_to(AF_UNIX, reinterpret_cast<const sockaddr*>(&to), sizeof to, seconds);
}

/// A descriptor, or an errno below 0.
///
/// @retval DeviceGone  nobody knows the host's name
Result<int> connect_tcp(const Address& address, double seconds) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int found =
      ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &wanted, &list);
  if (found == EAI_SYSTEM) return -errno;
  if (found != 0)
    return fail(ErrorKind::DeviceGone, address.text(),
                fmt::format("the host {} is unknown ({}); check POPCUT_URL", address.host,
                            ::gai_strerror(found)));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> kept(list, ::freeaddrinfo);
  int last = -EHOSTUNREACH;
  for (const addrinfo* one = list; one != nullptr; one = one->ai_next) {
    last = connect_to(one->ai_family, one->ai_addr, one->ai_addrlen, seconds);
    if (last < 0) continue;
    const int on = 1;
    (void)::setsockopt(last, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return last;
  }
  return last;
}

}  // namespace

Wire::~Wire() { close(); }

Wire::Wire(Wire&& other) noexcept : fd_(std::exchange(other.fd_, -1)), deadline_(other.deadline_) {}

Wire& Wire::operator=(Wire&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
    deadline_ = other.deadline_;
  }
  return *this;
}

void Wire::close() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

Result<Wire> Wire::connect(const Address& address, double seconds) {
  const auto fd = address.path.empty() ? connect_tcp(address, seconds)
                                       : Result<int>(connect_unix(address.path, seconds));
  if (!fd) return tl::unexpected(fd.error());
  if (*fd < 0) return tl::unexpected(not_there(address, -*fd));
  return Wire(*fd);
}

void Wire::deadline_in(double seconds) {
  deadline_ = Clock::now() + std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000));
}

int Wire::wait(short events) const {
  for (;;) {
    int left = -1;
    if (deadline_ != Clock::time_point::max()) {
      const auto ms =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
      left = static_cast<int>(std::clamp<std::int64_t>(ms, 0, 3'600'000));
    }
    pollfd one{fd_, events, 0};
    const int ready = ::poll(&one, 1, left);
    if (ready > 0) return 0;
    if (ready == 0) return -ETIMEDOUT;
    if (errno != EINTR) return -errno;
    return -EINTR;  // Ctrl-C is looked at by who waits
  }
}

long Wire::read(std::span<const iovec> into) {
  for (;;) {
    const ssize_t got =
        ::readv(fd_, into.data(), static_cast<int>(std::min<std::size_t>(into.size(), 16)));
    if (got >= 0) return got;
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return -errno;
    if (const int waited = wait(POLLIN); waited != 0) return waited;
  }
}

long Wire::write(std::span<const iovec> from) {
  for (;;) {
    msghdr message{};
    message.msg_iov = const_cast<iovec*>(from.data());
    message.msg_iovlen = std::min<std::size_t>(from.size(), 16);
    const ssize_t sent = ::sendmsg(fd_, &message, MSG_NOSIGNAL);
    if (sent >= 0) return sent;
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return -errno;
    if (const int waited = wait(POLLOUT); waited != 0) return waited;
  }
}

}  // namespace popcut::client
