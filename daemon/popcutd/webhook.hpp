// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "daemon/config/config.hpp"
#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// A webhook's URL, taken apart and allowed.
struct WebhookTarget {
  std::string host_port;  ///< "localhost:9000"
  std::string path;       ///< "/popcut"
  std::string secret;
};

/// Reads the secret, and holds the URL against the list of hosts that may be called.
///
/// @retval OutOfRange  the URL is none, its host is not allowed, or the secret is too short
/// @retval Malformed   the secret's file cannot be read
[[nodiscard]] Result<WebhookTarget> webhook_target(const WebhookConfig& config);

/// "sha256=" and the HMAC-SHA256 of `timestamp.body` in hexadecimal digits.
[[nodiscard]] std::string webhook_signature(std::string_view secret, std::string_view timestamp,
                                            std::string_view body);

/// Sends each stored event to another program, in order and at least once: an event is sent until
/// it was answered with 2xx, and which was the last is kept in the state folder. Its own thread;
/// nothing waits for it.
class Webhook {
 public:
  struct Source {
    /// Stored events after a number, at most so many.
    std::function<std::vector<Event>(std::int64_t after, int most)> events;
    /// The number of the newest one; nothing if it is not known now.
    std::function<std::optional<std::int64_t>()> last_event;
    std::function<void(const std::string& line)> log;
  };
  /// What is granted to an answer: nothing in it is used but its status.
  struct Patience {
    double answer_s{5};  ///< from the first byte of the request to the last of the answer
    std::uint64_t answer_bytes{64u << 10};  ///< its head included
    std::chrono::milliseconds pause{1000};  ///< before an event is sent again; doubled each time
  };
  /// @param cursor_file  holds the number of the last event that was taken
  Webhook(WebhookTarget target, std::string cursor_file, Source source)
      : Webhook(std::move(target), std::move(cursor_file), std::move(source), Patience{}) {}
  Webhook(WebhookTarget target, std::string cursor_file, Source source, const Patience& patience);
  ~Webhook();  ///< a running request ends within seconds
  Webhook(const Webhook&) = delete;
  Webhook& operator=(const Webhook&) = delete;

  /// There is a new event. From any thread.
  void wake();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace popcut::daemon
