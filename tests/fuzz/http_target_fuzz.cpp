// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/text/utf8.hpp"
#include "daemon/http/api/routes.hpp"
#include "daemon/http/api/target.hpp"

using namespace popcut::daemon;

// No part of a path that is let in has a slash, a control character or dots alone in it; the id of
// a device may have slashes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto target = http::read_target(text);
  if (!target) {
    if (target.error().detail.empty()) std::abort();
    return 0;
  }
  const auto& parts = target->segments;
  const bool is_device = parts.size() > 2 && parts[0] == "v1" && parts[1] == "devices";
  for (const std::string& segment : parts) {
    if (segment.find_first_of(std::string_view("\\\0\r\n", 4)) != std::string::npos) std::abort();
    const bool may_have = is_device && &segment == &parts[2];
    if (!may_have && segment.find('/') != std::string::npos) std::abort();
    if (segment == "." || segment == ".." || !popcut::is_utf8(segment)) std::abort();
  }
  for (const auto& [name, value] : target->query)
    if (name.empty() || value.find('\0') != std::string::npos) std::abort();
  const http::Match match = http::find_route(http::Method::Get, target->segments);
  if (match.route != nullptr && match.allowed.empty()) std::abort();
  return 0;
}
