// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut::cli {

/// A popcutd that was started here and goes on after this program ends.
struct StartedPopcutd {
  int pid{-1};
  std::string log;          ///< where it writes what it has to say
  std::int64_t log_from{};  ///< bytes that were in it before
};

/// Starts popcutd in the background, in a session of its own, with `arguments`: the one that lies
/// beside this program, else the one in PATH. Its log is
/// `popcutd.log` in the user's state folder; one of more than 1 MB is emptied first.
///
/// @retval Unwritable  there is no folder for the log, or it cannot be written
/// @retval Refused     there is no popcutd to be found
[[nodiscard]] Result<StartedPopcutd> start_popcutd(const std::vector<std::string>& arguments = {});

/// Whether it still runs; to be asked by the one who started it.
[[nodiscard]] bool is_running(const StartedPopcutd& started);

/// The last line of its log that tells of an error, else the last one; empty: it said nothing.
[[nodiscard]] std::string last_words(const StartedPopcutd& started);

/// Runs a program in a session of its own, without terminal and output, and waits for it at most
/// `seconds`: false if it is not there or ends with an error in that time.
[[nodiscard]] bool run_apart(const std::vector<std::string>& words, double seconds);

}  // namespace popcut::cli
