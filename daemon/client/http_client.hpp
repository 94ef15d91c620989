// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "daemon/client/address.hpp"
#include "daemon/client/sse_reader.hpp"

namespace popcut::client {

/// A request to popcutd.
struct HttpRequest {
  std::string method{"GET"};
  std::string target;
  std::string_view body{};  ///< must live until the answer has come
  std::string content_type{};
  std::vector<std::pair<std::string, std::string>> headers{};
  double seconds{60};  ///< in which the answer must begin; then it must not be slower than 1 KiB/s
  /// If not 0: the most bytes that are read of the answer, its head and all codings included; then
  /// `seconds` is for the whole of it, however quickly it comes.
  std::uint64_t most_bytes{0};
};

struct HttpResponse {
  int status{};
  std::string content_type, etag, location, body;
  std::optional<double> retry_after_s{};
};

/// Speaks HTTP with one popcutd, one request at a time. It repeats a request whose connection
/// broke: every POST has an idempotency key, the same on each try.
class HttpClient {
 public:
  HttpClient(std::vector<Address> addresses, std::string token);
  ~HttpClient();
  HttpClient(HttpClient&&) noexcept;
  HttpClient& operator=(HttpClient&&) noexcept;

  /// @retval DeviceGone  no address answers, or popcutd went away
  /// @retval Refused     the answer is not HTTP, or access to the socket is denied
  [[nodiscard]] Result<HttpResponse> ask(HttpRequest request);
  /// The address that answered last, else the first.
  [[nodiscard]] const Address& address() const;
  [[nodiscard]] const std::vector<Address>& addresses() const { return addresses_; }
  [[nodiscard]] const std::string& token() const { return token_; }
  /// How often a broken request is repeated, at growing intervals (200 ms, 400 ms, ...).
  void set_tries(int tries) { tries_ = tries; }

 private:
  friend class EventStream;
  struct Connection;
  [[nodiscard]] Result<void> connect();
  [[nodiscard]] Result<HttpResponse> ask_once(const HttpRequest& request);
  std::vector<Address> addresses_;
  std::string token_;
  std::size_t used_{0};
  int tries_{4};
  bool reached_{false};  ///< until then, no answer is an error at once
  std::unique_ptr<Connection> connection_;
};

/// The events of popcutd as they happen, over a separate connection, which is opened again if it
/// breaks. No stored event is lost or delivered twice.
class EventStream {
 public:
  /// @param target  "/v1/events"
  EventStream(const HttpClient& like, std::string target);
  ~EventStream();
  EventStream(const EventStream&) = delete;
  EventStream& operator=(const EventStream&) = delete;

  /// The events of the next `seconds`, returned as soon as there is one. Empty: the time is over,
  /// or the stream broke and the next call opens it again (see `connected`).
  ///
  /// @retval Refused  popcutd answers with a problem (`problem`)
  [[nodiscard]] Result<std::vector<SseEvent>> next(double seconds);
  [[nodiscard]] bool connected() const;
  [[nodiscard]] const std::optional<HttpResponse>& problem() const { return problem_; }

 private:
  struct Stream;
  [[nodiscard]] Result<void> open(double seconds);
  std::vector<Address> addresses_;
  std::string token_, target_;
  SseReader reader_;
  std::optional<HttpResponse> problem_;
  std::unique_ptr<Stream> stream_;
};

/// 32 random characters, for an Idempotency-Key.
[[nodiscard]] std::string random_key();

}  // namespace popcut::client
