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
  bool is_local{false};  ///< unix socket: `uid` and `groups` of the peer process
  uid_t uid{};
  std::vector<gid_t> groups{};
  std::string address{};  ///< TCP: without the port
  std::uint16_t port{};   ///< TCP: the local port
};

/// The key by which limits count a peer: its user or its address; for IPv6 its network, because one
/// computer can have any number of addresses there.
[[nodiscard]] std::string place_of(const Peer& peer);

/// Hosts and origins of this popcutd.
struct Names {
  std::vector<std::string> hosts;    ///< besides localhost, 127.0.0.1 and [::1]: "name:port"
  std::vector<std::string> origins;  ///< besides http:// of those: "https://name"
};

/// Nothing if Host names this popcutd. A foreign page whose name resolves to 127.0.0.1 (DNS
/// rebinding) sends its own name. No page can use the unix socket, so any host passes there.
[[nodiscard]] std::optional<Problem> check_host(const RequestHead& head, const Peer& peer,
                                                const Names& names);

/// Nothing if the request changes nothing, or does not come from a foreign page. Origin is compared
/// with the configured names, never with Host.
[[nodiscard]] std::optional<Problem> check_origin(const RequestHead& head, const Peer& peer,
                                                  const Names& names);

/// The principal behind a unix socket.
/// @param machine  of a fleet: "@room-1" after the user's number, who is another user on another
/// machine
/// @retval Forbidden  a user without a role
[[nodiscard]] Answer<Principal> local_principal(const Peer& peer, const LocalUsers& users,
                                                uid_t own_uid, const std::string& machine = {});

/// The token of `Authorization: Bearer ...`.
/// @retval Unauthenticated  there is no token, or it is malformed
[[nodiscard]] Answer<std::string> bearer_of(const RequestHead& head);

/// Nothing if `media_type` describes the body completely: no Content-Encoding, and no parameter but
/// charset=utf-8. Fills `media_type` in lower case.
[[nodiscard]] std::optional<Problem> check_media(const RequestHead& head, std::string& media_type);

}  // namespace popcut::daemon::http
