// SPDX-License-Identifier: MIT
// Part of device/sim/sim_cutter.hpp: turns commands into motion, as the machine's planner does.
#include <algorithm>

#include "core/machines/motion.hpp"
#include "device/sim/sim_cutter.hpp"

namespace popcut {

/// Fills the planner's queue. Settings wait until all motion before them has ended.
void SimCutter::lower() {
  while (has_commands() && actions_.size() < kLookahead) {
    const Command command = incoming_.commands[next_];
    if (command.verb == Verb::Move || command.verb == Verb::Draw) {
      lower_point(command);
      continue;
    }
    if (!actions_.empty()) return;
    ++next_;
    apply(command);
    if (actions_.empty()) plan_dwell(0, Commit::Nothing);
    actions_.back().end_byte = command.end;
    actions_.back().whole_command = true;
    forget_done_commands();
  }
}

/// One point of a command; its share of the command's bytes is freed when the tool reaches it.
void SimCutter::lower_point(const Command& command) {
  const std::uint64_t bytes = command.end - command.begin;
  const bool last = next_point_ + 1 >= command.count;
  const std::uint64_t end_byte =
      last ? command.end : command.begin + bytes * (next_point_ + 1) / command.count;
  if (command.count > 0) {
    MachinePoint point = incoming_.points[command.first + next_point_];
    point = {point.a + origin_.a, point.b + origin_.b};
    const PagePoint to = bed_.to_page(point);
    if (command.verb == Verb::Move)
      lower_move(to);
    else
      lower_draw(to);
  } else if (command.verb == Verb::Move) {  // PU without points lifts the tool where it is
    if (plan_down_) plan_dwell(machine_.motion.lift_s, Commit::ToolUp);
    plan_dwell(0, Commit::Moved);
    actions_.back().to = plan_logical_;
  } else {
    plan_dwell(0, Commit::Nothing);  // PD without points: the next line lowers the tool
  }
  Action& action = actions_.back();
  action.begin_byte = command.begin;
  action.end_byte = end_byte;
  action.whole_command = last;
  ++next_point_;
  if (!last) return;
  next_point_ = 0;
  ++next_;
  forget_done_commands();
}

void SimCutter::plan_dwell(double seconds, Commit commit) {
  Action action;
  action.commit = commit;
  action.dwell_s = seconds;
  action.target = plan_position_;
  actions_.push_back(action);
  plan_way_from_.reset();
  if (commit == Commit::ToolUp) plan_down_ = false;
  if (commit == Commit::ToolDown) plan_down_ = true;
}

void SimCutter::plan_way(ActionKind kind, PagePoint to, double speed_mm_s) {
  Action action;
  action.kind = kind;
  action.leg = {distance(plan_position_, to), speed_mm_s, 0};
  action.target = to;
  if (kind == ActionKind::Cut && plan_way_from_) {
    const ToolState& state = tools_[static_cast<std::size_t>(tool_)];
    const double cosine = turn_cos(*plan_way_from_, plan_position_, to);
    const Motion& motion = machine_.motion;
    action.leg.corner_mm_s = corner_speed(cosine, motion);
    if (const double swivel = swivel_seconds(cosine, state.offset_mm, motion); swivel > 0) {
      action.dwell_s = swivel;
      if (state.corner_lift)
        // Over the corner, up, back before it, down: the extension is cut and travelled once.
        action.dwell_s += motion.lift_s + motion.drop_s +
                          state.corner_extension_mm / std::max(speed_mm_s, 1.0) +
                          state.corner_extension_mm / motion.travel_mm_s;
    }
  }
  actions_.push_back(action);
  if (kind == ActionKind::Cut && distance(plan_position_, to) > 0) plan_way_from_ = plan_position_;
  plan_position_ = to;
}

void SimCutter::lower_move(PagePoint to) {
  if (plan_down_) plan_dwell(machine_.motion.lift_s, Commit::ToolUp);
  plan_way_from_.reset();
  plan_way(ActionKind::Travel, window_.clamped(to), machine_.motion.travel_mm_s);
  plan_logical_ = to;
  Action& way = actions_.back();
  way.commit = Commit::Moved;
  way.to = to;
}

void SimCutter::lower_draw(PagePoint to) {
  if (drawn_dry_since_ && actions_.empty()) {
    const double waited = std::chrono::duration<double>(now_ - *drawn_dry_since_).count();
    trace_.starved_s = std::max(trace_.starved_s, waited);
    drawn_dry_since_.reset();
  }
  const Motion& motion = machine_.motion;
  const PagePoint from = plan_logical_;
  const std::optional<Inside> inside = clip(window_, from, to);
  if (inside) {
    const PagePoint entry = window_.clamped(along(from, to, inside->from));
    const PagePoint exit = window_.clamped(along(from, to, inside->to));
    constexpr double kSamePlaceMm = 1e-6;
    if (distance(entry, plan_position_) > kSamePlaceMm) {
      if (plan_down_) plan_dwell(motion.lift_s, Commit::ToolUp);
      plan_way(ActionKind::Travel, entry, motion.travel_mm_s);
    }
    if (!plan_down_) plan_dwell(motion.drop_s, Commit::ToolDown);
    plan_way(ActionKind::Cut, exit, tools_[static_cast<std::size_t>(tool_)].speed_mm_s);
  } else {
    if (plan_down_) plan_dwell(motion.lift_s, Commit::ToolUp);
    plan_dwell(0, Commit::Nothing);
  }
  plan_logical_ = to;
  drawn_ = true;
  Action& line = actions_.back();
  line.commit = Commit::Drawn;
  line.from = from;
  line.to = to;
  line.inside = inside;
}

}  // namespace popcut
