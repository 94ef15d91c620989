// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "device/sim/bed.hpp"
#include "device/sim/ride.hpp"
#include "device/sim/trace.hpp"
#include "device/sim/window.hpp"
#include "protocol/command_reader.hpp"
#include "protocol/page_map.hpp"
#include "protocol/replies.hpp"

namespace popcut {

/// The surroundings of a simulated cutter when it is switched on.
struct SimOptions {
  double page_width_mm{};   ///< 0: the machine's first mat, else its own width
  double page_length_mm{};  ///< 0: the machine's first mat, else its own length
  bool media{true};         ///< a sheet is loaded
  bool unlimited{false};    ///< accepts any number of bytes at once: for estimates
  double reply_s{0.00075};  ///< median of the recorded replies (logic analyser, Portrait V1.00)
  bool marks{true};         ///< the sheet has the registration marks that the program searches for
  std::optional<PagePoint>
      marks_at{};                ///< their corner on the sheet; none: where the program expects it
  std::vector<int> tools{2, 0};  ///< ESC NAK's reply for each holder: 2 autoblade, 0 empty
};

/// A simulated cutter, made from a row of the machine table: bytes in, replies and a trace out.
///
/// It reads the program as the machine does, keeps it in an input buffer of the machine's size,
/// executes it on its own clock, and reports its status (GPGL, ESC ENQ). Commands that it does not
/// understand are kept and counted, never executed. It sends nothing but replies to queries. The
/// same bytes at the same times give the same trace.
///
/// Only `run_until` advances the clock. An HPGL machine answers nothing, like most clones, or only
/// OH if its row says so.
class SimCutter {
 public:
  using Time = std::chrono::nanoseconds;

  /// @retval OutOfRange  the machine's language, unit or motion is not valid
  [[nodiscard]] static Result<SimCutter> make(const Machine& machine,
                                              const SimOptions& options = {});

  // The cable.
  /// Accepts as many of `bytes` as the buffer has room for now; returns their number.
  std::size_t accept(std::span<const std::byte> bytes);
  /// No more bytes follow: an unfinished command counts as not understood.
  void finish();
  /// Replies that have arrived by now.
  [[nodiscard]] std::vector<std::byte> take_replies();
  /// When the next reply arrives, if there is one.
  [[nodiscard]] std::optional<Time> next_reply() const;

  // The clock.
  [[nodiscard]] Time now() const { return now_; }
  void run_until(Time time);
  /// Runs until nothing is left to do or nothing moves (paused, no media).
  void run_dry();
  /// When something next changes by itself: a motion ends, or the reset after a cancel.
  [[nodiscard]] std::optional<Time> next_event() const;

  // The front of the machine.
  void load_media();
  void unload_media();
  void pause();  ///< takes effect when the current leg has ended
  void resume();
  void lose_marks() { options_.marks = false; }  ///< no mark can be seen on the sheet
  void answer_as(std::string identity) { machine_.identity = std::move(identity); }  ///< to FG
  void cancel();  ///< only while paused: discards the rest and resets the machine

  // What can be observed.
  [[nodiscard]] DeviceStatus status() const;
  [[nodiscard]] const Trace& trace() const { return trace_; }
  [[nodiscard]] PagePoint position() const { return position_; }
  [[nodiscard]] bool tool_down() const { return tool_down_; }
  [[nodiscard]] std::uint64_t accepted_bytes() const { return accepted_; }
  /// All bytes before this one were executed.
  [[nodiscard]] std::uint64_t executed_bytes() const { return executed_; }
  /// Bytes up to `end_byte` were executed at `time`: a whole command, or one of its points.
  struct Step {
    std::uint64_t end_byte{};
    Time time{};
    bool whole_command{};
  };
  /// Appends every step from now on to `steps`; null stops recording.
  void record_steps(std::vector<Step>* steps) { steps_ = steps; }

 private:
  enum class ActionKind : std::uint8_t { Dwell, Travel, Cut };
  /// What becomes true when an action has ended.
  enum class Commit : std::uint8_t { Nothing, ToolUp, ToolDown, Moved, Drawn };
  struct Action {
    ActionKind kind{};
    Commit commit{};
    Leg leg;
    double dwell_s{};    ///< in addition to the ride
    PagePoint target;    ///< position of the tool then
    PagePoint from, to;  ///< Drawn: the line as commanded
    std::optional<Inside> inside;
    std::uint64_t begin_byte{}, end_byte{};
    bool whole_command{false};
  };
  struct ToolState {
    double force_steps{};
    double speed_mm_s{};
    double offset_mm{};  ///< of the blade; 0 is a pen
    bool corner_lift{};
    double corner_extension_mm{};
  };
  // How many legs the motion planner sees ahead: enough for full speed on legs of 1 mm. The real
  // machines' number is not known.
  static constexpr std::size_t kLookahead = 32;
  struct Reply {
    Time time{};
    std::string bytes;
  };

  SimCutter(const Machine& machine, const SimOptions& options, Dialect dialect);

  void reset_settings();
  void feed(std::span<const std::byte> bytes);
  void take_from(std::size_t before);
  void forget_done_commands();
  void flush();
  // From commands to actions.
  [[nodiscard]] bool has_commands() const { return next_ < incoming_.commands.size(); }
  void lower();
  void lower_point(const Command& command);
  void lower_move(PagePoint to);
  void lower_draw(PagePoint to);
  void plan_dwell(double seconds, Commit commit);
  void plan_way(ActionKind kind, PagePoint to, double speed_mm_s);
  [[nodiscard]] double plan_corner(PagePoint to);
  // Settings and queries, once all motion before them has ended.
  void apply(const Command& command);
  void apply_scaled(const Command& command, std::span<const double> args);
  void apply_corner(const Command& command, std::span<const double> args);
  void apply_window(const Command& command, std::span<const double> args);
  void tell_dashes(std::span<const double> args);
  void apply_tool(std::span<const double> args);
  void apply_home(Verb verb);
  void search_marks(std::span<const double> args);
  void end_of_job();
  void unknown(std::string_view text);
  void remark(std::string text);
  [[nodiscard]] ToolState& tool_state(std::span<const double> args, std::size_t index);
  /// Most HPGL machines answer nothing.
  [[nodiscard]] bool answers() const { return dialect_ == Dialect::Gpgl; }
  [[nodiscard]] std::string reply_to(std::string_view query) const;
  [[nodiscard]] std::string limits_reply() const;
  void send_reply(std::string bytes);
  // The clock.
  [[nodiscard]] bool held() const { return paused_ || !media_ || cancelled_until_.has_value(); }
  void answer_without_media();
  void start_next();
  void complete();
  void record_move(PagePoint to);
  void record_draw(const Action& action);

  Machine machine_;
  SimOptions options_;
  Dialect dialect_;
  Bed bed_;
  std::variant<GpglReader, HpglReader> reader_;
  Program incoming_;  ///< commands read; from `next_` on they are not yet actions
  std::size_t next_{};
  std::uint32_t next_point_{};
  std::uint64_t reader_base_{};  ///< bytes accepted before the reader was made
  std::deque<Action> actions_;
  std::optional<Action> current_;
  Time now_{}, current_end_{};
  std::optional<Time> first_byte_, cancelled_until_, drawn_dry_since_;
  std::uint64_t accepted_{}, executed_{};
  std::deque<Reply> replies_;

  bool media_{true}, paused_{false};
  // The machine's state now.
  PagePoint position_;  ///< of the tool
  PagePoint logical_;   ///< where the program assumes it is: maybe outside the window
  bool tool_down_{false}, stroke_open_{false};
  double speed_out_mm_s_{};  ///< speed at the end of the last leg
  // The machine's state after all planned actions.
  PagePoint plan_position_, plan_logical_;
  bool plan_down_{false};
  std::optional<PagePoint> plan_way_from_;  ///< start of the last cut leg, if the next continues it

  std::array<ToolState, 9> tools_{};
  int tool_{1};
  int mat_{};
  MachinePoint origin_{};
  MachinePoint near_{}, far_{};  ///< working window as sent
  Window window_;
  bool setup_done_{false}, drawn_{false}, marks_found_{false}, dashes_told_{false};
  double way_in_mm_{};  ///< from home to the first stroke

  Trace trace_;
  std::vector<Step>* steps_{};
};

}  // namespace popcut
