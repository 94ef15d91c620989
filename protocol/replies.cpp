// SPDX-License-Identifier: MIT
#include "protocol/replies.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "core/text/blanks.hpp"
#include "protocol/arguments.hpp"
#include "protocol/program.hpp"

namespace popcut {
namespace {

std::string_view without_end(std::string_view reply) {
  if (!reply.empty() && reply.back() == kEtx) reply.remove_suffix(1);
  return reply;
}

constexpr std::size_t kLongestReply = 64;

/// An error that quotes the reply, cut short and without control characters.
tl::unexpected<Error> not_a_reply(std::string_view reply, std::string_view expected) {
  std::string text(reply.substr(0, kLongestReply));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return fail(ErrorKind::Malformed, "",
              fmt::format("the device replied \"{}\"; {}", text, expected));
}

Result<std::vector<double>> parse_numbers(std::string_view reply, std::size_t wanted,
                                          std::size_t most) {
  Arguments arguments;
  bool valid = reply.size() <= kLongestReply;
  if (valid)
    for (const char c : without_end(reply)) valid = valid && arguments.take(c);
  arguments.end();
  if (valid && !arguments.bad() && arguments.values().size() >= wanted &&
      arguments.values().size() <= most)
    return arguments.values();
  return not_a_reply(
      reply, wanted == most
                 ? fmt::format("{} number{} expected", wanted, wanted == 1 ? " was" : "s were")
                 : fmt::format("{} to {} numbers were expected", wanted, most));
}

}  // namespace

DeviceStatus parse_status(std::string_view reply) {
  const std::string_view text = trimmed(without_end(reply), " ");
  if (text.size() != 1) return DeviceStatus::Unknown;
  switch (text.front()) {
    case '0':
      return DeviceStatus::Ready;
    case '1':
      return DeviceStatus::Moving;
    case '2':
      return DeviceStatus::NoMedia;
    case '3':
      return DeviceStatus::Paused;
    case '4':
      return DeviceStatus::Cancelled;
    default:
      return DeviceStatus::Unknown;
  }
}

std::string_view name_of(DeviceStatus status) {
  switch (status) {
    case DeviceStatus::Ready:
      return "ready";
    case DeviceStatus::Moving:
      return "moving";
    case DeviceStatus::NoMedia:
      return "no media";
    case DeviceStatus::Paused:
      return "paused";
    case DeviceStatus::Cancelled:
      return "cancelled";
    case DeviceStatus::Unknown:
      return "unknown";
  }
  return "unknown";
}

Result<Identity> parse_identity(std::string_view reply) {
  const std::string_view text = trimmed(without_end(reply), " ");
  const bool prints =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (text.empty() || text.size() > kLongestReply || !prints)
    return not_a_reply(reply, "a model and its firmware were expected as the answer to FG");
  const std::size_t blank = text.rfind(' ');
  const bool versioned = blank != std::string_view::npos && text.size() > blank + 2 &&
                         text[blank + 1] == 'V' && text[blank + 2] >= '0' && text[blank + 2] <= '9';
  if (!versioned) return Identity{std::string(text), {}};
  return Identity{std::string(trimmed(text.substr(0, blank), " ")),
                  std::string(text.substr(blank + 1))};
}

Result<NumberPair> parse_pair(std::string_view reply) {
  return parse_numbers(reply, 2, 2).map([](const std::vector<double>& values) {
    return NumberPair{values[0], values[1]};
  });
}

Result<double> parse_number(std::string_view reply) {
  return parse_numbers(reply, 1, 1).map([](const std::vector<double>& values) {
    return values[0];
  });
}

Result<NumberPair> parse_position(std::string_view reply) {
  return parse_numbers(reply, 3, 3).map([](const std::vector<double>& values) {
    return NumberPair{values[0], values[1]};
  });
}

Result<std::vector<int>> parse_tools(std::string_view reply) {
  const auto values = parse_numbers(reply, 1, 8);
  if (!values) return tl::unexpected(values.error());
  std::vector<int> codes;
  for (const double value : *values) {
    if (!(value >= 0 && value <= 255) || value != static_cast<int>(value))
      return not_a_reply(reply, "tool codes of 0 to 255 were expected");
    codes.push_back(static_cast<int>(value));
  }
  return codes;
}

std::string_view tool_name(int code) {
  switch (code) {
    case 0:
      return "empty";
    case 1:
      return "ratchet blade";
    case 2:
      return "autoblade";
    case 3:
      return "deep-cut blade";
    case 4:
      return "kraft blade";
    case 5:
      return "rotary blade";
    case 7:
      return "pen";
    case 255:
      return "error";
    default:
      return "unknown tool";
  }
}

}  // namespace popcut
