// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace popcut::testing {

/// Where an HTTP server is.
struct Endpoint {
  std::uint16_t port{};       ///< of 127.0.0.1
  std::string unix_socket{};  ///< instead, if it is not empty
};

/// One connection that is kept, and does as little as it can: what it costs is not to be measured.
class KeptConnection {
 public:
  /// Throws if nobody listens there.
  explicit KeptConnection(const Endpoint& endpoint);
  ~KeptConnection();
  KeptConnection(KeptConnection&& other) noexcept;
  KeptConnection& operator=(KeptConnection&&) = delete;

  struct Answer {
    int status{};             ///< 0: the connection broke
    std::string_view body{};  ///< until the next request
  };
  Answer ask(std::string_view request);

 private:
  bool more();
  int socket_{-1};
  std::string text_;
};

/// What a load came to.
struct LoadFigures {
  int clients{};
  std::size_t requests{}, failures{};
  double seconds{};
  std::vector<double> milliseconds{};  ///< of each, sorted

  [[nodiscard]] double per_second() const { return static_cast<double>(requests) / seconds; }
  /// The time within which the share `part` of them was answered.
  [[nodiscard]] double within(double part) const;
};

/// `clients` connections, a thread each, ask one request after another for `seconds`. `request`
/// makes the `k`th one of a client; an answer of another status than `status` is a failure.
[[nodiscard]] LoadFigures load(const Endpoint& endpoint, int clients, double seconds, int status,
                               const std::function<std::string(int client, int k)>& request);

/// The least that a server does: a process with a thread a connection, each reading a request with
/// Boost.Beast and answering it with the same `bytes` of JSON.
class BareServer {
 public:
  explicit BareServer(std::size_t bytes);
  ~BareServer();
  BareServer(const BareServer&) = delete;
  BareServer& operator=(const BareServer&) = delete;
  [[nodiscard]] Endpoint endpoint() const { return {port_, {}}; }

 private:
  pid_t process_{-1};
  std::uint16_t port_{};
};

/// Milliseconds of each of `count` commits, sorted: one row of `bytes` and its place in an index,
/// in write-ahead mode, synced. What SQLite alone takes on this disk.
[[nodiscard]] std::vector<double> bare_commits(const std::string& file, int count,
                                               std::size_t bytes);

}  // namespace popcut::testing
