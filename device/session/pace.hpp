// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

namespace popcut {

/// Where a machine is in a program, by a model of its motion whose speed is corrected from what is
/// seen: each time the machine comes to rest it has done all that was sent, and how long it took
/// says how fast it is. Positions are seconds of the model since the geometry began.
///
/// Between two rests the position is known within bounds that grow with time. A host that may not
/// send too far ahead goes by the least position, one that must not let the machine run dry by the
/// largest.
class Pace {
 public:
  using Time = std::chrono::nanoseconds;

  /// @param measured  the machine reports when it is at rest; else the model is taken as exact
  explicit Pace(bool measured) : measured_(measured) {
    if (!measured) slow_ = fast_ = 1;
  }

  /// The machine is at rest at `at_s`, and starts from there.
  void start(Time now, double at_s);
  /// Time passes. The machine has `sent_s` to do and stops where that ends.
  void advance(Time now, double sent_s);
  /// Time passes, and the machine stands still: a pause. How long the motion around it takes says
  /// nothing about the machine.
  void stand_still(Time now);
  /// The machine came to rest at `at_s` between `earliest` and now. If it may have waited there for
  /// longer, for data, pass `waited`: then it is at least that fast.
  void rest(Time now, Time earliest, double at_s, bool waited);

  [[nodiscard]] double at_s() const { return at_; }
  [[nodiscard]] double least_s() const { return least_; }
  [[nodiscard]] double most_s() const { return most_; }
  /// Seconds of the model in one second of the machine: the estimate and its bounds.
  [[nodiscard]] double rate() const { return rate_; }
  [[nodiscard]] double slow() const { return slow_; }
  [[nodiscard]] double fast() const { return fast_; }
  /// Whether it is time to wait for the machine, at the next end of a stroke: the position has
  /// become too uncertain, or so much has been done since the last rest that a fault now would
  /// leave too many strokes in doubt.
  [[nodiscard]] bool sync_due() const;

 private:
  bool measured_;
  double rate_{1}, slow_{0.5}, fast_{2};
  Time now_{};                             ///< of the positions
  double at_{}, least_{}, most_{};         ///< positions
  Time since_{};                           ///< of the last rest
  double since_s_{};                       ///< position then
  bool undisturbed_{true};                 ///< since then
  double seen_model_s_{}, seen_real_s_{};  ///< motion measured, the last of it counts most
};

}  // namespace popcut
