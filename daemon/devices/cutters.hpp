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

/// What is written down while a sheet is cut. Called on the cutter's thread. `intend` and `ended`
/// return when they are committed; what `settle` says is committed with the next of them, or with
/// progress (lost in a crash it leaves more in doubt, never less). An error ends the cut at the
/// next end of a stroke.
class CutJournal {
 public:
  virtual ~CutJournal() = default;
  /// Strokes up to `last` (from where the one before ended) are about to be sent. Before any byte
  /// of them.
  [[nodiscard]] virtual Result<void> intend(std::int64_t last_stroke) = 0;
  /// Strokes up to `certain` are cut for sure, those up to `taken` have a byte with the device.
  [[nodiscard]] virtual Result<void> settle(std::int64_t certain, std::int64_t taken,
                                            std::uint64_t bytes_taken) = 0;
  virtual void progress(const SessionProgress& progress) = 0;
  /// Once, last.
  virtual void ended(const SessionEnd& end) = 0;
};

/// The cutters of this machine, each with a thread of its own. Nothing here starts a knife but
/// `cut`.
class Cutters {
 public:
  virtual ~Cutters() = default;
  /// Called from any thread when a device comes, goes or changes. No call of the one before is
  /// under way when this returns.
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
  /// Ends all cuts at the ends of their strokes and waits for them, and for their journals, at most
  /// so long; what then still cuts is given up in the middle of its stroke.
  virtual void stop_all(double seconds) = 0;
  /// OpenMetrics lines of what went over the lines to the cutters.
  [[nodiscard]] virtual std::string metrics() const { return {}; }
  /// True as long as every cutter's thread has turned within the last seconds (for the watchdog).
  [[nodiscard]] virtual bool alive() const = 0;
};

}  // namespace popcut::daemon
