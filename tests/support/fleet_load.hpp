// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/fleet_sql.hpp"

namespace popcut::testing {

/// How long calls of one kind took.
struct CallTimes {
  std::size_t count{};
  double p50_ms{}, p99_ms{}, most_ms{};
};
[[nodiscard]] CallTimes call_times(std::vector<double> times_ms);

/// Whether a transaction stores its event, and gives it a number after the commit.
enum class Events { None, Stored };

/// Many nodes with a cutter each, as clients of a fleet's database: what a popcutd sends for an
/// arm, a start, a mark and an end, by the same C++ (JobTable, AttemptTable), over a bounded number
/// of connections, each with a thread.
class FleetLoad {
 public:
  FleetLoad(FleetSql& fleet, int nodes, int connections);
  ~FleetLoad();
  FleetLoad(const FleetLoad&) = delete;
  FleetLoad& operator=(const FleetLoad&) = delete;

  struct Pace {
    double seconds{60};
    double sheets_s{56};  ///< begun in a second
    double beat_s{10};    ///< between the beats of a node
    int marks{2};         ///< of a sheet
    Events events{Events::Stored};
  };
  struct Figures {
    std::map<std::string, CallTimes> calls;  ///< from when a call was due to its end
    std::size_t sheets{}, again{};           ///< cut; transactions that ran a second time
    std::string fault{};                     ///< the first; empty: none
  };
  /// Calls come when they are due, whether or not those before are done. Between the arms as many
  /// claims of a bare queue, "bare claim", for comparison.
  [[nodiscard]] Figures paced(const Pace& pace);
  /// As fast as all connections together can: arm, start, end. How many sheets in a second.
  [[nodiscard]] double most_sheets_s(double seconds, Events events);
  /// The same without the service: each of the three is one statement that moves the job and calls
  /// the knife's function.
  [[nodiscard]] double most_calls_s(double seconds);
  /// As fast as they can: the claim of a bare queue, which takes a row with SKIP LOCKED and puts an
  /// attempt beside it. How many claims in a second.
  [[nodiscard]] double bare_claims_s(double seconds);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace popcut::testing
