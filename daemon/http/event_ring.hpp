// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>

#include "daemon/model/model.hpp"

namespace popcut::daemon::http {

/// An event as it goes to clients.
struct EventFrame;
using EventFramePtr = std::shared_ptr<const EventFrame>;  // one frame, many clients
struct EventFrame {
  std::int64_t seq{};  ///< 0: not stored, so it has no id
  bool is_progress{false};
  std::string job{};
  std::string text{};  ///< "id: 7\nevent: job\ndata: {...}\n\n"
  EventFramePtr
      brief{};  ///< the same without what it is about; null: there is nothing to leave out
};

[[nodiscard]] EventFramePtr frame_of(const Event& event);
/// With the member `"whole":{...}`, which slow clients do not get.
[[nodiscard]] EventFramePtr frame_of(const Event& event, std::string_view members);
/// A frame without an id.
[[nodiscard]] std::string frame_text(std::string_view event, std::string_view data);

/// The events that one client has yet to get. Bounded: `whole` is sent only while half of the ring
/// is free, because a client can request it; then progress is dropped, older events of a job first;
/// if that is not enough, the ring overflows and stays empty, and the client reconnects with its
/// last id.
class EventRing {
 public:
  EventRing(std::size_t most_events, std::size_t most_bytes)
      : most_events_(most_events), most_bytes_(most_bytes) {}

  void push(EventFramePtr frame);
  /// Overflows: clears the ring for good.
  void give_up();
  /// The oldest; nullptr if there is none.
  [[nodiscard]] EventFramePtr pop();
  [[nodiscard]] bool is_empty() const { return frames_.empty(); }
  [[nodiscard]] bool has_overflowed() const { return overflowed_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  /// Frames that were not sent.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  [[nodiscard]] bool fits(const EventFrame& frame) const;
  bool drop_progress(const std::string* of_job);
  std::deque<EventFramePtr> frames_;
  std::size_t most_events_, most_bytes_;
  std::size_t bytes_{0};
  std::uint64_t dropped_{0};
  bool overflowed_{false};
};

}  // namespace popcut::daemon::http
