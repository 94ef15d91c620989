// SPDX-License-Identifier: MIT
#pragma once

namespace popcut::planning {

/// What `popcutd --worker` does: reads one task from the pipe `in` (frames, see frames.hpp), does
/// it, and writes files and figures, or one error, to the pipe `out`. It opens no file and no
/// socket; on standard input and output it first gives up the right to.
///
/// @return the exit code: 0 if an outcome or an error was written; 3 if the task could not be read
///         or nothing could be written
[[nodiscard]] int run_worker(int in, int out);

}  // namespace popcut::planning
