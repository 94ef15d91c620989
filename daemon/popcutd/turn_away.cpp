// SPDX-License-Identifier: MIT
#include "daemon/popcutd/turn_away.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>

#include <fmt/format.h>

#include "daemon/http/api/message.hpp"

namespace popcut::daemon {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostCallers = 256;
constexpr std::chrono::milliseconds kTime{1000}, kQuiet{100};

struct Caller {
  int socket{-1};
  bool local{false};
};

std::vector<Caller> callers_at(const std::vector<int>& sockets) {
  std::vector<Caller> callers;
  for (const int socket : sockets) {
    sockaddr_storage own{};
    socklen_t size = sizeof own;
    if (::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size) != 0) continue;
    const int flags = ::fcntl(socket, F_GETFL);
    if (flags < 0 || ::fcntl(socket, F_SETFL, flags | O_NONBLOCK) != 0) continue;
    while (callers.size() < kMostCallers) {
      const int caller = ::accept4(socket, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (caller < 0) break;
      callers.push_back({caller, own.ss_family == AF_UNIX});
    }
  }
  return callers;
}

/// Unread bytes would take the answer with them when the socket is closed: reads what comes until
/// all callers are quiet.
void read_all(const std::vector<Caller>& callers, Clock::time_point until) {
  std::vector<pollfd> waits;
  waits.reserve(callers.size());
  for (const Caller& caller : callers) waits.push_back({caller.socket, POLLIN, 0});
  std::array<char, 16384> room{};
  while (Clock::now() < until && ::poll(waits.data(), waits.size(), kQuiet.count()) > 0)
    for (pollfd& one : waits)
      if (one.revents != 0 && ::recv(one.fd, room.data(), room.size(), 0) <= 0) one.fd = -1;
}

std::string answer(const std::string& detail) {
  const http::Response response =
      http::problem_response({ProblemKind::Unavailable, detail}, "/", "");
  return fmt::format(
      "HTTP/1.1 503 Service Unavailable\r\nContent-Type: {}\r\nCache-Control: no-store\r\n"
      "Connection: close\r\nContent-Length: {}\r\n\r\n{}",
      response.content_type, response.body.size(), response.body);
}

}  // namespace

void turn_away(const std::vector<int>& sockets, const std::string& reason) {
  const auto until = Clock::now() + kTime;
  const std::string local = answer("popcutd cannot start: " + reason),
                    remote = answer("popcutd cannot start; see its log");
  // Who comes while others are answered is answered too.
  for (auto callers = callers_at(sockets); !callers.empty(); callers = callers_at(sockets)) {
    read_all(callers, until);
    for (const Caller& caller : callers) {
      const std::string& text = caller.local ? local : remote;
      (void)(::send(caller.socket, text.data(), text.size(), MSG_NOSIGNAL) < 0);
      ::shutdown(caller.socket, SHUT_WR);
      ::close(caller.socket);
    }
    if (Clock::now() >= until) return;
  }
}

}  // namespace popcut::daemon
