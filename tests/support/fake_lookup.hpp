// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include <fmt/format.h>

#include "daemon/service/service.hpp"

/// What both sources of FakeService use.
namespace popcut::daemon::fake {

constexpr TimeMs kNow = 1'795'255'200'123;  // 2026-11-21T10:00:00.123Z

inline std::string id_of(int number) { return fmt::format("01JD0000000000000000{:06}", number); }

inline tl::unexpected<Problem> nothing(const std::string& what) {
  return refuse(ProblemKind::NotFound, what);
}

template <typename Map>
auto lookup(const Map& map, const std::string& id, const char* what)
    -> Answer<typename Map::mapped_type> {
  const auto found = map.find(id);
  if (found == map.end()) return nothing(fmt::format("there is no {} {}", what, id));
  return found->second;
}

}  // namespace popcut::daemon::fake
