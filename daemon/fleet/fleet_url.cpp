// SPDX-License-Identifier: MIT
#include "daemon/fleet/fleet_url.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

std::string decoded(std::string_view text) {
  std::string plain;
  for (std::size_t at = 0; at < text.size(); ++at) {
    int byte = 0;
    if (text[at] == '%' && at + 2 < text.size() &&
        std::from_chars(text.data() + at + 1, text.data() + at + 3, byte, 16).ptr ==
            text.data() + at + 3) {
      plain += static_cast<char>(byte);
      at += 2;
    } else {
      plain += text[at];
    }
  }
  return plain;
}

std::string encoded(std::string_view text, std::string_view also = "") {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~";
  std::string all;
  for (const char c : text)
    all += kPlain.find(c) != std::string_view::npos || also.find(c) != std::string_view::npos
               ? std::string(1, c)
               : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return all;
}

// Up to `end`, which is taken too; all if it is not there.
std::string_view cut(std::string_view& text, std::string_view ends) {
  const std::size_t at = std::min(text.find_first_of(ends), text.size());
  const std::string_view first = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return first;
}

void put(FleetUrl& url, const std::string& key, std::string value, std::string& port) {
  if (key == "user")
    url.user = std::move(value);
  else if (key == "password")
    url.password = std::move(value);
  else if (key == "dbname")
    url.database = std::move(value);
  else if (key == "port")
    port = std::move(value);
  else
    url.more.emplace_back(key, std::move(value));
}

FleetUrl parse_url(std::string_view text) {
  FleetUrl url;
  text.remove_prefix(text.find("//") + 2);
  std::string_view rest = text;
  std::string_view place = cut(rest, "/?");
  const bool has_path = place.size() < text.size() && text[place.size()] == '/';
  if (const std::size_t at = place.rfind('@'); at != std::string_view::npos) {
    std::string_view who = place.substr(0, at);
    url.user = decoded(cut(who, ":"));
    url.password = decoded(who);
    place.remove_prefix(at + 1);
  }
  url.hosts = place;
  if (has_path) url.database = decoded(cut(rest, "?"));
  std::string port;
  while (!rest.empty()) {
    std::string_view pair = cut(rest, "&");
    const std::string key = decoded(cut(pair, "="));
    put(url, key, decoded(pair), port);
  }
  if (!port.empty()) url.more.emplace_back("port", port);
  return url;
}

FleetUrl parse_words(std::string_view text) {
  FleetUrl url;
  std::string port;
  for (std::size_t at = 0; at < text.size();) {
    at = text.find_first_not_of(" \t\n", at);
    if (at == std::string_view::npos) break;
    const std::size_t equals = std::min(text.find('=', at), text.size());
    std::string key(text.substr(at, equals - at)), value;
    key.erase(key.find_last_not_of(' ') + 1);
    at = std::min(text.find_first_not_of(' ', equals + 1), text.size());
    const bool quoted = at < text.size() && text[at] == '\'';
    for (at += quoted ? 1 : 0; at < text.size(); ++at) {
      if (quoted ? text[at] == '\'' : text[at] == ' ') break;
      if (text[at] == '\\' && at + 1 < text.size()) ++at;
      value += text[at];
    }
    ++at;
    put(url, key, std::move(value), port);
  }
  if (!port.empty()) url.more.emplace_back("port", port);
  return url;
}

}  // namespace

FleetUrl FleetUrl::parse(std::string_view text) {
  return text.starts_with("postgresql://") || text.starts_with("postgres://") ? parse_url(text)
                                                                              : parse_words(text);
}

std::string FleetUrl::text() const {
  std::string all = "postgresql://";
  if (!user.empty() || !password.empty()) {
    all += encoded(user);
    if (!password.empty()) all += ":" + encoded(password);
    all += "@";
  }
  all += hosts + "/" + encoded(database);
  for (std::size_t i = 0; i < more.size(); ++i)
    all +=
        fmt::format("{}{}={}", i == 0 ? '?' : '&', more[i].first, encoded(more[i].second, "/:,"));
  return all;
}

std::string FleetUrl::shown() const {
  FleetUrl safe = *this;
  safe.password.clear();
  std::erase_if(safe.more, [](const auto& one) { return one.first == "sslpassword"; });
  return safe.text();
}

std::string FleetUrl::value(std::string_view key) const {
  for (const auto& [name, value] : more)
    if (name == key) return value;
  return {};
}

// Lists are those of the URL's place, or of `host`, `hostaddr` and `port`; one port is that of all
// hosts. What libpq would not accept is left to it as it is.
std::vector<FleetUrl> FleetUrl::each_host() const {
  const auto parts = [](std::string_view list) {
    std::vector<std::string> all;
    do all.emplace_back(cut(list, ","));
    while (!list.empty());
    return all;
  };
  constexpr std::array<std::string_view, 3> kLists{"host", "hostaddr", "port"};
  std::size_t count = hosts.empty() ? 1 : parts(hosts).size();
  for (const std::string_view key : kLists)
    if (hosts.empty() || key == "hostaddr") count = std::max(count, parts(value(key)).size());
  std::vector<FleetUrl> each(count, *this);
  if (count == 1) return each;
  const std::vector<std::string> places = parts(hosts);
  if (!hosts.empty() && places.size() != count) return {*this};
  for (std::size_t i = 0; i < count; ++i) {
    if (!hosts.empty()) each[i].hosts = places[i];
    for (auto& [key, list] : each[i].more) {
      if (std::find(kLists.begin(), kLists.end(), key) == kLists.end()) continue;
      const std::vector<std::string> values = parts(list);
      if (values.size() != 1 && values.size() != count) return {*this};
      list = values.size() == 1 ? values[0] : values[i];
    }
  }
  return each;
}

bool FleetUrl::is_remote() const {
  std::string named = hosts.empty() ? value("host") : hosts;
  if (named.empty()) named = value("hostaddr");
  std::string_view rest = named;
  while (!rest.empty()) {
    std::string_view one = cut(rest, ",");
    one = one.substr(0, one.starts_with('[') ? one.find(']') + 1 : one.find(':'));
    const bool local = one.empty() || one.starts_with('/') || one.starts_with("%2F") ||
                       one.starts_with("%2f") || one.starts_with('@') || one == "localhost" ||
                       one == "127.0.0.1" || one == "[::1]" || one == "::1";
    if (!local) return true;
  }
  return false;
}

}  // namespace popcut::daemon
