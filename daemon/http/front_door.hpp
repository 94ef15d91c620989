// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/http/api/message.hpp"
#include "daemon/model/local_users.hpp"

namespace popcut::daemon::http {

/// The other end of a connection.
struct Peer {
  bool is_local{false};  ///< unix socket: `uid` and `groups` are those of the process there
  uid_t uid{};
  std::vector<gid_t> groups{};
  std::string address{};  ///< TCP: without the port
  std::uint16_t port{};   ///< TCP: the port of ours that it came to
};

/// What limits count a peer by: its user, or its address; of IPv6 its network, since one computer
/// has as many addresses there as it likes.
[[nodiscard]] std::string place_of(const Peer& peer);

/// Hosts and origins that are ours.
struct Names {
  std::vector<std::string> hosts;    ///< besides localhost, 127.0.0.1 and [::1]: "name:port"
  std::vector<std::string> origins;  ///< besides http:// of those: "https://name"
};

/// Nothing if Host names this daemon: a page of elsewhere whose name was turned to 127.0.0.1 sends
/// its own name. Over the unix socket no page can come, and any host passes.
[[nodiscard]] std::optional<Problem> check_host(const RequestHead& head, const Peer& peer,
                                                const Names& names);

/// Nothing if the request changes nothing, or is not sent by a page of elsewhere. Origin is held
/// against the names that are known, never against Host.
[[nodiscard]] std::optional<Problem> check_origin(const RequestHead& head, const Peer& peer,
                                                  const Names& names);

/// The principal behind a unix socket.
/// @param machine  of a fleet: "@room-1" after the user's number, which is somebody else elsewhere
/// @retval Forbidden  a user without a role
[[nodiscard]] Answer<Principal> local_principal(const Peer& peer, const LocalUsers& users,
                                                uid_t own_uid, const std::string& machine = {});

/// The token of `Authorization: Bearer ...`.
/// @retval Unauthenticated  there is no token, or it is malformed
[[nodiscard]] Answer<std::string> bearer_of(const RequestHead& head);

/// Nothing if the body has a form that `media_type` can say: no Content-Encoding, no parameters
/// but charset=utf-8. Fills `media_type` in lower case.
[[nodiscard]] std::optional<Problem> check_media(const RequestHead& head, std::string& media_type);

}  // namespace popcut::daemon::http
