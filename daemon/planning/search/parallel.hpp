// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace popcut::planning {

/// Calls `work(thread, index)` for each index below `count`, on `threads` threads at once, and
/// returns when all are done or `stopped` says so: then indices that were not begun are left out.
/// Which thread takes which index is not fixed, so `work` must give the same whoever does it. One
/// thread is the caller's own.
inline void for_each_index(std::size_t count, unsigned threads,
                           const std::function<bool()>& stopped,
                           const std::function<void(std::size_t thread, std::size_t index)>& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&](std::size_t thread) {
    for (;;) {
      if (stopped && stopped()) return;
      const std::size_t index = next.fetch_add(1);
      if (index >= count) return;
      work(thread, index);
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t thread = 1; thread < threads && thread < count; ++thread)
    others.emplace_back(run, thread);
  run(0);
}

}  // namespace popcut::planning
