// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "daemon/http/server.hpp"
#include "tests/support/fake_service.hpp"
#include "tests/support/timing.hpp"

namespace popcut::daemon {

/// A response as it came over the wire; names of headers are lower case.
struct WireResponse {
  int status{0};  ///< 0: the connection ended without one
  std::map<std::string, std::string> headers{};
  std::string body{};
  /// The last part of a problem's type, or nothing.
  [[nodiscard]] std::string problem() const;
};

/// A client that sends exactly the given bytes.
class RawConnection {
 public:
  explicit RawConnection(std::uint16_t port, bool six = false);
  explicit RawConnection(const std::string& unix_path);
  ~RawConnection();
  /// Over a unix socket, as another user of this computer; nothing unless this is root.
  [[nodiscard]] static std::optional<RawConnection> as_user(unsigned uid,
                                                            const std::string& unix_path);
  RawConnection(RawConnection&& other) noexcept;
  RawConnection& operator=(RawConnection&&) = delete;

  /// False: the other end has closed.
  bool send(std::string_view bytes);
  /// Reads one response, at most `seconds` long; `is_head`: none has a body.
  [[nodiscard]] WireResponse receive(double seconds = 60, bool is_head = false);
  /// Reads until `ending` has come; all that came.
  [[nodiscard]] std::string receive_until(std::string_view ending, double seconds = 60);
  /// True if the other end closes within the time; what comes before is thrown away.
  [[nodiscard]] bool closes(double seconds = 60);
  /// Ends the connection with a reset.
  void reset();
  /// A small buffer for what comes, set before anything does.
  void shrink_buffer(int bytes);
  [[nodiscard]] int socket() const { return socket_; }

 private:
  bool more(double seconds);
  int socket_{-1};
  std::string pending_;
};

/// One thread that runs what it is given, in order: stands for the service's.
class WorkThread {
 public:
  WorkThread();
  ~WorkThread();
  bool post(std::function<void()> work);
  /// Runs `work` there and waits.
  void run(const std::function<void()>& work);

 private:
  void loop();
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> queue_;
  bool ending_{false};
  std::thread thread_;
};

/// The server on a free port and a unix socket, with the fake service behind it.
class LiveServer {
 public:
  explicit LiveServer(const std::function<void(HttpOptions&)>& change = {});
  ~LiveServer();

  FakeService fake;  ///< of the service's thread; look at it inside `ask`
  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  [[nodiscard]] const std::string& socket_path() const { return socket_path_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] RawConnection connect() const { return RawConnection(port()); }
  [[nodiscard]] HttpServer& server() { return *server_; }
  void ask(const std::function<void(FakeService&)>& what);
  /// Number of uploads that lie about.
  [[nodiscard]] std::size_t spools() const;

  /// "GET /path HTTP/1.1" with Host, a token of `role` (none if empty) and more header lines, each
  /// ending with CRLF; with Content-Length if there is a body.
  [[nodiscard]] std::string request(std::string_view method, std::string_view target,
                                    std::string_view role = "admin", std::string_view more = "",
                                    std::string_view body = "") const;
  /// Sends a request on a connection of its own.
  [[nodiscard]] WireResponse fetch(std::string_view method, std::string_view target,
                                   std::string_view role = "admin", std::string_view more = "",
                                   std::string_view body = "") const;

 private:
  std::filesystem::path folder_;
  std::string socket_path_;
  WorkThread thread_;
  std::unique_ptr<HttpServer> server_;
};

/// Header lines of a request that acts: JSON, a key of its own, If-Match.
[[nodiscard]] std::string acting(std::string_view if_match = "");

using testing::comes_true;

}  // namespace popcut::daemon
