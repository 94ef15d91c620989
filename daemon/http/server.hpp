// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/http/front_door.hpp"
#include "daemon/model/limits.hpp"
#include "daemon/service/service.hpp"

namespace spdlog {
class logger;
}

namespace popcut::daemon {

struct HttpEndpoint {
  std::string address;   ///< "127.0.0.1:8631", "[::1]:8631", "unix:/path"; port 0: any free one
  bool optional{false};  ///< continue without it if the system has no such address (no IPv6)
};

struct HttpOptions {
  std::vector<HttpEndpoint> listen{};
  std::vector<int> inherited{};  ///< sockets that listen already (systemd); the server owns them
  bool allow_remote{false};      ///< also endpoints that are not loopback, behind a proxy with TLS
  std::vector<std::string> hosts{};    ///< more names of this daemon: "cutter.lab:8631"
  std::vector<std::string> origins{};  ///< more origins of its page: "https://cutter.lab"
  LocalUsers users{};
  std::string machine{};  ///< of a fleet: suffix of local users, "@room-1"
  HttpLimits limits{};
  std::string incoming_folder{};  ///< in the state folder: uploads until the service takes them
  std::string build{"0"};         ///< version, for /v1/meta
  /// What isolates workers on this machine, for /v1/meta; null or empty: not known yet.
  std::function<std::vector<WorkerWall>()> worker_walls{};
  /// Lives longer than the server; called on its own thread only.
  Service* service{nullptr};
  /// Posts work to the service's thread (lane Asking); false: it accepts no more.
  std::function<bool(std::function<void()>)> on_service{};
  /// The same, ahead of all others, for requests that stop a knife; empty: `on_service`.
  std::function<bool(std::function<void()>)> on_service_urgent{};
  /// Called when a request that stops a knife is posted, so that nothing slow delays it.
  std::function<void()> on_knife{};
  std::shared_ptr<spdlog::logger> log{};  ///< null: no log
};

/// The options that can change while the server runs.
struct HttpTuning {
  std::vector<std::string> hosts{}, origins{};
  LocalUsers users{};
  HttpLimits limits{};
};

/// The HTTP side of popcutd: one thread for all sockets. It never blocks on the service; a slow,
/// silent or hostile client costs its place among the connections and nothing else.
class HttpServer {
 public:
  explicit HttpServer(HttpOptions options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Listens and starts to serve. From here on, the whole process ignores SIGPIPE. Removes the
  /// uploads that an earlier run left.
  /// @retval Usage, Refused  an endpoint that is not optional is not available
  [[nodiscard]] Result<void> start();
  /// The port of the first TCP endpoint; 0 without TCP.
  [[nodiscard]] std::uint16_t port() const;
  /// Where it listens: "127.0.0.1:8631", "unix:/run/popcut.sock".
  [[nodiscard]] std::vector<std::string> endpoints() const;
  /// Uses other names, users and limits for all later requests, also on open connections.
  /// Streams of users without a role end.
  void retune(HttpTuning tuning);
  /// Accepts no more connections, lets requests end for `grace_s`, then closes them. The service's
  /// thread must still run. Idempotent.
  void stop(double grace_s = 2);
  /// True if the thread was alive within the last seconds (for the watchdog).
  [[nodiscard]] bool alive(double within_s = 5) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace popcut::daemon
