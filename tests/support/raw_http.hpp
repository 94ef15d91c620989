// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/http/server.hpp"
#include "tests/support/fake_previewer.hpp"
#include "tests/support/service_bench.hpp"
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
  /// Reads one response, for at most `seconds`, which only what hangs misses; `is_head`: none has a
  /// body.
  [[nodiscard]] WireResponse receive(double seconds = 300, bool is_head = false);
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

/// The cutters of a service, which cannot be read if a test says so.
class FaultyDevices final : public Devices {
 public:
  explicit FaultyDevices(Devices& real) : real_(real) {}
  std::function<void()> fault{};  ///< of the service's thread; throws
  std::vector<DeviceRecord> list() override {
    if (fault) fault();
    return real_.list();
  }
  Answer<DeviceRecord> find(const std::string& id) override {
    if (fault) fault();
    return real_.find(id);
  }
  Answer<DeviceRecord> act(const Principal& who, const std::string& id, std::int64_t if_match,
                           const DeviceRequest& request) override {
    return real_.act(who, id, if_match, request);
  }

 private:
  Devices& real_;
};

/// A service with these cutters instead of its own.
[[nodiscard]] Service with_devices(const Service& service, Devices& devices);

/// The service of a bench with what HTTP needs besides: previews, and a token for each role, whose
/// name is that of the role.
class ServiceForHttp {
 public:
  ServiceForHttp();

  testing::ServiceBench bench{false};
  std::shared_ptr<testing::FakePreviewer> previewer{std::make_shared<testing::FakePreviewer>()};
  std::atomic<bool> has_clock{true};  ///< if not, the service fails wherever it needs the time
  [[nodiscard]] FaultyDevices& devices() { return *devices_; }
  [[nodiscard]] Service& service() { return *service_; }
  /// `work(service)` on the service's thread.
  void ask(const std::function<void(LiveService&)>& work) { bench.on(work); }
  [[nodiscard]] const std::string& token(const std::string& role) const { return tokens_.at(role); }
  [[nodiscard]] std::string token_id(const std::string& role) const {
    return token(role).substr(3, 26);
  }
  /// Gives the role another token.
  void renew_token(Role role);
  /// The id of a stored design, of which the planner makes two sheets.
  [[nodiscard]] std::string design() { return bench.add_design(R"({"card":1})").value().id; }
  /// Who sends the token of that role.
  [[nodiscard]] Principal principal(Role role) const;
  /// Stores texts of a job that no client could send.
  void put_texts(const std::string& job, const std::string& name, const std::string& note);
  /// Changes `job` so many times in one commit: each change is an event of the kind "job".
  void tell(const std::string& job, int times);
  [[nodiscard]] std::int64_t jobs();        ///< how many there are
  [[nodiscard]] std::int64_t last_event();  ///< its number

 private:
  std::map<std::string, std::string> tokens_;
  std::optional<FaultyDevices> devices_;
  std::optional<Service> service_;
};

/// The server on a free port and a unix socket.
class LiveServer : public ServiceForHttp {
 public:
  explicit LiveServer(const std::function<void(HttpOptions&)>& change = {});
  ~LiveServer();

  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  [[nodiscard]] const std::string& socket_path() const { return socket_path_; }
  [[nodiscard]] RawConnection connect() const { return RawConnection(port()); }
  [[nodiscard]] HttpServer& server() { return *server_; }
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
  std::string incoming_, socket_path_;
  std::unique_ptr<HttpServer> server_;
};

/// Header lines of a request that acts: JSON, a key of its own, If-Match.
[[nodiscard]] std::string acting(std::string_view if_match = "");

using testing::comes_true;

}  // namespace popcut::daemon
