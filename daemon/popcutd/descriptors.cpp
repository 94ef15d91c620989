// SPDX-License-Identifier: MIT
#include "daemon/popcutd/descriptors.hpp"

#include <sys/resource.h>

#include <algorithm>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

constexpr rlim_t kOwn = 24;  // what is open while nobody asks for anything

}  // namespace

std::string allow_descriptors(const HttpLimits& limits) {
  const auto places = static_cast<rlim_t>(limits.connections + limits.reserved_connections);
  const rlim_t besides = kOwn + kDescriptorsLeft;
  rlimit now{};
  if (::getrlimit(RLIMIT_NOFILE, &now) != 0 || now.rlim_cur >= places + besides) return "";
  now.rlim_cur = std::min(now.rlim_max, places + besides);
  (void)::setrlimit(RLIMIT_NOFILE, &now);
  if (now.rlim_cur >= places + besides) return "";
  return fmt::format(
      "this process may open {} files, which is enough for about {} clients, not for "
      "limits.connections = {}; raise the limit to {} (LimitNOFILE in the unit, or ulimit -n)",
      now.rlim_cur, now.rlim_cur > besides ? now.rlim_cur - besides : 0, limits.connections,
      places + besides);
}

}  // namespace popcut::daemon
