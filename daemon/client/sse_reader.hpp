// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace popcut::client {

/// One event of a stream (WHATWG, server-sent events).
struct SseEvent {
  std::string kind{"message"};
  std::string data;
  std::string id;  ///< of this event, or of the last one that had one
};

/// Takes the bytes of an event stream in any pieces and gives whole events.
class SseReader {
 public:
  /// An event larger than `most_bytes` ends the stream: `feed` gives nothing more.
  explicit SseReader(std::size_t most_bytes = 1u << 20) : most_bytes_(most_bytes) {}
  [[nodiscard]] std::vector<SseEvent> feed(std::string_view bytes);
  [[nodiscard]] const std::string& last_id() const { return last_id_; }
  [[nodiscard]] bool broken() const { return broken_; }
  /// A new stream begins; the last id stays.
  void restart();

 private:
  void line(std::string_view text, std::vector<SseEvent>& events);
  std::size_t most_bytes_;
  std::string line_, data_, kind_, last_id_;
  bool after_return_{false}, has_data_{false}, broken_{false};
};

}  // namespace popcut::client
