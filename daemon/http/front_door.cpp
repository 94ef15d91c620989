// SPDX-License-Identifier: MIT
#include "daemon/http/front_door.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/text/words.hpp"
#include "daemon/http/head.hpp"

namespace popcut::daemon::http {
namespace {

constexpr std::array<std::string_view, 3> kOwnHosts{"localhost", "127.0.0.1", "[::1]"};

bool is_listed(const std::vector<std::string>& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

bool is_own_host(std::string_view host, std::uint16_t port) {
  for (const std::string_view own : kOwnHosts) {
    if (host == fmt::format("{}:{}", own, port)) return true;
    if (port == 80 && host == own) return true;
  }
  return false;
}

}  // namespace

std::optional<Problem> check_host(const RequestHead& head, const Peer& peer, const Names& names) {
  const std::string host = to_lower(head.header("host").value_or(""));
  if (peer.is_local) return std::nullopt;
  if (is_own_host(host, peer.port) || is_listed(names.hosts, host)) return std::nullopt;
  return Problem{ProblemKind::WrongHost,
                 fmt::format("popcutd at localhost:{} does not serve this Host; if it is a name of "
                             "this computer, add it to allowed_hosts",
                             peer.port)};
}

std::optional<Problem> check_origin(const RequestHead& head, const Peer& peer, const Names& names) {
  if (head.method == Method::Get || head.method == Method::Head) return std::nullopt;
  const auto elsewhere = [] {
    return Problem{
        ProblemKind::Forbidden,
        "requests from pages of other origins are refused; use popcut's own page or a program"};
  };
  if (const auto origin = head.header("origin")) {
    constexpr std::string_view kHttp = "http://";
    const std::string lower = to_lower(*origin);
    const bool is_own = lower.starts_with(kHttp) && !peer.is_local &&
                        is_own_host(std::string_view(lower).substr(kHttp.size()), peer.port);
    if (!is_own && !is_listed(names.origins, lower)) return elsewhere();
  }
  const auto site = head.header("sec-fetch-site");
  if (site && *site != "same-origin") return elsewhere();
  return std::nullopt;
}

std::string place_of(const Peer& peer) {
  if (peer.is_local) return fmt::format("uid:{}", peer.uid);
  in6_addr address{};
  if (::inet_pton(AF_INET6, peer.address.c_str(), &address) != 1) return peer.address;
  if (IN6_IS_ADDR_LOOPBACK(&address) || IN6_IS_ADDR_V4MAPPED(&address)) return peer.address;
  std::fill(std::begin(address.s6_addr) + 8, std::end(address.s6_addr), std::uint8_t{0});
  std::array<char, INET6_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET6, &address, text.data(), text.size());
  return fmt::format("{}/64", text.data());
}

Answer<Principal> local_principal(const Peer& peer, const LocalUsers& users, uid_t own_uid,
                                  const std::string& machine) {
  Principal principal{.name = fmt::format("uid:{}{}", peer.uid, machine),
                      .user = LocalUser{peer.uid, peer.groups}};
  const std::optional<Role> role = role_of(*principal.user, users, own_uid);
  if (!role)
    return refuse(ProblemKind::Forbidden,
                  fmt::format("user {} has no role; an administrator can add a [[user]] to "
                              "popcutd.toml, or add the user to a group (popcut: operator)",
                              peer.uid));
  principal.role = *role;
  return principal;
}

Answer<std::string> bearer_of(const RequestHead& head) {
  const auto value = head.header("authorization");
  if (!value)
    return refuse(ProblemKind::Unauthenticated,
                  "a token is required; send 'Authorization: Bearer pc_...', or use the unix "
                  "socket; 'popcut token create' creates a token");
  constexpr std::string_view kScheme = "bearer ";
  if (to_lower(value->substr(0, kScheme.size())) != kScheme)
    return refuse(ProblemKind::Unauthenticated, "Authorization must be a Bearer token");
  const std::string_view token = trimmed(value->substr(kScheme.size()), " \t");
  const bool has_form =
      token.size() >= 8 && token.size() <= 200 &&
      std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c < '\x7F'; });
  if (!has_form) return refuse(ProblemKind::Unauthenticated, "this is not a popcut token");
  return std::string(token);
}

std::optional<Problem> check_media(const RequestHead& head, std::string& media_type) {
  if (const auto coding = head.header("content-encoding");
      coding && to_lower(*coding) != "identity")
    return Problem{ProblemKind::UnsupportedMedia,
                   "compressed bodies are not accepted; send the body without Content-Encoding"};
  const auto value = head.header("content-type");
  if (!value) return std::nullopt;
  const std::string lower = to_lower(*value);
  const std::size_t semicolon = lower.find(';');
  media_type = std::string(trimmed(std::string_view(lower).substr(0, semicolon), " \t"));
  if (media_type.starts_with("multipart/"))
    return Problem{
        ProblemKind::UnsupportedMedia,
        "forms with parts (multipart) are not accepted; send the file alone as the body, "
        "as in: curl --data-binary @FILE -H 'Content-Type: application/octet-stream'"};
  if (semicolon == std::string::npos) return std::nullopt;
  const std::string_view parameter = trimmed(std::string_view(lower).substr(semicolon + 1), " \t");
  if (parameter != "charset=utf-8" && parameter != "charset=\"utf-8\"")
    return Problem{ProblemKind::UnsupportedMedia,
                   "the only parameter allowed in Content-Type is charset=utf-8"};
  return std::nullopt;
}

}  // namespace popcut::daemon::http
