// SPDX-License-Identifier: MIT
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <thread>
#include <vector>

namespace popcut::testing {

[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point begun) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

/// Whether promises of seconds are judged to the second: only in './run soak times', where nothing
/// else keeps the machine busy.
[[nodiscard]] inline bool judges_time() { return std::getenv("POPCUT_JUDGE_TIME") != nullptr; }

/// True if less than the promised time has passed since `begun`. In the suite other tests run
/// beside this one, so there the deadline is ten minutes, which only what hangs misses. A case that
/// uses it has the tag [seconds].
[[nodiscard]] inline bool in_time(std::chrono::steady_clock::time_point begun, double promised_s) {
  return seconds_since(begun) < (judges_time() ? promised_s : 600.0);
}

/// How long `work()` takes.
[[nodiscard]] double seconds_of(const auto& work) {
  const auto begun = std::chrono::steady_clock::now();
  work();
  return seconds_since(begun);
}

/// The median of how long `work()` takes.
[[nodiscard]] double median_of(int runs, const auto& work) {
  std::vector<double> times;
  for (int k = 0; k < runs; ++k) times.push_back(seconds_of(work));
  std::nth_element(times.begin(), times.begin() + runs / 2, times.end());
  return times[static_cast<std::size_t>(runs / 2)];
}

/// The processor time that `work()` takes in this thread, s.
[[nodiscard]] double cpu_seconds_of(const auto& work) {
  const auto now = [] {
    timespec used{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  };
  const double begun = now();
  work();
  return now() - begun;
}

/// True if `large()` takes at most `times` the processor time of `small()`. What else the machine
/// does slows some runs down, so the quickest of a few counts.
[[nodiscard]] bool takes_at_most(double times, const auto& large, const auto& small) {
  double large_s = std::numeric_limits<double>::infinity(), small_s = cpu_seconds_of(small);
  for (int run = 0; run < 5 && large_s > times * small_s; ++run) {
    large_s = std::min(large_s, cpu_seconds_of(large));
    small_s = std::min(small_s, cpu_seconds_of(small));
  }
  return large_s <= times * small_s;
}

/// The most memory that this process has had, MB.
[[nodiscard]] inline long peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// Waits until `holds()` is true, asking every `step`; false if it is not within `seconds`.
template <typename Condition>
[[nodiscard]] bool comes_true(Condition holds, double seconds = 300,
                              std::chrono::milliseconds step = std::chrono::milliseconds(2)) {
  const auto begun = std::chrono::steady_clock::now();
  while (!holds()) {
    if (seconds_since(begun) > seconds) return false;
    std::this_thread::sleep_for(step);
  }
  return true;
}

}  // namespace popcut::testing
