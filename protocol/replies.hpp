// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// The bytes of the GPGL queries that popcut sends. Each has one reply that ends with ETX and does
/// not say which query it answers, so send one query at a time.
inline constexpr std::string_view kStatusQuery{"\x1b\x05"};
inline constexpr std::string_view kIdentityQuery{"FG\x03"};

inline constexpr std::string_view kWindowQuery{"U\x03"};  ///< the far corner of the window

/// Asks a GPGL machine for the tools in its holders (variant cameo4).
inline constexpr std::string_view kToolsQuery{"\x1b\x15"};

/// Asks an HPGL machine for the limits of its coordinates; the reply ends with CR.
inline constexpr std::string_view kLimitsQuery{"OH;"};

/// What a GPGL machine replies when asked for its status: 0 to 4 in this order. Any other reply is
/// Unknown and must never count as Ready.
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

/// The reply to OH: the least and the largest coordinates that the machine takes.
struct CoordinateLimits {
  MachinePoint least, most;
};

/// @retval Malformed  not four numbers, or no area between them
[[nodiscard]] Result<CoordinateLimits> parse_limits(std::string_view reply);

/// `least` to `most` numbers, separated by commas and padded with blanks.
///
/// @retval Malformed  not that many numbers
[[nodiscard]] Result<std::vector<double>> parse_numbers(std::string_view reply, std::size_t least,
                                                        std::size_t most);
inline constexpr int kAutobladeCode = 2;

/// The reply to ESC NAK, one code per holder: 0 empty, 1 ratchet blade, 2 autoblade, 3 deep cut, 4
/// kraft blade, 5 rotary blade, 7 pen, 255 error.
///
/// @retval Malformed  not one to eight codes
[[nodiscard]] Result<std::vector<int>> parse_tools(std::string_view reply);
/// "empty", "ratchet blade", ...; "unknown tool" for codes without a known meaning.
[[nodiscard]] std::string_view tool_name(int code);

/// One number, padded with blanks: the reply to FQ0.
///
/// @retval Malformed  not one number
[[nodiscard]] Result<double> parse_number(std::string_view reply);

}  // namespace popcut
