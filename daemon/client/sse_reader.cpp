// SPDX-License-Identifier: MIT
#include "daemon/client/sse_reader.hpp"

namespace popcut::client {

void SseReader::restart() {
  line_.clear();
  data_.clear();
  kind_.clear();
  after_return_ = has_data_ = broken_ = false;
}

void SseReader::line(std::string_view text, std::vector<SseEvent>& events) {
  if (text.empty()) {  // the end of an event
    if (has_data_) {
      if (!data_.empty()) data_.pop_back();  // the last line's end
      events.push_back({kind_.empty() ? "message" : kind_, data_, last_id_});
    }
    data_.clear();
    kind_.clear();
    has_data_ = false;
    return;
  }
  const std::size_t colon = text.find(':');
  if (colon == 0) return;  // a comment: the heartbeat
  const std::string_view field = text.substr(0, colon);
  std::string_view value = colon == std::string_view::npos ? "" : text.substr(colon + 1);
  if (!value.empty() && value.front() == ' ') value.remove_prefix(1);
  if (field == "event") kind_ = value;
  if (field == "id" && value.find('\0') == std::string_view::npos) last_id_ = value;
  if (field == "data") {
    data_.append(value).push_back('\n');
    has_data_ = true;
  }
}

std::vector<SseEvent> SseReader::feed(std::string_view bytes) {
  std::vector<SseEvent> events;
  for (const char c : bytes) {
    if (broken_) break;
    const bool second_half = after_return_ && c == '\n';
    after_return_ = c == '\r';
    if (second_half) continue;
    if (c == '\n' || c == '\r') {
      line(line_, events);
      line_.clear();
      continue;
    }
    line_.push_back(c);
    broken_ = line_.size() + data_.size() > most_bytes_;
  }
  return events;
}

}  // namespace popcut::client
