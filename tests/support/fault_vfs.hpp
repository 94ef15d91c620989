// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <vector>

namespace popcut::testing {

/// A disk under SQLite that fills up, fails, or loses what was not synced when the power goes. It
/// is the system's VFS with these faults in between; one at a time.
class FaultVfs {
 public:
  FaultVfs();
  ~FaultVfs();
  FaultVfs(const FaultVfs&) = delete;
  FaultVfs& operator=(const FaultVfs&) = delete;
  [[nodiscard]] const std::string& name() const { return name_; }

  /// From the `write`-th write on (from 1) there is no room, but for `bytes` once `reserve` is
  /// gone.
  void fill_at(std::uint64_t write, const std::string& reserve = {}, std::uint64_t bytes = 0);
  /// The `sync`-th fsync fails, once.
  void fail_sync_at(std::uint64_t sync);
  /// The `write`-th write fails with EIO, once.
  void fail_write_at(std::uint64_t write);
  void heal();

  [[nodiscard]] std::uint64_t writes() const;
  [[nodiscard]] std::uint64_t syncs() const;
  /// Writes and truncations that were asked for after a failure was reported.
  [[nodiscard]] std::uint64_t writes_after_failure() const;

  /// Called after each write and sync, with what a power cut would leave.
  using Images = std::map<std::string, std::string>;  ///< content by path
  std::function<void()> after_each{};
  /// What the files hold after a power cut now: all that was synced, and of the rest some pieces.
  /// `kept` of 0: nothing of the rest, of 1: all of it.
  [[nodiscard]] Images power_cut(std::mt19937& random, double kept) const;

  struct State;

 private:
  std::string name_;
  std::unique_ptr<State> state_;
};

}  // namespace popcut::testing
