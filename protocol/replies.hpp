// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// The bytes of the GPGL queries that popcut sends. Each has one reply that ends with ETX and does
/// not say which query it answers, so send one query at a time.
inline constexpr std::string_view kStatusQuery{"\x1b\x05"};
inline constexpr std::string_view kIdentityQuery{"FG\x03"};

/// What a GPGL machine replies when asked for its status. Any other reply is Unknown and must never
/// count as Ready.
enum class DeviceStatus : std::uint8_t { Ready, Moving, NoMedia, Paused, Cancelled, Unknown };

/// A status reply, with or without its ETX.
[[nodiscard]] DeviceStatus parse_status(std::string_view reply);
/// "ready", "moving", "no media", "paused", "cancelled", "unknown".
[[nodiscard]] std::string_view name_of(DeviceStatus status);

/// The reply to FG: "CAMEO 3 V1.60    " is model "CAMEO 3" and firmware "V1.60".
struct Identity {
  std::string model;
  std::string firmware;  ///< empty if the reply names none
};

/// @retval Malformed  empty, blank, longer than 64 characters, or not printable
[[nodiscard]] Result<Identity> parse_identity(std::string_view reply);

/// Two numbers, padded with blanks: the reply to `[`, `U`, FA, TB71 and TC.
struct NumberPair {
  double first{};
  double second{};
};

/// @retval Malformed  not two numbers
[[nodiscard]] Result<NumberPair> parse_pair(std::string_view reply);
/// One number, padded with blanks: the reply to FQ0.
///
/// @retval Malformed  not one number
[[nodiscard]] Result<double> parse_number(std::string_view reply);

/// The reply to G: where the tool is, in units of the feed and the carriage.
///
/// @retval Malformed  not three numbers
[[nodiscard]] Result<NumberPair> parse_position(std::string_view reply);

/// The reply to ESC NAK, one code per holder: 0 empty, 1 ratchet blade, 2 autoblade, 3 deep cut, 4
/// kraft blade, 5 rotary blade, 7 pen, 255 error.
///
/// @retval Malformed  not one to eight whole numbers of 0 to 255
[[nodiscard]] Result<std::vector<int>> parse_tools(std::string_view reply);
/// "empty", "ratchet blade", ...; "unknown tool" for codes without a known meaning.
[[nodiscard]] std::string_view tool_name(int code);

}  // namespace popcut
