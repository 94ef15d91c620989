// SPDX-License-Identifier: MIT
#include "daemon/service/tokens.hpp"

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

constexpr std::int64_t kOneShotMs = 60'000;
constexpr std::size_t kMostOneShots = 100;
constexpr int kLongestLifetimeS = 10 * 366 * 86'400;
// A session's end is moved on at most so often, so that reading writes nearly nothing.
constexpr std::int64_t kExtendMs = 10 * 60'000;

struct Parts {
  std::string_view id, secret;
};

// "pc_<26>_<43>"
std::optional<Parts> parts_of(std::string_view bearer) {
  if (bearer.size() != 3 + 26 + 1 + 43 || !bearer.starts_with("pc_") || bearer[29] != '_')
    return std::nullopt;
  return Parts{bearer.substr(3, 26), bearer.substr(30)};
}

}  // namespace

std::optional<Principal> Tokens::authenticate(std::string_view bearer) {
  const std::optional<Parts> parts = parts_of(bearer);
  if (!parts || !is_ulid(parts->id)) return std::nullopt;
  std::string secret, principal, kind;
  std::optional<TimeMs> expires;
  std::optional<Role> role;
  try {
    Rows rows = store_.db().rows(
        "SELECT secret_sha256, role, principal, expires, kind FROM token WHERE id=?", parts->id);
    if (rows.next()) {
      secret = rows.text(0);
      role = role_from(rows.text(1));
      principal = rows.text(2);
      expires = rows.maybe_integer(3);
      kind = rows.text(4);
    }
  } catch (const StoreFault& fault) {
    store_.note(fault);
    return std::nullopt;
  }
  if (!equal_in_constant_time(secret, sha256_hex(parts->secret)) || !role) return std::nullopt;
  const TimeMs now = store_.now();
  if (expires && *expires <= now) return std::nullopt;
  if (kind == "session" && *expires < now + options_.session_ms - kExtendMs) {
    // If it cannot be written the session ends earlier, no more.
    (void)store_.change([&]() -> Answer<void> {
      store_.db().run("UPDATE token SET expires=? WHERE id=?", now + options_.session_ms,
                      parts->id);
      return {};
    });
  }
  return Principal{principal, *role};
}

NewToken Tokens::store(const char* kind, const std::string& name, Role role,
                       const std::string& principal, std::optional<TimeMs> expires) {
  NewToken token;
  token.record = {.id = store_.new_id(),
                  .name = name,
                  .role = role,
                  .created = store_.now(),
                  .expires = expires};
  const std::string secret = base64url(random_bytes(32));
  store_.db().insert(
      "INSERT INTO token(id, kind, name, role, principal, secret_sha256, created, expires)",
      token.record.id, kind, name, name_of(role),
      principal.empty() ? "token:" + token.record.id : principal, sha256_hex(secret),
      token.record.created, expires);
  token.text = fmt::format("pc_{}_{}", token.record.id, secret);
  return token;
}

Answer<NewToken> Tokens::create_token(const Principal& who, const std::string& name, Role role,
                                      std::optional<int> lifetime_s) {
  if (who.role < Role::Admin)
    return refuse(ProblemKind::Forbidden, "only an admin may create tokens");
  if (name.empty() || name.size() > 120)
    return tl::unexpected(
        invalid_value("/name", "range", "must have 1 to 120 characters", "the name is not valid"));
  if (lifetime_s && (*lifetime_s < 1 || *lifetime_s > kLongestLifetimeS))
    return tl::unexpected(invalid_value("/lifetime_s", "range",
                                        fmt::format("must be 1..{}", kLongestLifetimeS),
                                        "the lifetime is not valid"));
  return store_.change([&]() -> Answer<NewToken> {
    std::optional<TimeMs> expires;
    if (lifetime_s) expires = store_.now() + std::int64_t{*lifetime_s} * 1000;
    NewToken token = store("token", name, role, "", expires);
    store_.audit(who.name, "create-token", token.record.id,
                 fmt::format("{} {}", name_of(role), name));
    return token;
  });
}

std::vector<TokenRecord> Tokens::tokens() {
  std::vector<TokenRecord> all;
  Rows rows = store_.db().rows(
      "SELECT id, name, role, created, expires FROM token WHERE kind='token' ORDER BY id");
  while (rows.next())
    all.push_back({.id = rows.text(0),
                   .name = rows.text(1),
                   .role = role_from(rows.text(2)).value_or(Role::Viewer),
                   .created = rows.integer(3),
                   .expires = rows.maybe_integer(4)});
  return all;
}

Answer<void> Tokens::delete_token(const Principal& who, const std::string& id) {
  return store_.change([&]() -> Answer<void> {
    Rows rows = store_.db().rows("SELECT principal FROM token WHERE id=?", id);
    if (!rows.next()) return refuse(ProblemKind::NotFound, "there is no token " + id);
    if (who.role < Role::Admin && rows.text(0) != who.name)
      return refuse(ProblemKind::Forbidden, "only an admin may revoke someone else's token");
    store_.db().run("DELETE FROM token WHERE id=?", id);
    store_.audit(who.name, "delete-token", id, "");
    return {};
  });
}

Answer<std::string> Tokens::create_one_shot(const Principal& who) {
  tidy();
  if (one_shots_.size() >= kMostOneShots)
    return tl::unexpected(Problem{ProblemKind::Rate,
                                  "too many pages are being opened; try again in a minute",
                                  {},
                                  {},
                                  {},
                                  {},
                                  60});
  const std::string word = base64url(random_bytes(32));
  one_shots_[sha256_hex(word)] = {who, store_.monotonic() + kOneShotMs};
  return word;
}

Answer<NewToken> Tokens::open_session(const std::string& one_shot) {
  const auto found = one_shots_.find(sha256_hex(one_shot));
  if (found == one_shots_.end() || found->second.until_ms <= store_.monotonic())
    return refuse(
        ProblemKind::Unauthenticated,
        "this address was used already or is older than a minute; run 'popcut open' for a new one");
  const Principal who = found->second.principal;
  one_shots_.erase(found);
  return store_.change([&]() -> Answer<NewToken> {
    NewToken token =
        store("session", "page", who.role, who.name, store_.now() + options_.session_ms);
    store_.audit(who.name, "open-session", token.record.id, "");
    return token;
  });
}

void Tokens::tidy() {
  const std::int64_t now = store_.monotonic();
  std::erase_if(one_shots_, [&](const auto& one) { return one.second.until_ms <= now; });
}

}  // namespace popcut::daemon
