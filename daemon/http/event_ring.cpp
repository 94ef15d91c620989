// SPDX-License-Identifier: MIT
#include "daemon/http/event_ring.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {
namespace {

std::string one_line(std::string_view text) {
  std::string out(text);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c == '\n' || c == '\r' || c == '\0'; }, ' ');
  return out;
}

}  // namespace

std::string frame_text(std::string_view event, std::string_view data) {
  return fmt::format("event: {}\ndata: {}\n\n", one_line(event), one_line(data));
}

EventFramePtr frame_of(const Event& event) { return frame_of(event, {}); }

EventFramePtr frame_of(const Event& event, std::string_view members) {
  EventFrame frame{event.seq, event.kind == "progress", event.job};
  std::string data = event_json(event);
  if (!members.empty()) {
    frame.brief = frame_of(event);
    data.back() = ',';  // "{...}": more members follow in place of its last bracket
    data.append(members).append("}");
  }
  if (event.seq > 0) frame.text = fmt::format("id: {}\n", event.seq);
  frame.text += frame_text(event.kind, data);
  return std::make_shared<const EventFrame>(std::move(frame));
}

bool EventRing::fits(const EventFrame& frame) const {
  return frames_.size() < most_events_ && bytes_ + frame.text.size() <= most_bytes_;
}

bool EventRing::drop_progress(const std::string* of_job) {
  const auto found = std::find_if(frames_.begin(), frames_.end(), [&](const EventFramePtr& frame) {
    return frame->is_progress && (of_job == nullptr || frame->job == *of_job);
  });
  if (found == frames_.end()) return false;
  bytes_ -= (*found)->text.size();
  frames_.erase(found);
  ++dropped_;
  return true;
}

void EventRing::push(EventFramePtr frame) {
  if (overflowed_) {
    ++dropped_;
    return;
  }
  if (frame->brief && bytes_ + frame->text.size() > most_bytes_ / 2) frame = frame->brief;
  if (frame->is_progress) drop_progress(&frame->job);
  while (!fits(*frame) && drop_progress(nullptr)) {
  }
  if (fits(*frame)) {
    bytes_ += frame->text.size();
    frames_.push_back(std::move(frame));
    return;
  }
  ++dropped_;
  if (!frame->is_progress) give_up();
}

void EventRing::give_up() {
  dropped_ += frames_.size();
  frames_.clear();
  bytes_ = 0;
  overflowed_ = true;
}

EventFramePtr EventRing::pop() {
  if (frames_.empty()) return nullptr;
  EventFramePtr frame = std::move(frames_.front());
  frames_.pop_front();
  bytes_ -= frame->text.size();
  return frame;
}

}  // namespace popcut::daemon::http
