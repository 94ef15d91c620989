// SPDX-License-Identifier: MIT
#include "daemon/service/principal_titles.hpp"

#include <pwd.h>

#include <charconv>
#include <vector>

namespace popcut::daemon {
namespace {

constexpr std::size_t kMostTitles = 10'000;
constexpr std::string_view kToken = "token:", kUser = "uid:";

std::string_view after(std::string_view prefix, std::string_view text) {
  return text.starts_with(prefix) ? text.substr(prefix.size()) : std::string_view();
}

}  // namespace

std::string login_name(uid_t user) {
  constexpr std::size_t kMostBytes = 64 << 10;
  passwd row{};
  passwd* found = nullptr;
  std::vector<char> text(1024);
  int error = ::getpwuid_r(user, &row, text.data(), text.size(), &found);
  while (error == ERANGE && text.size() < kMostBytes) {
    text.resize(text.size() * 4);
    error = ::getpwuid_r(user, &row, text.data(), text.size(), &found);
  }
  return error == 0 && found != nullptr ? found->pw_name : std::string();
}

std::string PrincipalTitles::of(const std::string& principal) {
  if (principal.empty()) return {};
  const auto at = known_.find(principal);
  if (at != known_.end()) return at->second;
  if (known_.size() >= kMostTitles) known_.clear();
  std::string title = look_up(principal);
  known_.emplace(principal, title);
  return title;
}

std::string PrincipalTitles::look_up(const std::string& principal) {
  if (const std::string_view id = after(kToken, principal); !id.empty()) {
    Rows rows = store_.db().rows("SELECT name FROM token WHERE id=?", id);
    if (rows.next() && !rows.text(0).empty()) return rows.text(0);
  }
  if (const std::string_view digits = after(kUser, principal); !digits.empty()) {
    uid_t user = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), user);
    // In a fleet: "uid:1000@room-1".
    const std::string_view at(end, digits.data() + digits.size());
    const std::string here = store_.in_fleet() ? "@" + store_.node().name : "";
    if (error == std::errc() && at == here)
      if (std::string name = options_.user_name(user); !name.empty()) return name;
  }
  return principal;
}

}  // namespace popcut::daemon
