// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "daemon/model/limits.hpp"

namespace popcut::daemon {

/// Gives back memory that only the start needed: free blocks of the heap, and pages of programs and
/// libraries that can be read from their files again (the tables by which they were linked, and all
/// of those that only the workers use). What is used after all comes back page by page.
void give_back_start();

/// Raises the limit of this process on file descriptors to what its clients and its own work take,
/// as far as it may.
///
/// @return what an administrator should know if that is not enough for `connections`; else nothing
[[nodiscard]] std::string allow_descriptors(const HttpLimits& limits);

}  // namespace popcut::daemon
