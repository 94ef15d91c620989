// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/model/local_users.hpp"
#include "daemon/model/model.hpp"
#include "protocol/encode.hpp"

namespace popcut::daemon {

class Previewer;

/// A sheet's program as it is stored.
struct StoredProgram {
  EncodedProgram program;
  std::string index_sha256;  ///< of the index of the program: which bytes cut which stroke
};
/// The name of the index in the folder of a plan: "sheet-01.program.json".
[[nodiscard]] std::string index_name(int sheet);

/// Options of this popcutd as a node of a fleet. They are used only if the database is shared.
struct FleetOptions {
  std::string node{};             ///< the name of this node
  std::string url{};              ///< where people reach its page
  std::string site{};             ///< where its cutters stand
  std::string version{};          ///< of popcutd
  double lease_s{30};             ///< how long a lease lasts
  double beat_s{5};               ///< the lease is renewed this often
  double mark_s{1};               ///< the progress of a cut is stored at most this often
  bool has_database_clock{true};  ///< use the clock of the database; false: this computer's
};

/// Limits and hooks of a service. The manual states the defaults.
struct ServiceOptions {
  std::int64_t arm_s{600};          ///< how long START may be pressed after arming
  std::int64_t queue_jobs{50'000};  ///< most jobs that have not ended, and most plans that wait
  std::int64_t jobs_each{25'000};   ///< most jobs of one principal that have not ended
  std::int64_t plans_each{1000};    ///< most plans for which one principal waits
  std::int64_t searches_each{8};    ///< most searches for which one principal waits
  int sheets_per_job{10'000};
  int plans_at_once{2};                       ///< most plans that are made at the same time
  std::uint64_t least_free_bytes{16u << 20};  ///< on the disk; with less, new work is refused
  std::int64_t keep_keys_ms{7LL * 86'400'000};
  std::int64_t keep_events_ms{30LL * 86'400'000};
  std::int64_t session_ms{12LL * 3'600'000};          ///< a page's session ends if unused so long
  std::int64_t longest_session_ms{7LL * 86'400'000};  ///< a page's session ends after this anyway
  LocalUsers users{};                                 ///< roles of the users of the unix socket
  std::int64_t believe_ms{24LL * 3'600'000};  ///< run time until a jump of the clock is accepted
  std::vector<std::string> tables{};          ///< users' tables of machines and materials, as text
  /// Materials for which a device is set up; a device without an entry takes any material.
  std::map<std::string, std::vector<std::string>> device_materials{};
  /// Makes previews; null: there are none.
  std::shared_ptr<Previewer> previewer{};
  FleetOptions fleet{};
  std::string invocation{};  ///< the id of this run; empty: a new one

  /// Reads the program of a sheet from the files that the planner wrote into a plan's folder.
  std::function<Result<StoredProgram>(const std::string& folder, int sheet)> read_program{};
  std::function<void(const std::string& line)> log{};  ///< gets lines for an administrator
  /// The login name of a user, or an empty text; the default asks the system.
  std::function<std::string(uid_t)> user_name{};
  std::function<TimeMs()> wall_ms{};             ///< default: the system's clock
  std::function<std::int64_t()> monotonic_ms{};  ///< default: CLOCK_MONOTONIC
};

/// The options that may change while the service runs.
struct ServiceTuning {
  std::int64_t queue_jobs{50'000}, jobs_each{25'000}, plans_each{1000};
  int sheets_per_job{10'000};
  std::map<std::string, std::vector<std::string>> device_materials{};
  LocalUsers users{};
};

}  // namespace popcut::daemon
