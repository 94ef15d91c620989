// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut::client {

/// An address of popcutd: a unix socket, or a host and port.
struct Address {
  std::string path{};  ///< of the socket; empty: TCP
  std::string host{};
  std::uint16_t port{};

  /// "/run/popcut.sock" or "http://127.0.0.1:8631", for messages.
  [[nodiscard]] std::string text() const;
  /// The value of the Host header.
  [[nodiscard]] std::string host_header() const;
};

/// The environment: a variable's value, or nullptr.
using Environment = std::function<const char*(const char*)>;

/// "http://127.0.0.1:8631", "unix:/run/popcut.sock" or "/run/popcut.sock".
///
/// @retval Usage  it is none of these; the place is POPCUT_URL
[[nodiscard]] Result<Address> parse_address(std::string_view text);

/// Where to look for popcutd, the first that answers wins: POPCUT_URL alone if it is set; the
/// loopback address if there is a POPCUT_TOKEN; else the sockets in $XDG_RUNTIME_DIR, in the
/// user's state folder, and in /run.
[[nodiscard]] Result<std::vector<Address>> addresses(const Environment& environment);

/// POPCUT_TOKEN, or an empty text.
///
/// @retval Usage  it contains a character that a header cannot have
[[nodiscard]] Result<std::string> bearer_token(const Environment& environment);

/// $XDG_STATE_HOME/popcut, else ~/.local/state/popcut; empty if neither is set.
[[nodiscard]] std::string user_state_folder(const Environment& environment);
/// Where popcutd looks for its configuration; it reads the first that is there. Of a service
/// $CONFIGURATION_DIRECTORY, else the user's own and then /etc/popcut/popcutd.toml.
[[nodiscard]] std::vector<std::string> configuration_files(const Environment& environment);

}  // namespace popcut::client
