// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/model/problem.hpp"
#include "daemon/planning/planner.hpp"

namespace popcut::daemon {

/// A task for which somebody waits at a screen.
struct PreviewTask {
  PlanningTask task;
  std::string who;  ///< the principal
  /// A newer task of the same principal and key takes the place of this one; empty: none does.
  std::string key{};
  /// When a newer one is there, this one may go on until it has been at work for `grace_s`, so that
  /// somebody who never rests sees pictures too. Others end at once.
  bool is_patient{false};
  /// It took more than the processor time of previews, and goes on as designs that are opened.
  bool is_long{false};
};

struct PreviewLimits {
  int processes{2};     ///< at work at once on previews
  int openings{2};      ///< the same, of stored designs and shapes to place
  int files{2};         ///< the same, of pictures and files
  double idle_s{60};    ///< after which a worker without work ends
  double grace_s{0.5};  ///< see `PreviewTask::is_patient`
  /// Of previews. What counts is processor time: how busy the computer is does not matter.
  PlanningLimits quick{.cpu_s = 10,
                       .wall_s = 600,
                       .memory_bytes = std::uint64_t{512} << 20,
                       .output_bytes = std::uint64_t{64} << 20,
                       .is_preview = true};
  PlanningLimits slow{
      .cpu_s = 120, .wall_s = 600, .output_bytes = std::uint64_t{256} << 20};  ///< of all else
};

/// Runs what somebody waits for at a screen in workers of its own (see `Planner`), so that no plan
/// delays it. Previews of one principal are done one after another by one worker that stays warm,
/// and that does nothing for anybody else; all other tasks get a fresh one each.
///
/// There are three lines, so that nobody's hand waits for somebody's large design: previews; stored
/// designs that are opened and shapes that are placed; pictures and files. An exact preview that
/// takes more processor time than `quick` allows goes on in the second line. In each of them
/// principals take turns, and of one principal one task is at work. In each at most 64 tasks wait,
/// 16 of one principal. Of one principal and key one is at work and one waits.
class Previewer {
 public:
  virtual ~Previewer() = default;
  /// Called once for each task, on a thread of the previewer or of who calls it off.
  /// - Superseded   a newer one came
  /// - Unavailable  too many wait (with the seconds to wait), it was called off, or popcutd stops
  /// - Validation   as `perform`, or it hit a limit
  using Done = std::function<void(Answer<PlanningOutcome>)>;
  /// Number of the task, for `cancel`.
  virtual std::uint64_t start(PreviewTask task, Done done) = 0;
  /// Ends it, if it has not ended.
  virtual void cancel(std::uint64_t task) = 0;
  /// Ends all tasks and workers; whatever comes later is refused. Its destructor does so too.
  virtual void stop() = 0;
};

/// @param program  as for `make_planner`
[[nodiscard]] std::unique_ptr<Previewer> make_previewer(const PreviewLimits& limits,
                                                        std::string program);

}  // namespace popcut::daemon
