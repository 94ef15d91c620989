// SPDX-License-Identifier: MIT
#include "protocol/replies.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
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
  return fail(
      ErrorKind::Malformed, "",
      fmt::format("the device replied \"{}\"; {}", shown_ascii(reply, kLongestReply), expected));
}

}  // namespace

DeviceStatus parse_status(std::string_view reply) {
  const std::string_view text = trimmed(without_end(reply), " ");
  if (text.size() != 1 || text.front() < '0' || text.front() > '4') return DeviceStatus::Unknown;
  return static_cast<DeviceStatus>(text.front() - '0');
}

std::string_view name_of(DeviceStatus status) {
  constexpr std::array<std::string_view, 6> kNames{"ready",  "moving",    "no media",
                                                   "paused", "cancelled", "unknown"};
  return kNames.at(static_cast<std::size_t>(status));
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

Result<std::vector<double>> parse_numbers(std::string_view reply, std::size_t least,
                                          std::size_t most) {
  Arguments arguments;
  bool valid = reply.size() <= kLongestReply;
  if (valid)
    for (const char c : without_end(reply)) valid = valid && arguments.take(c);
  arguments.end();
  if (valid && !arguments.bad() && arguments.values().size() >= least &&
      arguments.values().size() <= most)
    return arguments.values();
  return not_a_reply(
      reply, least == most
                 ? fmt::format("{} number{} expected", least, least == 1 ? " was" : "s were")
                 : fmt::format("{} to {} numbers were expected", least, most));
}

Result<CoordinateLimits> parse_limits(std::string_view reply) {
  return parse_numbers(reply, 4, 4)
      .and_then([&](const std::vector<double>& v) -> Result<CoordinateLimits> {
        if (!(v[0] < v[2] && v[1] < v[3]))
          return not_a_reply(reply, "there is no area between them");
        return CoordinateLimits{{v[0], v[1]}, {v[2], v[3]}};
      });
}

Result<double> parse_number(std::string_view reply) {
  return parse_numbers(reply, 1, 1).map([](const std::vector<double>& values) {
    return values[0];
  });
}

Result<std::vector<int>> parse_tools(std::string_view reply) {
  const auto values = parse_numbers(reply, 1, 8);
  if (!values) return tl::unexpected(values.error());
  std::vector<int> codes;
  for (const double value : *values) {
    if (!(value >= 0 && value <= 255) || value != std::floor(value))
      return fail(ErrorKind::Malformed, "", "tool codes of 0 to 255 were expected");
    codes.push_back(static_cast<int>(value));
  }
  return codes;
}

std::string_view tool_name(int code) {
  constexpr std::array<std::string_view, 8> kNames{
      "empty",       "ratchet blade", "autoblade",    "deep-cut blade",
      "kraft blade", "rotary blade",  "unknown tool", "pen"};
  if (code == 255) return "error";
  return code >= 0 && code < 8 ? kNames[static_cast<std::size_t>(code)] : "unknown tool";
}

}  // namespace popcut
