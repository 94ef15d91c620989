// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "daemon/model/limits.hpp"

namespace popcut::daemon {

/// Raises the limit of this process on file descriptors to what its clients and its own work take,
/// as far as it may.
///
/// @return what an administrator should know if that is not enough for `connections`; else nothing
[[nodiscard]] std::string allow_descriptors(const HttpLimits& limits);

}  // namespace popcut::daemon
