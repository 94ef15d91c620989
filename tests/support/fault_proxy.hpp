// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace popcut::testing {

/// A network that does what a test tells it to: it listens on 127.0.0.1 and on a unix socket, and
/// passes what a client sends to a server and back, on a thread of its own. A fault is in force for
/// all connections, old and new, when the function that sets it returns.
class FaultProxy {
 public:
  enum class Way { ToServer, ToClient };

  /// @param server  "/path/of/a/socket", or "127.0.0.1:5432"
  explicit FaultProxy(const std::string& server);
  ~FaultProxy();
  FaultProxy(const FaultProxy&) = delete;
  FaultProxy& operator=(const FaultProxy&) = delete;

  /// Of a PostgreSQL behind it, through the unix socket.
  [[nodiscard]] std::string url(const std::string& database = "postgres",
                                const std::string& user = "postgres") const;
  /// Of a PostgreSQL behind it, through 127.0.0.1; the password where the server asks for one.
  [[nodiscard]] std::string tcp_url(const std::string& database = "postgres",
                                    const std::string& user = "postgres",
                                    const std::string& password = "") const;
  [[nodiscard]] std::string socket() const;
  [[nodiscard]] std::uint16_t port() const;

  /// From now on bytes arrive that much later, also the end of a connection.
  void delay(Way way, std::chrono::milliseconds by);
  /// A black hole: it accepts bytes and ends of connections, and passes nothing on. Neither side
  /// notices.
  void hold(Way way);
  /// Passes what was held, and all that comes.
  void pass(Way way);
  /// Both ways.
  void hold();
  void pass();
  /// Ends all connections, on both sides, as a reset. What is on its way is lost.
  void cut_all();
  /// New connections are refused as if no server listened; those that are there go on.
  void refuse(bool yes);
  /// Passes `bytes` more in this direction, of all connections together. The connection that sends
  /// one more is cut; after that all is passed again.
  void cut_after(Way way, std::size_t bytes);
  enum class Lost { Request, Answer };
  /// Cuts the next connection whose client sends `text`: before the server has any of the bytes
  /// that came with its end (Request), or when the server has answered, of which the client gets
  /// nothing (Answer). After that all is passed again.
  /// @param after  what the same client must have sent before `text`, from now on
  void cut_at(const std::string& text, Lost lost, const std::string& after = "");
  /// True as long as a cut_after or cut_at has not happened.
  [[nodiscard]] bool cut_to_come() const;

  /// From now on keeps what clients of new connections send, or no longer.
  void record(bool yes);
  /// How many connections were recorded.
  [[nodiscard]] std::size_t recordings() const;
  /// What the client of the `which`-th recorded connection has sent so far, at most a MiB.
  [[nodiscard]] std::string recorded(std::size_t which) const;
  /// Sends the same bytes to the server in a connection of their own, and returns what it answers
  /// until it ends the connection; throws if that takes longer than `patience`.
  [[nodiscard]] std::string replay(const std::string& bytes, std::chrono::milliseconds patience =
                                                                 std::chrono::seconds(30)) const;

  [[nodiscard]] std::size_t connections() const;    ///< that are open now
  [[nodiscard]] std::size_t accepted() const;       ///< so far
  [[nodiscard]] std::size_t passed(Way way) const;  ///< bytes so far
  /// How often a client sent something after it got something, so far: ways to the server and back.
  [[nodiscard]] std::size_t turns() const;

 private:
  class Network;
  std::unique_ptr<Network> network_;
};

}  // namespace popcut::testing
