// SPDX-License-Identifier: MIT
#include "device/sim/sim_cutter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "device/port/transport.hpp"

namespace popcut {
namespace {

// A cancel on the panel resets the machine; how long that takes was never recorded.
constexpr SimCutter::Time kResetAfterCancel = std::chrono::seconds(3);

/// A status on the wire.
char digit(DeviceStatus status) { return static_cast<char>('0' + static_cast<int>(status)); }

SimCutter::Time bounded_time(double seconds) {
  constexpr double kLongest = 1e8;  // three years: no machine waits longer, and it stays in range
  return to_time(std::clamp(seconds, 0.0, kLongest));
}

}  // namespace

Result<SimCutter> SimCutter::make(const Machine& machine, const SimOptions& options) {
  const Motion& m = machine.motion;
  if (!(m.accel_mm_s2 > 0) || !(m.travel_mm_s > 0))
    return fail(
        ErrorKind::OutOfRange, "/motion",
        fmt::format("{} has no acceleration or travel speed; both must be above 0", machine.name));
  if (machine.buffer_bytes == 0)
    return fail(ErrorKind::OutOfRange, "/buffer_bytes",
                fmt::format("{} has an input buffer of 0 bytes; it must be above 0, usually 65536",
                            machine.name));
  SimOptions sheet = options;
  const bool on_mat = !machine.mats.empty();
  if (!(sheet.page_width_mm > 0))
    sheet.page_width_mm = on_mat ? machine.mats.front().width_mm : machine.width_mm;
  if (!(sheet.page_length_mm > 0))
    sheet.page_length_mm = on_mat ? machine.mats.front().length_mm : machine.length_mm;
  const Result<Dialect> dialect = dialect_of(machine);
  if (!dialect) return tl::unexpected(dialect.error());
  if (!(machine.unit_mm > 0) || !std::isfinite(machine.unit_mm))
    return fail(ErrorKind::OutOfRange, "/unit_mm",
                fmt::format("a step of {} mm; it must be above 0", machine.unit_mm));
  return SimCutter(machine, sheet, *dialect);
}

SimCutter::SimCutter(const Machine& machine, const SimOptions& options, Dialect dialect)
    : machine_(machine),
      options_(options),
      dialect_(dialect),
      bed_(machine, options.page_length_mm),
      media_(options.media) {
  flush();
  position_ = logical_ = plan_position_ = plan_logical_ = bed_.to_page({0, 0});
  trace_.machine = machine.name;
  trace_.unit_mm = machine.unit_mm * std::max(machine.scale_feed, machine.scale_carriage);
  trace_.page_width_mm = options.page_width_mm;
  trace_.page_length_mm = options.page_length_mm;
  reset_settings();
}

std::size_t SimCutter::accept(std::span<const std::byte> bytes) {
  std::size_t room = bytes.size();
  if (!options_.unlimited) {
    const std::uint64_t held_bytes = accepted_ - executed_;
    room = held_bytes >= machine_.buffer_bytes
               ? 0
               : std::min<std::uint64_t>(room, machine_.buffer_bytes - held_bytes);
  }
  if (room == 0) return 0;
  if (!first_byte_) first_byte_ = now_;
  feed(bytes.first(room));
  accepted_ += room;
  start_next();
  return room;
}

/// Reads `bytes`. A status query is answered at once, ahead of queued commands.
void SimCutter::feed(std::span<const std::byte> bytes) {
  const std::size_t before = incoming_.commands.size();
  std::visit([&](auto& reader) { reader.feed(bytes, incoming_); }, reader_);
  take_from(before);
}

void SimCutter::finish() {
  const std::size_t before = incoming_.commands.size();
  std::visit([&](auto& reader) { reader.finish(incoming_); }, reader_);
  take_from(before);
  start_next();
}

void SimCutter::take_from(std::size_t before) {
  const std::vector<Command> fresh(incoming_.commands.begin() + static_cast<std::ptrdiff_t>(before),
                                   incoming_.commands.end());
  incoming_.commands.resize(before);
  for (Command command : fresh) {
    command.begin += reader_base_;
    command.end += reader_base_;
    if (command.verb == Verb::Query && incoming_.texts[command.text] == "ENQ") {
      if (answers()) send_reply({digit(status()), '\x03'});
    } else if (!cancelled_until_) {  // bytes that arrive during the reset are lost
      incoming_.commands.push_back(command);
    }
  }
}

std::vector<std::byte> SimCutter::take_replies() {
  std::vector<std::byte> bytes;
  while (!replies_.empty() && replies_.front().time <= now_) {
    for (const char c : replies_.front().bytes) bytes.push_back(static_cast<std::byte>(c));
    replies_.pop_front();
  }
  return bytes;
}

std::optional<SimCutter::Time> SimCutter::next_reply() const {
  if (replies_.empty()) return std::nullopt;
  return replies_.front().time;
}

std::optional<SimCutter::Time> SimCutter::next_event() const {
  if (current_) return current_end_;
  return cancelled_until_;
}

void SimCutter::run_until(Time time) {
  for (;;) {
    start_next();
    const std::optional<Time> next = next_event();
    if (!next || *next > time) break;
    now_ = std::max(now_, *next);
    if (current_)
      complete();
    else
      cancelled_until_.reset();
  }
  now_ = std::max(now_, time);
}

void SimCutter::run_dry() {
  start_next();
  while (const std::optional<Time> next = next_event()) run_until(*next);
}

DeviceStatus SimCutter::status() const {
  if (cancelled_until_) return DeviceStatus::Cancelled;
  if (!media_) return DeviceStatus::NoMedia;
  if (paused_) return DeviceStatus::Paused;
  return current_ || !actions_.empty() || has_commands() ? DeviceStatus::Moving
                                                         : DeviceStatus::Ready;
}

void SimCutter::load_media() {
  media_ = true;
  start_next();
}

void SimCutter::unload_media() { media_ = false; }

void SimCutter::pause() {
  if (!cancelled_until_) paused_ = true;
}

void SimCutter::resume() {
  paused_ = false;
  start_next();
}

void SimCutter::cancel() {
  if (!paused_) return;
  paused_ = false;
  current_.reset();
  flush();
  reset_settings();
  far_ = {};  // limits that make no sense, until the next job sets them
  tool_down_ = plan_down_ = false;
  plan_position_ = plan_logical_ = logical_ = position_;
  cancelled_until_ = now_ + kResetAfterCancel;
}

/// Discards everything that was accepted and not executed.
void SimCutter::flush() {
  actions_.clear();
  incoming_ = {};
  incoming_.dialect = dialect_;
  next_ = 0;
  next_point_ = 0;
  reader_base_ = executed_ = accepted_;
  if (dialect_ == Dialect::Gpgl)
    reader_ = GpglReader{};
  else
    reader_ = HpglReader{};
  plan_way_from_.reset();
  stroke_open_ = false;
  speed_out_mm_s_ = 0;
  drawn_dry_since_.reset();
}

/// Keeps the list of commands short on jobs of any length.
void SimCutter::forget_done_commands() {
  constexpr std::size_t kWorthIt = 4096;
  if (next_ < incoming_.commands.size() && next_ < kWorthIt) return;
  Program rest;
  rest.dialect = incoming_.dialect;
  for (std::size_t i = next_; i < incoming_.commands.size(); ++i) {
    Command command = incoming_.commands[i];
    const bool way = command.verb == Verb::Move || command.verb == Verb::Draw;
    const auto move = [&](const auto& from, auto& to) {
      const auto start = from.begin() + command.first;
      command.first = static_cast<std::uint32_t>(to.size());
      to.insert(to.end(), start, start + command.count);
    };
    if (way)
      move(incoming_.points, rest.points);
    else
      move(incoming_.args, rest.args);
    if (command.text < incoming_.texts.size()) {
      rest.texts.push_back(incoming_.texts[command.text]);
      command.text = static_cast<std::uint32_t>(rest.texts.size() - 1);
    }
    rest.commands.push_back(command);
  }
  incoming_ = std::move(rest);
  next_ = 0;
}

/// A machine without media and without motion answers queries, as a recorded Portrait did.
void SimCutter::answer_without_media() {
  if (media_ || paused_ || cancelled_until_ || !actions_.empty() || next_point_ != 0) return;
  while (has_commands() && incoming_.commands[next_].verb == Verb::Query) {
    const Command command = incoming_.commands[next_++];
    apply(command);
    executed_ = std::max(executed_, command.end);
    forget_done_commands();
  }
}

void SimCutter::start_next() {
  if (held() && !current_) answer_without_media();
  if (current_ || held()) return;
  lower();
  if (actions_.empty()) {
    // No whole command is left; the reader keeps the bytes of an unfinished one.
    if (!has_commands()) executed_ = accepted_;
    return;
  }
  std::array<Leg, kLookahead> ahead;
  std::size_t known = 0;
  for (const Action& action : actions_) {
    const bool goes_on =
        known == 0 || (action.kind == actions_.front().kind && action.dwell_s == 0);
    if (known == kLookahead || !goes_on || action.kind == ActionKind::Dwell) break;
    ahead[known++] = action.leg;
  }
  Ride ride;
  if (known > 0) {
    const double entry = actions_.front().dwell_s > 0 ? 0 : speed_out_mm_s_;
    ride = ride_first(std::span(ahead).first(known), entry, machine_.motion.accel_mm_s2);
  }
  speed_out_mm_s_ = ride.exit_mm_s;
  current_ = actions_.front();
  actions_.pop_front();
  current_end_ = now_ + bounded_time(ride.seconds + current_->dwell_s);
}

void SimCutter::complete() {
  const Action done = *std::exchange(current_, std::nullopt);
  position_ = done.target;
  switch (done.commit) {
    case Commit::Nothing:
      break;
    case Commit::ToolUp:
      tool_down_ = false;
      break;
    case Commit::ToolDown:
      tool_down_ = true;
      break;
    case Commit::Moved:
      record_move(done.to);
      break;
    case Commit::Drawn:
      record_draw(done);
      break;
  }
  if (done.end_byte > executed_) executed_ = done.end_byte;
  if (steps_ != nullptr && done.end_byte > 0)
    steps_->push_back({done.end_byte, now_, done.whole_command});
  trace_.seconds = std::chrono::duration<double>(now_ - first_byte_.value_or(now_)).count();
}

void SimCutter::record_move(PagePoint to) {
  logical_ = to;
  stroke_open_ = false;
  drawn_dry_since_.reset();
}

void SimCutter::record_draw(const Action& action) {
  const ToolState& state = tools_[static_cast<std::size_t>(tool_)];
  const PagePoint home = bed_.to_page({0, 0});
  if (!stroke_open_) {
    if (trace_.strokes.empty())
      way_in_mm_ = distance(home, action.from);
    else
      trace_.travel_mm += distance(trace_.points.back(), action.from);
    const auto index = static_cast<std::uint32_t>(trace_.points.size());
    const double gf = state.force_steps * machine_.force_gf.per_step;
    trace_.strokes.push_back(
        {index, 1, tool_, state.force_steps, gf, state.speed_mm_s, 0, action.begin_byte});
    trace_.points.push_back(action.from);
    trace_.lifts = trace_.strokes.size();
    stroke_open_ = true;
  }
  TraceStroke& stroke = trace_.strokes.back();
  trace_.points.push_back(action.to);
  ++stroke.count;
  trace_.home_mm = way_in_mm_ + distance(action.to, home);
  const double length = distance(action.from, action.to);
  trace_.cut_mm += length;
  const auto outside = [&](double from, double to) {
    const double mm = (to - from) * length;
    if (!(mm > 1e-6)) return;
    stroke.clipped_mm += mm;
    trace_.clipped_mm += mm;
    trace_.clipped.push_back(along(action.from, action.to, from));
    trace_.clipped.push_back(along(action.from, action.to, to));
  };
  outside(0, action.inside ? action.inside->from : 1);
  if (action.inside) outside(action.inside->to, 1);
  logical_ = action.to;
  if (actions_.empty() && !has_commands()) drawn_dry_since_ = now_;
}

}  // namespace popcut
