// SPDX-License-Identifier: MIT
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

namespace popcut::testing {

/// A file that somebody made to be dear to read: `make(n)` grows in proportion to n, as a rule.
struct DearFile {
  const char* name;
  std::size_t n;  ///< of the smaller file
  std::function<std::string(std::size_t n)> make;
  std::function<void(const std::string& bytes)> read;
};

/// `each(k)` for k from 0 to n - 1, joined.
template <typename Each>
[[nodiscard]] std::string times(std::size_t n, const Each& each) {
  std::string out;
  for (std::size_t k = 0; k < n; ++k) {
    if constexpr (std::is_invocable_v<Each, std::size_t>)
      out += each(k);
    else
      out += each;
  }
  return out;
}

/// What reading takes, in a process of its own.
struct ReadingCost {
  bool ended{};
  double cpu_s{}, memory_mb{};  ///< memory: on top of what this process has
};
[[nodiscard]] inline ReadingCost cost_of(const std::function<void()>& read) {
  const auto run = [](const std::function<void()>& work, rusage& used) {
    constexpr rlim_t kMost_s = 30;
    const pid_t child = ::fork();
    if (child == 0) {
      const rlimit most{kMost_s, kMost_s};
      ::setrlimit(RLIMIT_CPU, &most);
      work();
      ::_exit(0);
    }
    int status = 0;
    return child > 0 && ::wait4(child, &status, 0, &used) == child && WIFEXITED(status) &&
           WEXITSTATUS(status) == 0;
  };
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  rusage nothing{}, used{};
  ReadingCost out;
  out.ended = run([] {}, nothing) && run(read, used);
  out.cpu_s = seconds(used.ru_utime) + seconds(used.ru_stime) - seconds(nothing.ru_stime);
  out.memory_mb = static_cast<double>(std::max(used.ru_maxrss - nothing.ru_maxrss, 0L)) / 1024.0;
  return out;
}

/// Checks that reading takes work and memory in proportion to bytes (times their logarithm, and a
/// wide factor): four times the size at most eight times as much, and never more than a limit that
/// a file of this size may cost. What is refused must be refused as cheaply. Processor time, so
/// that other tests may run beside this one; the cheapest of three runs counts.
inline void check_growth(const std::vector<DearFile>& files) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
  constexpr bool kSanitized = true;
#else
  constexpr bool kSanitized = false;
#endif
#else
  constexpr bool kSanitized = false;
#endif
  constexpr double kSlower = kSanitized ? 10 : 1;
  // Computers differ in speed by 2.5: what takes 1.4 s on one takes 3.6 s on another.
  constexpr double kFixed_s = 6 * kSlower, kEach_us = 4 * kSlower;  // per byte
  constexpr double kFixed_mb = 128, kEach_b = 300;                  // per byte
  constexpr double kNoise_s = 0.15 * kSlower, kNoise_mb = 16;
  for (const DearFile& file : files) {
    const std::string small = file.make(file.n), large = file.make(4 * file.n);
    ReadingCost little{false, 1e9, 1e9}, much{false, 1e9, 1e9};
    const auto bytes = static_cast<double>(large.size());
    const auto is_cheap = [&] {
      return much.cpu_s <= 8 * little.cpu_s + kNoise_s &&
             much.cpu_s <= kFixed_s + 1e-6 * kEach_us * bytes;
    };
    for (int run = 0; run < 3 && (run == 0 || !is_cheap()); ++run) {
      const ReadingCost a = cost_of([&] { file.read(small); });
      const ReadingCost b = cost_of([&] { file.read(large); });
      little = {a.ended, std::min(little.cpu_s, a.cpu_s), a.memory_mb};
      much = {b.ended, std::min(much.cpu_s, b.cpu_s), b.memory_mb};
      if (!a.ended || !b.ended) break;
    }
    INFO(fmt::format("{}: {} bytes take {:.3f} s and {:.0f} MB, {} bytes {:.3f} s and {:.0f} MB",
                     file.name, small.size(), little.cpu_s, little.memory_mb, large.size(),
                     much.cpu_s, much.memory_mb));
    CHECK(little.ended);
    CHECK(much.ended);
    CHECK(is_cheap());
    if (!kSanitized) {
      CHECK(much.memory_mb <= 8 * little.memory_mb + kNoise_mb);
      CHECK(much.memory_mb <= kFixed_mb + 1e-6 * kEach_b * bytes);
    }
    if (std::getenv("POPCUT_SHOW_COSTS"))
      fmt::print("{:28} {:9} {:7.3f} s {:6.1f} MB {:9} {:7.3f} s {:6.1f} MB\n", file.name,
                 small.size(), little.cpu_s, little.memory_mb, large.size(), much.cpu_s,
                 much.memory_mb);
  }
}

}  // namespace popcut::testing
