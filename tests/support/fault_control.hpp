// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>

namespace popcut::testing {

/// Shared by a test and the shim in the program under test (a mapped file). The shim counts the
/// program's calls; the test sets at which count something happens. 0: never.
struct FaultControl {
  std::atomic<std::uint64_t> calls;        ///< writes and syncs of files, renames, ioctls
  std::atomic<std::uint64_t> kill_at;      ///< it dies before this one, or the next
  std::atomic<std::uint64_t> kill_after;   ///< it dies after this one, or the next
  std::atomic<std::uint64_t> disk;         ///< those that take room on the disk
  std::atomic<std::uint64_t> full_from;    ///< from this one on there is none
  std::atomic<std::uint64_t> full_until;   ///< and again from this one; 0: it stays full
  std::atomic<std::uint64_t> syncs;        ///< of the database and its log
  std::atomic<std::uint64_t> bad_sync;     ///< this one fails with EIO
  std::atomic<std::uint64_t> bad_journal;  ///< syncs of journals of intents that fail with EIO
  std::atomic<std::uint64_t> last_sync;    ///< it dies after this one, or the next
  std::atomic<std::int64_t> clock_s;       ///< added to the clock on the wall
  std::atomic<std::uint64_t> stall;        ///< not 0: who syncs a file waits until it is
  std::atomic<std::uint64_t> stalled;      ///< how many wait so
  std::atomic<std::uint64_t> blocked;      ///< a `Blocked`: who gets there does not come back
};

/// Where a thread hangs while `FaultControl::blocked` names the place.
enum Blocked : std::uint64_t {
  kNobody,
  kSyncs,   ///< fsync of the database: the service's thread
  kPolls,   ///< epoll_wait: the thread of HTTP
  kTraces,  ///< a write to a simulated cutter's trace: the cutter's thread
};

inline constexpr const char* kFaultControl = "POPCUT_FAULT_CONTROL";  ///< path of the mapped file

}  // namespace popcut::testing
