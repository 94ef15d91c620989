// SPDX-License-Identifier: MIT
#include "daemon/client/address.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace popcut::client {
namespace {

/// A name or numbers, or what stands between the brackets of an IPv6 address.
bool is_host(std::string_view host, bool six) {
  const auto fits = [&](char c) {
    const bool alike = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       c == '.' || c == '-' || c == '_';
    return alike || (six && (c == ':' || c == '%'));
  };
  return std::all_of(host.begin(), host.end(), fits);
}

Result<Address> parse_http(std::string_view text, std::string_view rest) {
  const auto wrong = [&](const char* why) {
    return fail(
        ErrorKind::Usage, "POPCUT_URL",
        fmt::format(
            "\"{}\" {}; give an address such as http://127.0.0.1:8631 or unix:/run/popcut.sock",
            text, why));
  };
  if (!rest.empty() && rest.back() == '/') rest.remove_suffix(1);
  if (rest.find_first_of("/?#@ ") != std::string_view::npos)
    return wrong("has more than a host and a port");
  Address address{{}, {}, 8631};
  const std::size_t colon = rest.rfind(':');
  const std::size_t bracket = rest.rfind(']');
  const bool has_port =
      colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
  std::string_view host = rest.substr(0, has_port ? colon : rest.size());
  if (has_port && !(bracket == std::string_view::npos && rest.front() == '[')) {
    const std::string_view port = rest.substr(colon + 1);
    const auto [end, bad] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (bad != std::errc() || end != port.data() + port.size() || address.port == 0)
      return wrong("has an invalid port");
  }
  const bool six = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (six) host = host.substr(1, host.size() - 2);
  if (host.empty()) return wrong("has no host");
  if (!is_host(host, six))
    return wrong(host.find_first_of("[]:") != std::string_view::npos
                     ? "has an invalid host; write an IPv6 address between [ and ]"
                     : "has an invalid host; use letters, digits, dots and dashes");
  address.host = host;
  return address;
}

}  // namespace

std::string Address::text() const { return path.empty() ? "http://" + host_header() : path; }

std::string Address::host_header() const {
  if (!path.empty()) return "localhost";
  const bool six = host.find(':') != std::string::npos;
  return fmt::format("{}{}{}:{}", six ? "[" : "", host, six ? "]" : "", port);
}

Result<Address> parse_address(std::string_view text) {
  constexpr std::string_view kHttp = "http://", kUnix = "unix:";
  if (text.substr(0, kHttp.size()) == kHttp) return parse_http(text, text.substr(kHttp.size()));
  if (text.substr(0, kUnix.size()) == kUnix) text.remove_prefix(kUnix.size());
  constexpr std::size_t kLongestPath = 107;  // sun_path
  if (!text.empty() && text.front() == '/' && text.size() <= kLongestPath)
    return Address{std::string(text), {}, 0};
  if (text.size() > kLongestPath)
    return fail(
        ErrorKind::Usage, "POPCUT_URL",
        fmt::format("is longer than the {} characters that a socket path may have", kLongestPath));
  return fail(
      ErrorKind::Usage, "POPCUT_URL",
      fmt::format(
          "is \"{}\"; give an address such as http://127.0.0.1:8631 or unix:/run/popcut.sock{}",
          text,
          text.substr(0, 8) == "https://"
              ? " (popcut has no TLS; use ssh or a proxy on this computer)"
              : ""));
}

Result<std::string> bearer_token(const Environment& environment) {
  const char* const token = environment("POPCUT_TOKEN");
  if (token == nullptr) return std::string();
  std::string text = token;
  const bool valid =
      std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < '\x7f'; });
  if (valid) return text;
  return fail(
      ErrorKind::Usage, "POPCUT_TOKEN",
      "contains a character that no token has; copy it exactly as 'popcut token create' printed "
      "it");
}

std::string user_state_folder(const Environment& environment) {
  const char* const state = environment("XDG_STATE_HOME");
  const char* const home = environment("HOME");
  if (state != nullptr && *state == '/') return std::string(state) + "/popcut";
  if (home != nullptr && *home == '/') return std::string(home) + "/.local/state/popcut";
  return {};
}

std::vector<std::string> configuration_files(const Environment& environment) {
  const auto folder = [&](const char* name) -> std::string {
    const char* const value = environment(name);
    if (value == nullptr || *value != '/') return {};
    const std::string text = value;
    return text.substr(0, text.find(':'));  // systemd separates several with colons
  };
  const std::string service = folder("CONFIGURATION_DIRECTORY"), user = folder("XDG_CONFIG_HOME"),
                    home = folder("HOME");
  if (!service.empty()) return {service + "/popcutd.toml"};
  std::vector<std::string> files;
  if (!user.empty() || !home.empty())
    files.push_back((user.empty() ? home + "/.config" : user) + "/popcut/popcutd.toml");
  files.emplace_back("/etc/popcut/popcutd.toml");
  return files;
}

Result<std::vector<Address>> addresses(const Environment& environment) {
  if (const char* const url = environment("POPCUT_URL"); url != nullptr && *url != '\0') {
    auto one = parse_address(url);
    if (!one) return tl::unexpected(one.error());
    return std::vector<Address>{std::move(*one)};
  }
  if (const char* const token = environment("POPCUT_TOKEN"); token != nullptr && *token != '\0')
    return std::vector<Address>{{{}, "127.0.0.1", 8631}, {{}, "::1", 8631}};
  std::vector<Address> found;
  const char* const run = environment("XDG_RUNTIME_DIR");
  if (run != nullptr && *run == '/') found.push_back({std::string(run) + "/popcut.sock", {}, 0});
  if (const std::string state = user_state_folder(environment); !state.empty())
    found.push_back({state + "/popcut.sock", {}, 0});
  found.push_back({"/run/popcut.sock", {}, 0});
  return found;
}

}  // namespace popcut::client
