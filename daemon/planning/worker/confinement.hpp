// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "daemon/model/model.hpp"

namespace popcut::planning {

using daemon::WorkerWall;

/// Takes from this process, for good, all that a worker does not need: it can compute, take memory,
/// read descriptor 0, write descriptors 1 and 2, and end. Each wall holds without the others:
///
/// - "seccomp": every system call that is not on a list fails with EPERM (`man 2 seccomp`)
/// - "landlock": no file can be opened, made, moved or removed (`man 7 landlock`); as the kernel
///   lets, no TCP port, no signal and no abstract socket outside of this process either
///
/// It must have one thread. What cannot be had is left out, and the answer says why.
///
/// @param list_calls  false: without seccomp, for the tests of the other wall
[[nodiscard]] std::vector<WorkerWall> confine_worker(bool list_calls = true);

/// What a trial worker of `program` says of its walls; the third is "namespaces" (of users,
/// processes and System V IPC), in which it was started. Takes a few milliseconds; blocks.
///
/// @retval Internal  it cannot be started, or did not answer
[[nodiscard]] Result<std::vector<WorkerWall>> try_confinement(const std::string& program);

/// One line for the log: "workers are confined by: seccomp, landlock; not by: namespaces (...)".
[[nodiscard]] std::string confinement_text(const std::vector<WorkerWall>& walls);

/// A line for each wall, and back.
[[nodiscard]] std::string walls_text(const std::vector<WorkerWall>& walls);
[[nodiscard]] std::vector<WorkerWall> read_walls(std::string_view text);

}  // namespace popcut::planning
