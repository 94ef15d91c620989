// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/http/routes.hpp"
#include "daemon/http/target.hpp"

using namespace popcut::daemon;

// No part of a path that is let in has a slash, a control character or dots alone in it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto target = http::read_target(text);
  if (!target) {
    if (target.error().detail.empty()) std::abort();
    return 0;
  }
  for (const std::string& segment : target->segments) {
    if (segment.find_first_of(std::string_view("/\\\0\r\n", 5)) != std::string::npos) std::abort();
    if (segment == "." || segment == ".." || !http::is_utf8(segment)) std::abort();
  }
  for (const auto& [name, value] : target->query)
    if (name.empty() || value.find('\0') != std::string::npos) std::abort();
  const http::Match match = http::find_route(http::Method::Get, target->segments);
  if (match.route != nullptr && match.allowed.empty()) std::abort();
  return 0;
}
