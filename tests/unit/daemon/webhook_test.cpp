// SPDX-License-Identifier: MIT
// A webhook whose other end means no good: nothing of it is taken but a little, for a little while.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/popcutd/webhook.hpp"
#include "tests/support/process.hpp"
#include "tests/support/timing.hpp"

namespace webhook_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::comes_true;

namespace {

/// Answers each request with `head`, then with `piece` again and again until nobody listens.
class BadServer {
 public:
  BadServer(std::string head, std::string piece, std::chrono::milliseconds pause)
      : head_(std::move(head)), piece_(std::move(piece)), pause_(pause) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    REQUIRE(::bind(listener_, reinterpret_cast<const sockaddr*>(&at), size) == 0);
    REQUIRE(::listen(listener_, 8) == 0);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size);
    port = ntohs(at.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~BadServer() {
    stop_ = true;
    thread_.join();
    ::close(listener_);
  }
  BadServer(const BadServer&) = delete;
  BadServer& operator=(const BadServer&) = delete;

  std::uint16_t port{};
  std::atomic<int> ended{0};                ///< answers that the other end broke off
  std::atomic<std::uint64_t> most_sent{0};  ///< bytes of the longest of them

 private:
  void serve() {
    while (!stop_) {
      pollfd one{listener_, POLLIN, 0};
      if (::poll(&one, 1, 10) <= 0) continue;
      const int client = ::accept(listener_, nullptr, nullptr);
      const int small = 16 << 10;  // so that what was sent is what was read, nearly
      ::setsockopt(client, SOL_SOCKET, SO_SNDBUF, &small, sizeof small);
      char room[4096];
      (void)!::recv(client, room, sizeof room, 0);
      answer(client);
      ::close(client);
    }
  }
  void answer(int client) {
    std::uint64_t sent = 0;
    std::string next = head_;
    while (!stop_) {
      char end = 0;
      if (::recv(client, &end, 1, MSG_DONTWAIT | MSG_PEEK) == 0) break;
      pollfd one{client, POLLOUT, 0};
      if (::poll(&one, 1, 10) > 0) {
        const ssize_t now = ::send(client, next.data(), next.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        if (now < 0 && errno != EAGAIN) break;
        if (now > 0) sent += static_cast<std::uint64_t>(now);
        next = piece_;
      }
      if (pause_.count() > 0) std::this_thread::sleep_for(pause_);
    }
    if (stop_) return;
    most_sent = std::max<std::uint64_t>(most_sent, sent);
    ++ended;
  }
  std::string head_, piece_;
  std::chrono::milliseconds pause_;
  int listener_{-1};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

struct Case {
  const char* name;
  std::string head, piece;
  std::chrono::milliseconds pause;
};

}  // namespace

TEST_CASE("a webhook begins as soon as the newest event is known", "[daemon][webhook]") {
  const testing::TempFolder folder;
  std::atomic<int> asked{0};
  std::atomic<std::int64_t> first{-1};
  const Webhook webhook({"127.0.0.1:9", "/", "0123456789abcdef"}, (folder / "webhook").string(),
                        {.events =
                             [&](std::int64_t after, int) {
                               first = after;
                               return std::vector<Event>();
                             },
                         .last_event = [&]() -> std::optional<std::int64_t> {
                           // The database of a fleet may be away for a while.
                           if (++asked < 3) return std::nullopt;
                           return 7;
                         },
                         .log = [](const std::string&) {}},
                        {.pause = std::chrono::milliseconds(1)});
  CHECK(comes_true([&] { return first >= 0; }));
  CHECK(first == 7);
  CHECK(asked == 3);
}

TEST_CASE("whatever a webhook answers popcutd reads 64 KiB of it and for a limited time",
          "[daemon][webhook]") {
  using namespace std::chrono_literals;
  const std::string much(64 << 10, 'x');
  const std::vector<Case> cases{
      {"an endless body", "HTTP/1.1 200 OK\r\n\r\n", much, 0ms},
      {"a body that is announced as huge", "HTTP/1.1 200 OK\r\nContent-Length: 2147483648\r\n\r\n",
       much, 0ms},
      {"chunks without end", "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n",
       "1000\r\n" + std::string(0x1000, 'x') + "\r\n", 0ms},
      {"chunks of one byte with long extensions",
       "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n",
       "1;a=" + std::string(4000, 'b') + "\r\nx\r\n", 0ms},
      {"headers without end", "HTTP/1.1 200 OK\r\n", "X-A: " + std::string(1000, 'y') + "\r\n",
       0ms},
      {"one header without end", "HTTP/1.1 200 OK\r\nX-A: ", much, 0ms},
      {"a byte now and then", "HTTP/1.1 200 OK\r\nContent-Length: 60000\r\n\r\n", "x", 20ms},
      {"a header now and then", "HTTP/1.1 200 OK\r\n", "X: y\r\n", 20ms},
      {"nothing", "", "", 20ms},
  };
  for (const Case& one : cases) {
    INFO(one.name);
    BadServer server(one.head, one.piece, one.pause);
    const testing::TempFolder folder;
    std::mutex mutex;
    std::vector<std::string> log;
    {
      Webhook webhook(
          {fmt::format("127.0.0.1:{}", server.port), "/", "0123456789abcdef"},
          (folder / "webhook").string(),
          {.events =
               [](std::int64_t after, int) {
                 return after < 1 ? std::vector<Event>{Event{1, "notice", 0, "", "{\"seq\":1}"}}
                                  : std::vector<Event>{};
               },
           .last_event = [] { return std::int64_t{0}; },
           .log =
               [&](const std::string& line) {
                 const std::lock_guard lock(mutex);
                 log.push_back(line);
               }},
          {.answer_s = 0.15, .answer_bytes = 64u << 10, .pause = std::chrono::milliseconds(5)});
      CHECK(comes_true([&] { return server.ended >= 1; }));
      CHECK(comes_true(
          [&] {
            const std::lock_guard lock(mutex);
            return !log.empty();
          },
          20));
    }
    // What lies in the buffers of both sockets is sent, too, and read by nobody.
    CHECK(server.most_sent < 4u << 20);
    const std::lock_guard lock(mutex);
    REQUIRE_FALSE(log.empty());
    CHECK(log.front().find("was not accepted") != std::string::npos);
  }
}

}  // namespace webhook_test
