// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace popcut::testing {

/// What becomes of the call of a child that is chosen.
enum class CallFate {
  Dies,     ///< the process is killed before it, with all threads
  NoRoom,   ///< it fails with ENOSPC
  BadDisk,  ///< it fails with EIO
};

/// How a child ended.
struct ChildEnd {
  bool chosen{false};  ///< it came to the chosen call; else it has fewer, and ended by itself
  int code{-1};        ///< its exit code; 128 + signal
  /// Its calls in their order, by name ("rename"), up to the chosen one.
  std::vector<std::string> calls;
};

/// Whether processes may be traced here, and calls be made to fail on this processor.
[[nodiscard]] bool can_trace();

/// Runs `work` in a child process (a fork: this one must have no other threads) and lets `fate`
/// befall its `number`th call (from 1; 0: none) that changes something in the file system, counted
/// from `count_calls_from_here` on, over all of its threads. The exit code is what `work` returns.
[[nodiscard]] ChildEnd run_with_fate(int number, CallFate fate, const std::function<int()>& work);

/// In the child: calls are counted from here on.
void count_calls_from_here();

}  // namespace popcut::testing
