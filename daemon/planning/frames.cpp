// SPDX-License-Identifier: MIT
#include "daemon/planning/frames.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace popcut::planning {
namespace {

constexpr std::string_view kMagic{"PCW1"};

void put(std::string& text, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) text += static_cast<char>((value >> (8 * i)) & 0xFF);
}

std::uint64_t number_at(std::string_view text, std::size_t at, int bytes) {
  std::uint64_t value = 0;
  for (int i = bytes; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(text[at + static_cast<std::size_t>(i)]);
  return value;
}

}  // namespace

bool is_plain_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return !name.empty() && name.size() <= kMostNameBytes && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), plain);
}

std::string frame_head(FrameKind kind, std::string_view name, std::uint64_t bytes) {
  std::string head(kMagic);
  put(head, static_cast<std::uint32_t>(kind), 4);
  put(head, name.size(), 4);
  put(head, bytes, 8);
  head += name;
  return head;
}

/// Reads head and name from the buffer, once they are there.
Result<void> FrameReader::begin() {
  const auto malformed = [](const char* what) { return fail(ErrorKind::Malformed, "pipe", what); };
  if (std::string_view(buffer_).substr(0, kMagic.size()) != kMagic)
    return malformed("not the start of a frame");
  const std::uint64_t kind = number_at(buffer_, 4, 4);
  if (kind < 1 || kind > static_cast<std::uint64_t>(FrameKind::Phase))
    return malformed("a frame of an unknown kind");
  const std::uint64_t name_size = number_at(buffer_, 8, 4);
  if (name_size > kMostNameBytes) return malformed("a frame's name is too long");
  expected_ = number_at(buffer_, 12, 8);
  if (expected_ > left_)
    return fail(ErrorKind::OutOfRange, "pipe",
                fmt::format("more than the {} bytes allowed", left_));
  if (buffer_.size() < kFrameHeadBytes + name_size) return {};
  Frame frame{static_cast<FrameKind>(kind), buffer_.substr(kFrameHeadBytes, name_size), {}};
  if (!frame.name.empty() && !is_plain_name(frame.name))
    return malformed("a frame's name is not a file name");
  left_ -= expected_;
  buffer_.clear();
  frame_ = std::move(frame);
  return {};
}

Result<void> FrameReader::feed(std::string_view bytes,
                               const std::function<Result<void>(Frame)>& take) {
  while (!bytes.empty() || (frame_ && frame_->bytes.size() == expected_)) {
    if (!frame_) {
      const std::size_t head =
          buffer_.size() < kFrameHeadBytes
              ? kFrameHeadBytes
              : kFrameHeadBytes + static_cast<std::size_t>(number_at(buffer_, 8, 4));
      const std::size_t piece = std::min(bytes.size(), head - buffer_.size());
      buffer_ += bytes.substr(0, piece);
      bytes.remove_prefix(piece);
      if (buffer_.size() < kFrameHeadBytes) continue;
      if (const Result<void> begun = begin(); !begun) return begun;
      continue;
    }
    const std::uint64_t missing = expected_ - frame_->bytes.size();
    const auto piece = static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), missing));
    frame_->bytes += bytes.substr(0, piece);
    bytes.remove_prefix(piece);
    if (frame_->bytes.size() < expected_) continue;
    Frame whole = std::move(*frame_);
    frame_.reset();
    if (const Result<void> taken = take(std::move(whole)); !taken) return taken;
  }
  return {};
}

}  // namespace popcut::planning
