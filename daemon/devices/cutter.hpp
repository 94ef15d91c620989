// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/result.hpp"
#include "daemon/devices/cutter_line.hpp"
#include "daemon/devices/cutters.hpp"
#include "daemon/model/model.hpp"
#include "device/session/session.hpp"

namespace popcut::daemon {

/// One cutter with its thread. Members may be called from any thread; none but `reset` waits.
class Cutter {
 public:
  Cutter(CutterLine line, bool enabled, const SessionOptions& session,
         std::function<void()> changed);
  ~Cutter();  ///< ends a cut at the end of its stroke, and waits for that
  Cutter(const Cutter&) = delete;
  Cutter& operator=(const Cutter&) = delete;

  [[nodiscard]] DeviceRecord record() const;
  [[nodiscard]] const Machine& machine() const { return line_.machine; }
  [[nodiscard]] const DeviceId& device() const { return line_.device; }

  [[nodiscard]] Result<void> cut(CutOrder order, std::shared_ptr<CutJournal> journal);
  void pause(bool wanted) { pause_ = wanted; }
  void cancel() { cancel_ = true; }
  /// Ends a cut now, without the end of its stroke.
  void give_up() { give_up_ = true; }
  [[nodiscard]] Result<void> reset();
  [[nodiscard]] bool busy() const;
  /// Nothing is cut, and the journal of the last cut knows how it ended.
  [[nodiscard]] bool at_rest() const;
  [[nodiscard]] const LineFigures& figures() const { return figures_; }
  /// When its thread last turned.
  [[nodiscard]] std::chrono::steady_clock::time_point beat() const { return beat_.load(); }

  /// Whether it is plugged in, and if it cannot be used now, why. `node`: where a device on a bus
  /// is now; another one means that it was plugged in again.
  void set_presence(bool there, const std::string& hindrance, const std::string& node = {});

 private:
  enum class Condition : std::uint8_t { None, Attention, Fault };
  struct Work {
    CutOrder order;
    std::shared_ptr<CutJournal> journal;
  };
  void serve();
  void carry_out(Work work);
  [[nodiscard]] SessionEnd session(const Work& work, std::int64_t& last_intended);
  void note_end(const SessionEnd& end);
  void ask_state();
  void touch() { beat_ = std::chrono::steady_clock::now(); }
  void tell() const;
  /// Under the lock: the record as it now is; true if it is another than before.
  bool refresh();

  CutterLine line_;  ///< of the thread, but for what never changes
  const SessionOptions options_;
  const std::function<void()> changed_;
  LineFigures figures_;
  std::atomic<bool> cancel_{false}, pause_{false}, give_up_{false};
  std::atomic<std::chrono::steady_clock::time_point> beat_{std::chrono::steady_clock::now()};

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  DeviceRecord record_;
  std::optional<Work> next_;
  bool cutting_{false}, telling_{false}, stopping_{false}, there_{true};
  bool reset_wanted_{false};
  std::uint64_t resets_done_{0};
  Condition condition_{Condition::None};
  std::string condition_text_, hindrance_, node_;
  std::thread thread_;
};

}  // namespace popcut::daemon
