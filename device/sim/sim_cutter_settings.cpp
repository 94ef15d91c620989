// SPDX-License-Identifier: MIT
// Part of device/sim/sim_cutter.hpp: settings and queries.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/machines/motion.hpp"
#include "device/port/transport.hpp"
#include "device/sim/sim_cutter.hpp"

namespace popcut {
namespace {

constexpr std::size_t kKeptTexts = 1000;  // unknown commands and remarks shown in full
constexpr double kPanelSpeedMmS = 100;  // a guess, if neither the program nor the table has a speed
constexpr double kClassicOffsetUnits =
    18;  // 0.9 mm blade: the reply to an unset FQ2 (Portrait V1.00)

double arg(std::span<const double> args, std::size_t index, double otherwise) {
  return index < args.size() ? args[index] : otherwise;
}

/// The name of a setting in a trace: "blade_offset"; the mnemonic of one without a verb of its own.
std::string setting_name(Verb verb, std::string_view mnemonic) {
  if (verb == Verb::Other || verb == Verb::Absolute) return std::string(mnemonic);
  std::string name(name_of(verb));
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// Bytes in printable form, at most 64 of them.
std::string shown(std::string_view bytes) {
  constexpr std::size_t kMost = 64;
  std::string text = printable(bytes, kMost);
  if (bytes.size() > kMost) text += fmt::format("... ({} bytes)", bytes.size());
  return text;
}

/// The reply to FG if none was recorded: the title without its maker, firmware V0.00.
std::string made_up_identity(const std::string& title) {
  const std::size_t blank = title.find(' ');
  std::string name = blank == std::string::npos ? title : title.substr(blank + 1);
  for (char& c : name)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return fmt::format("{:<17}", name + " V0.00");
}

}  // namespace

void SimCutter::reset_settings() {
  const SteppedScale& speed = machine_.speed_mm_s;
  ToolState fresh;
  fresh.speed_mm_s =
      speed.per_step > 0 ? std::min(10, speed.max_step) * speed.per_step : kPanelSpeedMmS;
  if (machine_.firmware_blade_offset) fresh.offset_mm = kClassicOffsetUnits * machine_.unit_mm;
  tools_.fill(fresh);
  tool_ = 1;
  mat_ = 0;
  origin_ = near_ = {};
  const double page_length = options_.page_length_mm + std::max(machine_.margin_top_mm, 0.0);
  const double page_width = options_.page_width_mm + std::max(machine_.margin_left_mm, 0.0);
  far_ = {std::round(page_length / machine_.unit_mm), std::round(page_width / machine_.unit_mm)};
  window_ = bed_.reach();
  setup_done_ = drawn_ = false;
}

void SimCutter::apply(const Command& command) {
  const std::span<const double> args =
      std::span(incoming_.args).subspan(command.first, command.count);
  const std::string text =
      command.text < incoming_.texts.size() ? incoming_.texts[command.text] : std::string();
  if (command.verb == Verb::Empty) return;
  if (command.verb == Verb::Unknown) return unknown(text);
  if (command.verb == Verb::Query) {
    if (answers()) send_reply(reply_to(text));
    if (!answers() && machine_.answers_limits && text == "OH") send_reply(limits_reply());
    return;
  }
  trace_.settings.push_back({setting_name(command.verb, text), {args.begin(), args.end()}});
  stroke_open_ = false;  // the next line has other settings, so it is another stroke
  if (text == "TB123" || text == "TB124") return search_marks(args);
  switch (command.verb) {
    case Verb::Initialise:
      end_of_job();
      reset_settings();
      return;
    case Verb::Speed:
    case Verb::Force:
      return apply_scaled(command, args);
    case Verb::BladeOffset:
    case Verb::CornerLift:
    case Verb::CornerExtend:
      return apply_corner(command, args);
    case Verb::WindowNear:
    case Verb::WindowFar:
      return apply_window(command, args);
    case Verb::LineType:
      return tell_dashes(args);
    case Verb::SelectTool:
      return apply_tool(args);
    case Verb::Mat:
      mat_ = static_cast<int>(arg(args, 0, 0));
      return;
    case Verb::Orientation:
      return end_of_job();
    case Verb::Home:
    case Verb::SetOrigin:
      return apply_home(command.verb);
    case Verb::Autoblade: {
      const double depth = arg(args, 0, 0);
      if (!machine_.autoblade || arg(args, 1, 1) != 1 || !(depth >= 0 && depth <= 10))
        return remark(
            fmt::format("autoblade depth {:g} on tool {:g}: ignored", depth, arg(args, 1, 1)));
      const Motion& m = machine_.motion;
      return plan_dwell(m.autoblade_reset_s + (10 - depth) * m.autoblade_tap_s, Commit::Nothing);
    }
    default:
      return;
  }
}

/// The tool that a setting applies to: its own argument, else the selected one.
SimCutter::ToolState& SimCutter::tool_state(std::span<const double> args, std::size_t index) {
  const double tool = arg(args, index, tool_);
  const bool valid = tool >= 1 && tool < static_cast<double>(tools_.size());
  return tools_[valid ? static_cast<std::size_t>(tool) : static_cast<std::size_t>(tool_)];
}

void SimCutter::apply_scaled(const Command& command, std::span<const double> args) {
  const bool speed = command.verb == Verb::Speed;
  const SteppedScale& scale = speed ? machine_.speed_mm_s : machine_.force_gf;
  const double sent = arg(args, 0, 0);
  ToolState& state = tool_state(args, 1);
  if (scale.per_step <= 0) {
    if (!speed) state.force_steps = sent;
    if (speed && sent > 0) state.speed_mm_s = sent * 10;  // HPGL VS is in cm/s
    return;
  }
  const double taken =
      std::clamp(sent, static_cast<double>(scale.min_step), static_cast<double>(scale.max_step));
  if (taken != sent)
    remark(fmt::format("{} {:g}: outside {} to {}, {:g} was used", speed ? "speed" : "force", sent,
                       scale.min_step, scale.max_step, taken));
  (speed ? state.speed_mm_s : state.force_steps) = speed ? taken * scale.per_step : taken;
}

void SimCutter::apply_corner(const Command& command, std::span<const double> args) {
  const bool with_tool = args.size() >= 3;
  switch (command.verb) {
    case Verb::BladeOffset: {
      // FC n before the Cameo 3; since then FC a,b,tool with offset a x b.
      ToolState& state = tool_state(args, with_tool ? 2 : args.size());
      const double factor = with_tool ? args[1] : 1.0;
      state.offset_mm = std::max(0.0, arg(args, 0, 0) * factor) * machine_.unit_mm;
      return;
    }
    case Verb::CornerLift:
      tool_state(args, args.size() >= 2 ? 1 : args.size()).corner_lift = arg(args, 0, 0) != 0;
      return;
    default: {  // FF start, end, tool in tenths of mm
      ToolState& state = tool_state(args, with_tool ? 2 : args.size());
      state.corner_extension_mm = std::clamp(arg(args, 0, 0) + arg(args, 1, 0), 0.0, 100.0) * 0.1;
      return;
    }
  }
}

void SimCutter::apply_window(const Command& command, std::span<const double> args) {
  if (args.empty()) {
    window_ = bed_.reach();
    return;
  }
  const MachinePoint corner{arg(args, 0, 0), arg(args, 1, 0)};
  (command.verb == Verb::WindowNear ? near_ : far_) = corner;
  // If the page begins left of the machine's zero, drivers send negative coordinates with a window
  // from 0, and the machine cuts them (inkscape-silhouette, Cameo 5).
  PagePoint near = bed_.to_page(near_);
  near.x += std::min(machine_.margin_left_mm, 0.0);
  near.y += std::min(machine_.margin_top_mm, 0.0);
  PagePoint far = bed_.to_page(far_);
  if (dialect_ == Dialect::Hpgl) {  // the axes may point either way
    if (far.x < near.x) std::swap(far.x, near.x);
    if (far.y < near.y) std::swap(far.y, near.y);
  }
  // No window is larger than the reach of rollers and carriage.
  window_ = {std::clamp(near.x, 0.0, bed_.carriage_mm()), std::clamp(near.y, 0.0, bed_.feed_mm()),
             std::clamp(far.x, 0.0, bed_.carriage_mm()), std::clamp(far.y, 0.0, bed_.feed_mm())};
  if (command.verb == Verb::WindowFar && !setup_done_) {
    setup_done_ = true;
    plan_dwell(machine_.motion.setup_s, Commit::Nothing);
  }
}

/// Line types other than the solid one are those of pens: LT of HPGL with a number, L with another
/// than 0.
void SimCutter::tell_dashes(std::span<const double> args) {
  const bool dashed = !args.empty() && (dialect_ == Dialect::Hpgl || args[0] != 0);
  if (dashed && !std::exchange(dashes_told_, true))
    remark(fmt::format("line type {:g}: dashes are not followed, lines are shown whole", args[0]));
}

void SimCutter::apply_tool(std::span<const double> args) {
  const double tool = arg(args, 0, 0);
  if (tool == 0) return end_of_job();
  const double most = dialect_ == Dialect::Gpgl ? machine_.tool_holders : 8;
  if (!(tool >= 1 && tool <= most)) {
    remark(
        fmt::format("tool {:g}: the machine has {:g}; tool {} stays selected", tool, most, tool_));
    return;
  }
  if (plan_down_) plan_dwell(machine_.motion.lift_s, Commit::ToolUp);
  tool_ = static_cast<int>(tool);
}

void SimCutter::apply_home(Verb verb) {
  if (verb == Verb::SetOrigin) {
    const MachinePoint here = bed_.to_machine(plan_logical_);
    end_of_job();
    origin_ = here;
    return;
  }
  if (plan_down_) plan_dwell(machine_.motion.lift_s, Commit::ToolUp);
  origin_ = {};
  const PagePoint home = bed_.to_page({0, 0});
  plan_way(ActionKind::Travel, window_.clamped(home), machine_.motion.travel_mm_s);
  plan_logical_ = home;
  actions_.back().commit = Commit::Moved;
  actions_.back().to = home;
  end_of_job();
}

/// Parks the tool, once per job, at the first command that asks for it.
void SimCutter::end_of_job() {
  if (plan_down_) plan_dwell(machine_.motion.lift_s, Commit::ToolUp);
  if (!drawn_) return;
  plan_dwell(machine_.motion.trailer_s, Commit::Nothing);
  if (marks_found_) origin_ = {};
  drawn_ = setup_done_ = marks_found_ = false;
}

/// The arguments are height, width and the start of the search, which the machine's row says how
/// far from the marks' corner. The search ends with one reply: 0 if the marks are found, and from
/// then on their corner is the origin. How long it takes was never recorded; the sensor passes
/// along both sides of the rectangle.
void SimCutter::search_marks(std::span<const double> args) {
  constexpr double kSearchMm = 10;  // 20 mm right and down from the start
  const double unit = machine_.unit_mm;
  const double height = std::max(0.0, arg(args, 0, 0)) * unit * machine_.scale_feed;
  const double width = std::max(0.0, arg(args, 1, 0)) * unit * machine_.scale_carriage;
  // The search begins at a whole step, but marks are printed at tenths of a millimetre.
  const auto tenths = [](double mm) { return std::round(mm * 10) / 10; };
  const PagePoint start = bed_.to_page({arg(args, 2, 0), arg(args, 3, 0)});
  const PagePoint corner{tenths(start.x + machine_.marks.before_left_mm),
                         tenths(start.y + machine_.marks.before_top_mm)};
  const PagePoint middle{tenths(start.x + kSearchMm), tenths(start.y + kSearchMm)};
  const PagePoint printed = options_.marks_at.value_or(corner);
  const bool near =
      std::abs(printed.x - middle.x) <= kSearchMm && std::abs(printed.y - middle.y) <= kSearchMm;
  const bool on_sheet =
      options_.unlimited ||
      (width > 0 && height > 0 && printed.x + width <= options_.page_width_mm + kSearchMm &&
       printed.y + height <= options_.page_length_mm + kSearchMm);
  marks_found_ = options_.marks && near && on_sheet;
  const double seconds = search_seconds(width, height, machine_.marks);
  plan_dwell(seconds, Commit::Nothing);
  const auto ends = now_ + to_time(seconds);
  if (answers()) replies_.push_back({ends, marks_found_ ? "    0\x03" : "    1\x03"});
  if (!marks_found_) return;
  origin_ = bed_.to_machine(printed);
}

void SimCutter::unknown(std::string_view text) {
  ++trace_.unknown_count;
  if (trace_.unknown.size() < kKeptTexts) trace_.unknown.push_back(shown(text));
}

void SimCutter::remark(std::string text) {
  if (trace_.remarks.size() < kKeptTexts) trace_.remarks.push_back(std::move(text));
}

void SimCutter::send_reply(std::string bytes) {
  if (bytes.empty()) return;
  constexpr std::size_t kMostWaiting = 65536;  // a host that never reads
  if (replies_.size() >= kMostWaiting) return;
  const Time arrives = now_ + to_time(options_.reply_s);
  replies_.push_back({arrives, std::move(bytes)});
}

/// The reply to OH: as far as this machine reaches, wherever its sheet lies.
std::string SimCutter::limits_reply() const {
  const Window reach = bed_.reach();
  const MachinePoint one = bed_.to_machine({reach.left, reach.top});
  const MachinePoint other = bed_.to_machine({reach.right, reach.bottom});
  return fmt::format("{},{},{},{}\r", std::llround(std::min(one.a, other.a)),
                     std::llround(std::min(one.b, other.b)), std::llround(std::max(one.a, other.a)),
                     std::llround(std::max(one.b, other.b)));
}

/// Replies as recorded, with their padding: calibration pairs in columns of 5, limits of 6. Queries
/// without a recorded reply are not answered.
std::string SimCutter::reply_to(std::string_view query) const {
  const auto number = [](double value) { return std::llround(value); };
  const auto limits = [&](MachinePoint p) {
    return fmt::format("{:>6},{:>6}\x03", number(p.a), number(p.b));
  };
  const ToolState& state = tools_[static_cast<std::size_t>(tool_)];
  const double speed_step =
      machine_.speed_mm_s.per_step > 0 ? state.speed_mm_s / machine_.speed_mm_s.per_step : 0;
  if (query == "FG")
    return (machine_.identity.empty() ? made_up_identity(machine_.title) : machine_.identity) +
           '\x03';
  if (query == "FA" || query == "TB71") return "    0,    0\x03";
  if (query == "TC") return machine_.variant == "classic" ? "" : "    0,    0\x03";
  if (query == "[") return limits(near_);
  if (query == "U") return limits(far_);
  if (query == "FQ0") return fmt::format("{:>5}\x03", number(speed_step));
  if (query == "FQ2") return fmt::format("{:>5}\x03", number(state.offset_mm / machine_.unit_mm));
  if (query == "G") {
    const MachinePoint at = bed_.to_machine(position_);
    return fmt::format("{:>6},{:>6},{:>6}\x03", number(at.a), number(at.b), tool_ * 10);
  }
  if (query == "NAK" && machine_.reports_tools()) {
    std::string codes;
    for (int holder = 0; holder < machine_.tool_holders; ++holder) {
      const auto at = static_cast<std::size_t>(holder);
      codes += fmt::format("{}{}", holder == 0 ? "" : ",",
                           at < options_.tools.size() ? options_.tools[at] : 0);
    }
    return codes + '\x03';
  }
  return "";
}

}  // namespace popcut
