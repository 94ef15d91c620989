// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut::planning {

/// What `popcutd --worker` does: reads one task from the pipe `in` (frames, see frames.hpp), does
/// it, and writes files and figures, or one error, to the pipe `out`. On standard input and output
/// it first gives up the right to do anything else (see `confine_worker`). With the word "tell" it
/// then only writes which walls hold it, see `walls_text`. With the word "serve" it does one task
/// after another until its input ends. Only with the word "pdf" can it read a PDF.
///
/// @return the exit code: 0 if an outcome or an error was written; 3 if the task could not be read
///         or nothing could be written
[[nodiscard]] int run_worker(int in, int out, std::string_view word = "");

}  // namespace popcut::planning
