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
#include "device/sim/motion.hpp"
#include "device/sim/trace.hpp"
#include "device/sim/window.hpp"
#include "protocol/gpgl_reader.hpp"
#include "protocol/hpgl_reader.hpp"
#include "protocol/page_map.hpp"
#include "protocol/replies.hpp"

namespace popcut {

/// What stands around a simulated cutter when it is switched on.
struct SimOptions {
  double page_width_mm{};   ///< 0: the machine's first mat, else its own width
  double page_length_mm{};  ///< 0: the machine's first mat, else its own length
  bool media{true};         ///< a sheet is loaded
  bool unlimited{false};    ///< takes any number of bytes at once: for estimates
  double reply_s{0.00075};  ///< median of the recorded replies (logic analyser, Portrait V1.00)
  bool marks{true};         ///< the sheet bears the registration marks that the program searches
  std::optional<PagePoint> marks_at{};  ///< their corner on the sheet; none: just where expected
  std::vector<int> tools{2, 0};  ///< what ESC NAK tells is in each holder: 2 autoblade, 0 nothing
};

/// A cutter that is made of a row of the machine table: bytes in, replies and a trace out.
///
/// It reads the program as the machine does, keeps it in an input buffer of the machine's size,
/// carries it out on a clock of its own, and tells its status (GPGL, ESC ENQ). What it does not
/// understand is kept and counted, never carried out. It only answers queries. The same bytes at
/// the same times give the same trace.
///
/// The clock moves by `run_until` alone. A machine that speaks HPGL answers nothing, as most
/// clones.
class SimCutter {
 public:
  using Time = std::chrono::nanoseconds;

  /// @retval OutOfRange  the machine's language, unit or motion is not lawful
  [[nodiscard]] static Result<SimCutter> make(const Machine& machine,
                                              const SimOptions& options = {});

  // The cable.
  /// Takes as many of `bytes` as the buffer has room for, now; returns their number.
  std::size_t accept(std::span<const std::byte> bytes);
  /// No more bytes come: what an unfinished command holds is not understood, and is counted so.
  void finish();
  /// Replies that have arrived by now.
  [[nodiscard]] std::vector<std::byte> take_replies();
  /// When the next reply arrives, if one is on its way.
  [[nodiscard]] std::optional<Time> next_reply() const;

  // The clock.
  [[nodiscard]] Time now() const { return now_; }
  void run_until(Time time);
  /// Runs until nothing is left to do or nothing moves any more (paused, no media).
  void run_dry();
  /// When something changes by itself next: a motion ends, the reset after a cancel is over.
  [[nodiscard]] std::optional<Time> next_event() const;

  // The front of the machine.
  void load_media();
  void unload_media();
  void pause();  ///< takes effect when the leg under way has ended
  void resume();
  void lose_marks() { options_.marks = false; }  ///< no mark can be seen on the sheet
  void answer_as(std::string identity) { machine_.identity = std::move(identity); }  ///< to FG
  void cancel();  ///< only while paused: the rest is thrown away and the machine resets itself

  // What is to be seen.
  [[nodiscard]] DeviceStatus status() const;
  [[nodiscard]] const Trace& trace() const { return trace_; }
  [[nodiscard]] PagePoint position() const { return position_; }
  [[nodiscard]] bool tool_down() const { return tool_down_; }
  [[nodiscard]] std::uint64_t accepted_bytes() const { return accepted_; }
  /// All bytes before this one have been carried out.
  [[nodiscard]] std::uint64_t executed_bytes() const { return executed_; }
  /// Bytes up to `end_byte` were carried out at `time`: a whole command, or one of its points.
  struct Step {
    std::uint64_t end_byte{};
    Time time{};
    bool whole_command{};
  };
  /// Every step from now on is appended to `steps`; null ends that.
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
    PagePoint target;    ///< where the tool then stands
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
  // Legs that the motion planner sees ahead: enough for full speed on legs of 1 mm. The true number
  // is not known.
  static constexpr std::size_t kLookahead = 32;
  struct Reply {
    Time time{};
    std::string bytes;
  };

  SimCutter(const Machine& machine, const SimOptions& options, const PageMap& map);

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
  void apply_tool(std::span<const double> args);
  void apply_home(Verb verb);
  void search_marks(std::span<const double> args);
  void end_of_job();
  void unknown(std::string_view text);
  void remark(std::string text);
  [[nodiscard]] ToolState& tool_state(std::span<const double> args, std::size_t index);
  /// Most machines that speak HPGL answer nothing.
  [[nodiscard]] bool answers() const { return map_.dialect == Dialect::Gpgl; }
  [[nodiscard]] std::string reply_to(std::string_view query) const;
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
  PageMap map_;
  std::variant<GpglReader, HpglReader> reader_;
  Program incoming_;  ///< commands read, from `next_` on not yet actions
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
  // The machine as it stands.
  PagePoint position_;  ///< of the tool
  PagePoint logical_;   ///< where the program believes it is: maybe outside the window
  bool tool_down_{false}, stroke_open_{false};
  double speed_out_mm_s_{};  ///< at which the last leg was left
  // The machine as it will stand after all actions so far.
  PagePoint plan_position_, plan_logical_;
  bool plan_down_{false};
  std::optional<PagePoint> plan_way_from_;  ///< start of the last cut leg, if one can go on from it

  std::array<ToolState, 9> tools_{};
  int tool_{1};
  int mat_{};
  MachinePoint origin_{};
  MachinePoint near_{}, far_{};  ///< working window as sent
  Window window_;
  bool setup_done_{false}, drawn_{false}, marks_found_{false};
  double way_in_mm_{};  ///< from home to the first stroke

  Trace trace_;
  std::vector<Step>* steps_{};
};

}  // namespace popcut
