// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "daemon/model/model.hpp"
#include "device/session/session.hpp"
#include "protocol/encode.hpp"

namespace popcut::daemon {

/// One sheet for one cutter. The program is what was stored when the plan was made.
struct CutOrder {
  std::string attempt;  ///< of the store
  std::string device;
  EncodedProgram program;
  std::array<double, 2> area_mm{};
  std::int64_t first_stroke{0};  ///< resume-from: earlier strokes are not sent. Strokes are always
                                 ///< counted as in the whole program, in the journal too
};

/// Records what happens while a sheet is cut. Called on the cutter's thread. `intend` and `ended`
/// return when they are committed. What `settle` notes is committed with the next of these calls,
/// or with progress: if a crash loses it, more is in doubt, never less. An error ends the cut at
/// the next end of a stroke.
class CutJournal {
 public:
  virtual ~CutJournal() = default;
  /// Strokes up to `last`, from the one after the previous intent, are about to be sent. Call this
  /// before any byte of them is sent.
  [[nodiscard]] virtual Result<void> intend(std::int64_t last_stroke) = 0;
  /// Strokes up to `certain` are cut for sure. The device took at least one byte of those up to
  /// `taken`.
  [[nodiscard]] virtual Result<void> settle(std::int64_t certain, std::int64_t taken,
                                            std::uint64_t bytes_taken) = 0;
  virtual void progress(const SessionProgress& progress) = 0;
  /// The last call, once.
  virtual void ended(const SessionEnd& end) = 0;
};

/// The cutters of this machine, each with a thread of its own. Only `cut` starts a knife.
class Cutters {
 public:
  virtual ~Cutters() = default;
  /// Calls `changed`, on any thread, when a device comes, goes or changes. When this returns, no
  /// call of the earlier listener is running.
  virtual void on_change(std::function<void()> changed) = 0;
  [[nodiscard]] virtual std::vector<DeviceRecord> list() const = 0;
  [[nodiscard]] virtual Result<Machine> machine(const std::string& device) const = 0;
  /// @retval DeviceGone  it is not there
  /// @retval Refused     it is cutting already, or is disabled
  [[nodiscard]] virtual Result<void> cut(CutOrder order, std::shared_ptr<CutJournal> journal) = 0;
  /// At the next end of a stroke, tool up; returns at once.
  virtual void pause(const std::string& device) = 0;
  virtual void resume(const std::string& device) = 0;
  virtual void cancel(const std::string& device) = 0;
  /// After a fault: drain, clear, reopen. Never sends a program.
  [[nodiscard]] virtual Result<void> reset(const std::string& device) = 0;
  /// Ends all cuts at the ends of their strokes, and waits at most so long for them and for their
  /// journals. A cut that has not ended then is given up in the middle of its stroke.
  virtual void stop_all(double seconds) = 0;
  /// OpenMetrics lines of what went over the lines to the cutters.
  [[nodiscard]] virtual std::string metrics() const { return {}; }
  /// Whether every cutter's thread was active within the last seconds (for the watchdog).
  [[nodiscard]] virtual bool alive() const = 0;
};

}  // namespace popcut::daemon
