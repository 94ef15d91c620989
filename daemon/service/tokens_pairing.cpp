// SPDX-License-Identifier: MIT
// Part of daemon/service/tokens.hpp: pairing. A tablet shows a code, a person who is signed in
// types it, and the tablet gets a session with that person's root.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "daemon/service/tokens.hpp"

namespace popcut::daemon {
namespace {

constexpr std::int64_t kPairingMs = 5 * 60'000;
constexpr std::size_t kMostPairings = 20;
constexpr std::size_t kCodeDigits = 6;
// Without letters and digits that look alike: 0 and O, 1, I and L.
constexpr std::string_view kCodeLetters = "ABCDEFGHJKMNPQRSTUVWXYZ23456789";

// People type a code in any case, with blanks or dashes in it.
std::string plain_code(std::string_view typed) {
  std::string code;
  for (const char c : typed) {
    if (c == ' ' || c == '-') continue;
    code += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return code;
}

}  // namespace

std::string Tokens::new_code() const {
  const auto is_taken = [&](const std::string& code) {
    return std::any_of(pairings_.begin(), pairings_.end(),
                       [&](const Pairing& one) { return one.code == code; });
  };
  // Skip greater bytes, so that all letters are equally likely.
  constexpr std::size_t kFair = 256 / kCodeLetters.size() * kCodeLetters.size();
  std::string code;
  while (code.size() < kCodeDigits || is_taken(code)) {
    if (code.size() == kCodeDigits) code.clear();
    const auto byte = static_cast<unsigned char>(random_bytes(1)[0]);
    if (byte < kFair) code += kCodeLetters[byte % kCodeLetters.size()];
  }
  return code;
}

void Tokens::forget_late_pairings() {
  const std::int64_t now = store_.monotonic();
  std::erase_if(pairings_, [&](const Pairing& one) { return one.until_ms <= now; });
}

// The address from which most tablets wait loses its oldest code. So an address that asks again and
// again keeps no other one out.
bool Tokens::make_room_for_pairing(const std::string& place) {
  if (pairings_.size() < kMostPairings) return true;
  std::map<std::string, int> waiting;
  for (const Pairing& one : pairings_)
    if (!one.allowed_by) ++waiting[one.place];
  std::string whose = place;
  for (const auto& [other, count] : waiting)
    if (count > std::max(1, waiting[whose])) whose = other;
  const auto oldest = std::find_if(pairings_.begin(), pairings_.end(), [&](const Pairing& one) {
    return !one.allowed_by && one.place == whose;
  });
  if (oldest == pairings_.end()) return false;
  pairings_.erase(oldest);
  return true;
}

Answer<NewPairing> Tokens::ask_pairing(const std::string& name, const std::string& place) {
  if (auto fine = check_name(name); !fine) return tl::unexpected(std::move(fine.error()));
  forget_late_pairings();
  if (!make_room_for_pairing(place)) {
    return refuse(
        ProblemKind::Unavailable,
        fmt::format("{} tablets are waiting for a person to type their code; try again in "
                    "a few minutes",
                    pairings_.size()),
        /*retry_after_s=*/60);
  }
  const std::string secret = base64url(random_bytes(32));
  Pairing one{.id = store_.new_id(),
              .code = new_code(),
              .secret_sha256 = sha256_hex(secret),
              .name = name,
              .place = place,
              .until_ms = store_.monotonic() + kPairingMs};
  pairings_.push_back(one);
  return NewPairing{one.id, one.code, secret, store_.now() + kPairingMs};
}

Answer<AllowedPairing> Tokens::allow_pairing(const Principal& who, const std::string& code,
                                             Role role) {
  if (role > who.role)
    return refuse(
        ProblemKind::Forbidden,
        fmt::format("you are {}; you cannot give a tablet a higher role", name_of(who.role)));
  forget_late_pairings();
  const std::string typed = plain_code(code);
  const auto found = std::find_if(pairings_.begin(), pairings_.end(), [&](const Pairing& one) {
    return !one.allowed_by && equal_in_constant_time(one.code, typed);
  });
  if (found == pairings_.end())
    return refuse(ProblemKind::NotFound,
                  "no tablet waits with this code; a code is valid once, for five minutes");
  found->allowed_by = who;
  found->role = role;
  found->until_ms = store_.monotonic() + kPairingMs;  // in which the tablet collects its session
  return AllowedPairing{found->name, role};
}

Answer<std::optional<NewToken>> Tokens::collect_pairing(const std::string& secret) {
  forget_late_pairings();
  const std::string digest = sha256_hex(secret);
  const auto found = std::find_if(pairings_.begin(), pairings_.end(), [&](const Pairing& one) {
    return equal_in_constant_time(one.secret_sha256, digest);
  });
  const auto gone = [] {
    return refuse(
        ProblemKind::NotFound,
        "this pairing has ended: it was not allowed in time, or has been used already; ask "
        "for a new code");
  };
  if (found == pairings_.end()) return gone();
  if (!found->allowed_by) return std::optional<NewToken>();
  const Pairing one = *found;
  Answer<std::optional<NewToken>> made =
      store_.change([&] { return begin_session(*one.allowed_by, one.name, one.role); });
  if (!made) return made;  // for example the disk is full; the tablet can try again
  std::erase_if(pairings_, [&](const Pairing& other) { return other.id == one.id; });
  if (!*made) return gone();
  return made;
}

}  // namespace popcut::daemon
