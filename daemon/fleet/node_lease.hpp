// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "daemon/store/attempt_table.hpp"
#include "daemon/store/database.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {

/// One popcutd among the nodes of a fleet: its name, the epoch of this run, and its lease, without
/// which it may arm and start nothing. The clock of leases is the database's.
///
/// What it must know after a restart is in STATE/node: its last epoch, the last event that it knew
/// of, the greatest fence, an epoch that may not have been committed, and the database's
/// generation. An older database is noticed by them.
class NodeLease {
 public:
  struct Options {
    std::string name;
    std::string url{};      ///< where people reach its page
    std::string version{};  ///< of popcutd
    double lease_s{30};
    std::function<std::int64_t()> elapsed_ms{};  ///< empty: CLOCK_BOOTTIME
  };
  /// @param mark  gets the name, and the epoch and the fence as they change
  NodeLease(Database& database, const StateFolder& folder, NodeMark& mark, Options options);

  /// A new epoch, with a lease.
  ///
  /// @throws StoreFault  Refused: another popcutd has this name; Away
  void begin();
  /// Whether what has this name was begun from this folder: the last life of this node, which ends
  /// with its lease.
  [[nodiscard]] bool is_own_life() const;
  /// Of the database in which this life began, and the one before it; empty: not known.
  [[nodiscard]] const std::string& generation() const { return generation_; }
  [[nodiscard]] const std::string& generation_before() const { return generation_before_; }
  /// The journals were compared with the database: others need not wait for it.
  void reported();
  /// Renews the lease. False: it is over, or the database went back: begin again.
  [[nodiscard]] bool beat();
  /// Ends it in order, best effort.
  void end();
  /// Whether the lease holds for sure, by this machine's own clock: counted from before the last
  /// beat was sent, with a quarter to spare.
  [[nodiscard]] bool holds() const;
  /// What the database's clock is ahead of this machine's, in ms.
  [[nodiscard]] std::int64_t ahead_ms(std::int64_t own_ms) const;
  /// Takes note of an event that was read.
  void saw(std::int64_t event);
  [[nodiscard]] const Options& options() const { return options_; }

 private:
  void begin_after(std::int64_t epoch);
  void read_clock(std::int64_t ms);
  void keep();
  Database& database_;
  const StateFolder& folder_;
  NodeMark& mark_;
  Options options_;
  std::int64_t last_epoch_{0}, last_event_{0}, next_epoch_{0};
  std::int64_t holds_until_ms_{0};
  std::int64_t clock_at_ms_{0}, clock_ms_{0};  ///< the database's clock, and when it was read
  std::string generation_, generation_before_, kept_;
};

/// Of a machine and a folder on it: a copy of either is another one. 32 hexadecimal digits.
[[nodiscard]] std::string identity_of(const StateFolder& folder);

}  // namespace popcut::daemon
