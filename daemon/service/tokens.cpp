// SPDX-License-Identifier: MIT
#include "daemon/service/tokens.hpp"

#include <unistd.h>

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "daemon/model/input_limits.hpp"

namespace popcut::daemon {
namespace {

constexpr std::int64_t kOneShotMs = 60'000;
constexpr std::size_t kMostOneShots = 100;
constexpr std::size_t kOneShotsOfOne = 10;   // of one principal
constexpr std::int64_t kSessionsOfOne = 32;  // of one principal; more delete the first to expire
// A session is extended at most this often, so that requests that only read seldom write.
constexpr std::int64_t kExtendMs = 10 * 60'000;
constexpr std::size_t kMostKnown = 1000;
constexpr std::int64_t kKnown_ms = 3'600'000;  // longer than a cut takes

struct TokenParts {
  std::string_view id, secret;
};

// "pc_<26>_<43>"
std::optional<TokenParts> parts_of(std::string_view bearer) {
  if (bearer.size() != 3 + 26 + 1 + 43 || !bearer.starts_with("pc_") || bearer[29] != '_')
    return std::nullopt;
  return TokenParts{bearer.substr(3, 26), bearer.substr(30)};
}

std::string text_of(const std::vector<gid_t>& groups) {
  return fmt::format("{}", fmt::join(groups, " "));
}

std::vector<gid_t> groups_from(const std::string& text) {
  std::vector<gid_t> groups;
  std::istringstream words(text);
  for (gid_t group{}; words >> group;) groups.push_back(group);
  return groups;
}

struct Secret {
  std::string text, sha256;
};

Secret new_secret(const std::string& id) {
  const std::string secret = base64url(random_bytes(32));
  return {fmt::format("pc_{}_{}", id, secret), sha256_hex(secret)};
}

}  // namespace

// A row of the table.
struct Tokens::Session {
  std::string id, token{};          ///< `token`: the root if it is a token, else empty
  std::optional<LocalUser> user{};  ///< the root if it is a user of this system
  std::string via{}, principal{}, secret{};
  TimeMs created{}, expires{}, ends{};
  std::string name{};          ///< of a tablet
  std::optional<Role> most{};  ///< the highest role that it may have
};

// The owner of a token that has not expired; nothing if there is none.
std::optional<Principal> Tokens::token_owner(const std::string& id, TimeMs now) {
  Rows rows = store_.db().rows("SELECT role, principal, expires FROM token WHERE id=?", id);
  if (!rows.next()) return std::nullopt;
  const std::optional<Role> role = role_from(rows.text(0));
  const std::optional<TimeMs> expires = rows.maybe_integer(2);
  if (!role || (expires && *expires <= now)) return std::nullopt;
  Principal owner{.name = rows.text(1), .role = *role, .credential = id};
  if (expires) owner.left_ms = *expires - now;
  return owner;
}

std::optional<Principal> Tokens::authenticate_token(std::string_view id, std::string_view secret) {
  {
    Rows rows = store_.db().rows("SELECT secret_sha256 FROM token WHERE id=?", id);
    if (!rows.next() || !equal_in_constant_time(rows.text(0), sha256_hex(secret)))
      return std::nullopt;
  }
  return token_owner(std::string(id), store_.now());
}

std::optional<Tokens::Session> Tokens::session(const std::string& id) {
  Rows rows = store_.db().rows(
      "SELECT token, uid, groups, via, principal, secret_sha256, created, expires, ends, name, "
      "most FROM session WHERE id=?",
      id);
  if (!rows.next()) return std::nullopt;
  Session one{.id = id};
  if (!rows.null(0)) one.token = rows.text(0);
  if (!rows.null(1))
    one.user = LocalUser{static_cast<uid_t>(rows.integer(1)), groups_from(rows.text(2))};
  if (!rows.null(3)) one.via = rows.text(3);
  rows.read(4, std::tie(one.principal, one.secret, one.created, one.expires, one.ends, one.name));
  // A role that cannot be read counts as the lowest one.
  if (const std::string most = rows.text(10); !most.empty())
    one.most = role_from(most).value_or(Role::Viewer);
  return one;
}

// The principal of a session, with the role that its root has now. Nothing if the session or its
// root has ended.
std::optional<Principal> Tokens::principal_of(const Session& session) {
  const TimeMs now = store_.now();
  const TimeMs end = std::min(session.expires, session.ends);
  if (end <= now) return std::nullopt;
  const auto at_most = [&](Role role) {
    return session.most ? std::min(role, *session.most) : role;
  };
  Principal owner{.name = session.principal, .credential = session.id, .left_ms = end - now};
  if (session.user) {
    // On another machine the same user number belongs to another person.
    if (!is_of_this_machine(session.principal)) return std::nullopt;
    const std::optional<Role> role = role_of(*session.user, options_.users, ::getuid());
    if (!role) return std::nullopt;
    owner.role = at_most(*role);
    return owner;
  }
  const std::optional<Principal> root = token_owner(session.token, now);
  if (!root) return std::nullopt;
  owner.role = at_most(root->role);
  if (root->left_ms) owner.left_ms = std::min(*owner.left_ms, *root->left_ms);
  return owner;
}

bool Tokens::is_of_this_machine(const std::string& principal) const {
  return !store_.in_fleet() || principal.ends_with("@" + store_.node().name);
}

std::optional<Principal> Tokens::authenticate_session(const std::string& id,
                                                      std::string_view secret) {
  std::optional<Session> found = session(id);
  if (!found || !equal_in_constant_time(found->secret, sha256_hex(secret))) return std::nullopt;
  std::optional<Principal> owner = principal_of(*found);
  if (!owner) return std::nullopt;
  const TimeMs later = std::min(store_.now() + options_.session_ms, found->ends);
  if (found->expires + kExtendMs > later) return owner;
  // If this cannot be written, the session only ends earlier.
  const Answer<void> extended = store_.change([&]() -> Answer<void> {
    store_.db().run("UPDATE session SET expires=? WHERE id=?", later, id);
    return {};
  });
  if (!extended) return owner;
  found->expires = later;
  return principal_of(*found);
}

std::optional<Principal> Tokens::authenticate(std::string_view bearer) {
  const std::optional<TokenParts> parts = parts_of(bearer);
  if (!parts || !is_ulid(parts->id)) return std::nullopt;
  try {
    std::optional<Principal> owner = authenticate_token(parts->id, parts->secret);
    if (!owner) owner = authenticate_session(std::string(parts->id), parts->secret);
    if (store_.in_fleet()) {
      if (!owner)
        known_.erase(std::string(parts->id));
      else if (known_.size() < kMostKnown || known_.contains(parts->id))
        known_[std::string(parts->id)] = {sha256_hex(parts->secret), *owner, store_.monotonic()};
    }
    return owner;
  } catch (const StoreFault& fault) {
    store_.handle_fault(fault);
    if (!store_.in_fleet()) return std::nullopt;
    // A person at a cutter must be able to stop it. All other requests need the database anyway.
    if (std::optional<Principal> owner = known(parts->id, parts->secret)) return owner;
    // The token may be valid, so do not refuse it: the caller answers 503.
    throw;
  }
}

std::optional<Principal> Tokens::known(std::string_view id, std::string_view secret) const {
  const auto found = known_.find(id);
  if (found == known_.end()) return std::nullopt;
  const Known& one = found->second;
  const std::int64_t since_ms = store_.monotonic() - one.at_ms;
  if (since_ms > std::min(kKnown_ms, one.principal.left_ms.value_or(kKnown_ms)) ||
      !equal_in_constant_time(one.secret_sha256, sha256_hex(secret)))
    return std::nullopt;
  return one.principal;
}

void Tokens::forget_known() {
  known_.clear();
  for (const auto& listener : listeners_) listener();
}

void Tokens::notify_access_change() {
  if (store_.in_fleet()) (void)store_.db().number("SELECT pg_notify('popcut', ?)", kAccessChanged);
  store_.after_commit([this] { forget_known(); });
}

Answer<void> Tokens::check_name(const std::string& name) {
  if (!name.empty() && code_points(name) <= kNameLimit.characters) return {};
  return refuse_value("/name", "range",
                      fmt::format("must have 1 to {} characters", kNameLimit.characters),
                      "the name is not valid");
}

Answer<NewToken> Tokens::create_token(const Principal& who, const std::string& name, Role role,
                                      std::optional<int> lifetime_s) {
  if (who.role < Role::Admin)
    return refuse(ProblemKind::Forbidden, "only an admin may create tokens");
  if (auto fine = check_name(name); !fine) return tl::unexpected(std::move(fine.error()));
  if (lifetime_s && (*lifetime_s < 1 || *lifetime_s > kMostTokenLifetime_s))
    return refuse_value("/lifetime_s", "range", fmt::format("must be 1..{}", kMostTokenLifetime_s),
                        "the lifetime is not valid");
  return store_.change([&]() -> Answer<NewToken> {
    std::optional<TimeMs> expires;
    if (lifetime_s) expires = store_.now() + std::int64_t{*lifetime_s} * 1000;
    NewToken token{.record = {.id = store_.new_id(),
                              .name = name,
                              .role = role,
                              .created = store_.now(),
                              .expires = expires},
                   .text = {}};
    const Secret secret = new_secret(token.record.id);
    token.text = secret.text;
    store_.db().insert("token(id, kind, name, role, principal, secret_sha256, created, expires)",
                       token.record.id, "token", name, name_of(role), "token:" + token.record.id,
                       secret.sha256, token.record.created, expires);
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
    // Its sessions go with it.
    store_.db().run("DELETE FROM token WHERE id=?", id);
    store_.audit(who.name, "delete-token", id, "");
    notify_access_change();
    return {};
  });
}

std::vector<SessionRecord> Tokens::sessions(const Principal& who) {
  const std::vector<std::string> ids =
      who.role == Role::Admin
          ? all_of(store_.db().rows("SELECT id FROM session ORDER BY id"), first_text)
          : all_of(
                store_.db().rows("SELECT id FROM session WHERE principal=? ORDER BY id", who.name),
                first_text);
  std::vector<SessionRecord> all;
  for (const std::string& id : ids) {
    const std::optional<Session> one = session(id);
    std::optional<SessionRecord> record = one ? record_of(*one) : std::nullopt;
    if (record) all.push_back(std::move(*record));
  }
  return all;
}

// Nothing if the session has ended.
std::optional<SessionRecord> Tokens::record_of(const Session& session) {
  const std::optional<Principal> owner = principal_of(session);
  if (!owner) return std::nullopt;
  return SessionRecord{.id = session.id,
                       .root = session.principal,
                       .via = session.via,
                       .role = owner->role,
                       .created = session.created,
                       .expires = store_.now() + owner->left_ms.value_or(0),
                       .ends = session.ends,
                       .name = session.name};
}

std::optional<SessionRecord> Tokens::session_of(const std::string& credential) {
  const std::optional<Session> one = credential.empty() ? std::nullopt : session(credential);
  return one ? record_of(*one) : std::nullopt;
}

Answer<void> Tokens::end_session(const Principal& who, const std::string& id) {
  return store_.change([&]() -> Answer<void> {
    const std::optional<Session> found = session(id);
    // Do not tell whether the session of someone else exists.
    if (!found || (who.role < Role::Admin && found->principal != who.name))
      return refuse(ProblemKind::NotFound, "there is no session " + id + " of yours");
    store_.db().run("DELETE FROM session WHERE id=?", id);
    store_.audit(who.name, "end-session", id, found->principal);
    notify_access_change();
    return {};
  });
}

Answer<void> Tokens::close_session(const Principal& who) {
  if (who.credential.empty())
    return refuse(ProblemKind::NotFound,
                  "this connection has no session to end; its user identifies it");
  const Answer<bool> is_session =
      store_.read([&]() -> Answer<bool> { return session(who.credential).has_value(); });
  if (!is_session) return tl::unexpected(is_session.error());
  return *is_session ? end_session(who, who.credential) : delete_token(who, who.credential);
}

void Tokens::users_changed() {
  (void)store_.change([&]() -> Answer<void> {
    const auto of_users =
        all_of(store_.db().rows("SELECT id FROM session WHERE uid IS NOT NULL"), first_text);
    for (const std::string& id : of_users) {
      const std::optional<Session> one = session(id);
      if (one && one->user && is_of_this_machine(one->principal) &&
          !role_of(*one->user, options_.users, ::getuid()))
        store_.db().run("DELETE FROM session WHERE id=?", id);
    }
    return {};
  });
  forget_known();
}

// A session for `who` that is not stored and has no secret yet. Nothing if its root has ended.
std::optional<Tokens::Session> Tokens::new_session(const Principal& who) {
  const TimeMs now = store_.now();
  Session fresh{
      .id = {}, .principal = who.name, .created = now, .ends = now + options_.longest_session_ms};
  if (who.credential.empty()) {
    if (!who.user || !role_of(*who.user, options_.users, ::getuid())) return std::nullopt;
    fresh.user = who.user;
  } else if (const auto owner = token_owner(who.credential, now)) {
    fresh.token = who.credential;
    if (owner->left_ms) fresh.ends = std::min(fresh.ends, now + *owner->left_ms);
  } else {
    const std::optional<Session> parent = session(who.credential);
    if (!parent || !principal_of(*parent)) return std::nullopt;
    fresh.token = parent->token;
    fresh.user = parent->user;
    fresh.via = parent->id;
    fresh.most = parent->most;
    fresh.ends = std::min(fresh.ends, parent->ends);
  }
  fresh.expires = std::min(now + options_.session_ms, fresh.ends);
  return fresh;
}

// A principal with too many codes loses its oldest one. If all principals together have too many,
// the one with the most loses its oldest.
void Tokens::make_room_for_one_shot(const std::string& principal) {
  std::map<std::string, std::size_t> counts;
  for (const auto& [digest, word] : one_shots_) ++counts[word.principal.name];
  std::string whose;
  if (counts[principal] >= kOneShotsOfOne)
    whose = principal;
  else if (one_shots_.size() >= kMostOneShots)
    whose = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
              return a.second < b.second;
            })->first;
  else
    return;
  auto oldest = one_shots_.end();
  for (auto word = one_shots_.begin(); word != one_shots_.end(); ++word)
    if (word->second.principal.name == whose &&
        (oldest == one_shots_.end() || word->second.until_ms < oldest->second.until_ms))
      oldest = word;
  if (oldest != one_shots_.end()) one_shots_.erase(oldest);
}

Answer<std::string> Tokens::create_one_shot(const Principal& who) {
  tidy();
  make_room_for_one_shot(who.name);
  const std::string word = base64url(random_bytes(32));
  one_shots_[sha256_hex(word)] = {who, store_.monotonic() + kOneShotMs};
  return word;
}

// Does not delete `via` and the sessions from which `via` comes, because the new session would be
// deleted with them.
Answer<void> Tokens::make_room_for_session(const std::string& principal, const std::string& via) {
  Database& db = store_.db();
  const std::int64_t held = db.number("SELECT count(*) FROM session WHERE principal=?", principal);
  if (held < kSessionsOfOne) return {};
  const int gone = db.run(
      "WITH RECURSIVE kept(id) AS (SELECT id FROM session WHERE id=?1 UNION SELECT session.via "
      "FROM session JOIN kept ON kept.id=session.id WHERE session.via IS NOT NULL) DELETE FROM "
      "session WHERE id IN (SELECT id FROM session WHERE principal=?2 AND id NOT IN (SELECT id "
      "FROM kept) ORDER BY expires LIMIT ?3)",
      via, principal, held - kSessionsOfOne + 1);
  if (gone == 0)
    return refuse(
        ProblemKind::QueueFull,
        fmt::format("you have {} sessions, each opened from another one; end one of them first",
                    held));
  notify_access_change();
  return {};
}

Answer<NewToken> Tokens::open_session(const std::string& one_shot) {
  const auto found = one_shots_.find(sha256_hex(one_shot));
  if (found == one_shots_.end() || found->second.until_ms <= store_.monotonic())
    return refuse(
        ProblemKind::Unauthenticated,
        "this address was used already or is older than a minute; run 'popcut open' for a new one");
  const Principal who = found->second.principal;
  Answer<std::optional<NewToken>> made =
      store_.change([&] { return begin_session(who, "", std::nullopt); });
  if (!made) return tl::unexpected(made.error());  // the page can try again
  one_shots_.erase(sha256_hex(one_shot));
  if (*made) return std::move(**made);
  return refuse(ProblemKind::Unauthenticated,
                "the user, token or session that this address came from has ended");
}

Answer<std::optional<NewToken>> Tokens::begin_session(const Principal& who, const std::string& name,
                                                      std::optional<Role> most) {
  std::optional<Session> fresh = new_session(who);
  if (!fresh) return std::nullopt;
  fresh->id = store_.new_id();
  fresh->name = name;
  if (most) fresh->most = fresh->most ? std::min(*fresh->most, *most) : *most;
  const std::optional<Principal> owner = principal_of(*fresh);
  if (!owner) return std::nullopt;
  if (auto room = make_room_for_session(who.name, fresh->via); !room)
    return tl::unexpected(std::move(room.error()));
  const Secret secret = new_secret(fresh->id);
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? Bound(nullptr) : Bound(text);
  };
  std::optional<std::int64_t> uid;
  if (fresh->user) uid = fresh->user->uid;
  const std::string groups = fresh->user ? text_of(fresh->user->groups) : std::string();
  store_.db().insert(
      "session(id, token, uid, groups, via, principal, secret_sha256, created, "
      "expires, ends, name, most)",
      fresh->id, text_or_null(fresh->token), uid, groups, text_or_null(fresh->via),
      fresh->principal, secret.sha256, fresh->created, fresh->expires, fresh->ends, fresh->name,
      fresh->most ? name_of(*fresh->most) : std::string_view());
  store_.audit(who.name, name.empty() ? "open-session" : "pair", fresh->id,
               name.empty() ? fresh->via : fmt::format("{} {}", name_of(owner->role), name));
  return NewToken{.record = {.id = fresh->id,
                             .name = name.empty() ? "page" : name,
                             .role = owner->role,
                             .created = fresh->created,
                             .expires = fresh->expires},
                  .text = secret.text};
}

void Tokens::tidy() {
  const std::int64_t now = store_.monotonic();
  std::erase_if(known_, [&](const auto& one) { return now - one.second.at_ms > kKnown_ms; });
  std::erase_if(one_shots_, [&](const auto& one) { return one.second.until_ms <= now; });
  forget_late_pairings();
}

}  // namespace popcut::daemon
