// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>

namespace popcut::testing {

/// What a test and the shim in the program under test share (a mapped file). The shim counts the
/// program's calls; the test says at which count something happens. 0: never.
struct FaultControl {
  std::atomic<std::uint64_t> calls;    ///< that leave something behind: write, fsync, rename, ioctl
  std::atomic<std::uint64_t> kill_at;  ///< it dies before this one, or the next
  std::atomic<std::uint64_t> kill_after;  ///< it dies after this one, or the next
  std::atomic<std::uint64_t> disk;        ///< those that take room on the disk
  std::atomic<std::uint64_t> full_from;   ///< from this one on there is none
  std::atomic<std::uint64_t> full_until;  ///< and again from this one; 0: it stays full
};

inline constexpr const char* kFaultControl = "POPCUT_FAULT_CONTROL";  ///< path of the mapped file

}  // namespace popcut::testing
