// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "daemon/model/limits.hpp"
#include "daemon/planning/worker_memory.hpp"

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

/// What all workers may have together: `bytes`, or if that is 0 what the control group of popcutd
/// and this computer have, less a part for popcutd. If systemd delegates the control group
/// (`Delegate=memory`), the workers get one of their own below it with this limit, so that the
/// kernel neither slows down popcutd for them nor takes one of its pages.
[[nodiscard]] std::shared_ptr<planning::WorkerMemory> memory_for_workers(std::uint64_t bytes);
/// The same for the control group in `folder`; "": there is none.
[[nodiscard]] std::shared_ptr<planning::WorkerMemory> memory_for_workers(std::uint64_t bytes,
                                                                         const std::string& folder);

}  // namespace popcut::daemon
