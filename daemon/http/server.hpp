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
  bool optional{false};  ///< where the system has no such address (no IPv6), go on without
};

struct HttpOptions {
  std::vector<HttpEndpoint> listen{};
  std::vector<int> inherited{};  ///< sockets that listen already (systemd); the server owns them
  bool allow_remote{false};      ///< endpoints other than loopback ones; a proxy with TLS is before
  std::vector<std::string> hosts{};    ///< more names of this daemon: "cutter.lab:8631"
  std::vector<std::string> origins{};  ///< more origins of its page: "https://cutter.lab"
  LocalUsers users{};
  std::string machine{};  ///< of a fleet: what follows the number of a local user, "@room-1"
  HttpLimits limits{};
  std::string incoming_folder{};  ///< of the state: uploads lie there until the service takes them
  std::string build{"0"};         ///< version, for /v1/meta
  /// What confines workers on this machine, for /v1/meta; null, or of none: it is not known yet.
  std::function<std::vector<WorkerWall>()> worker_walls{};
  /// Lives longer than the server; called on its own thread only.
  Service* service{nullptr};
  /// Puts work on the service's thread (lane Asking); false: it accepts no more.
  std::function<bool(std::function<void()>)> on_service{};
  /// The same for requests that stop a knife, before all others; empty: as `on_service`.
  std::function<bool(std::function<void()>)> on_service_urgent{};
  /// Called when a request that stops a knife goes there, so that nothing slow keeps it waiting.
  std::function<void()> on_knife{};
  std::shared_ptr<spdlog::logger> log{};  ///< null: no log
};

/// The options that may change while it serves.
struct HttpTuning {
  std::vector<std::string> hosts{}, origins{};
  LocalUsers users{};
  HttpLimits limits{};
};

/// The HTTP side of popcutd: one thread, all sockets. It asks the service and never waits for it;
/// a client that is slow, silent or hostile costs a place among the connections and nothing else.
class HttpServer {
 public:
  explicit HttpServer(HttpOptions options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Listens and begins to serve. SIGPIPE is ignored from here on, in the whole process. What an
  /// earlier run left among the uploads is removed.
  /// @retval Usage, Refused  an endpoint that is not optional cannot be listened on
  [[nodiscard]] Result<void> start();
  /// The port of the first TCP endpoint; 0 if there is none.
  [[nodiscard]] std::uint16_t port() const;
  /// Where it listens: "127.0.0.1:8631", "unix:/run/popcut.sock".
  [[nodiscard]] std::vector<std::string> endpoints() const;
  /// Uses other names, users and limits for all later requests, also on open connections.
  /// Streams of users without a role end.
  void retune(HttpTuning tuning);
  /// Accepts no more, lets requests end for `grace_s`, then cuts them off. The service's thread
  /// must still run. Idempotent.
  void stop(double grace_s = 2);
  /// True as long as the thread has turned within the last seconds (for the watchdog).
  [[nodiscard]] bool alive(double within_s = 5) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace popcut::daemon
