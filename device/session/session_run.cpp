// SPDX-License-Identifier: MIT
#include "device/session/session_run.hpp"

#include <algorithm>
#include <new>

#include <fmt/format.h>

namespace popcut {
namespace {

using std::chrono::nanoseconds;

constexpr std::size_t kMaxWriteBytes = 4096;
// A machine that is ready so much sooner than it can be, after a pause, was cancelled unseen.
constexpr double kMissedCancelS = 1.0;
// Less motion than this may end between two queries, whatever the model says.
constexpr double kSurelyDoneS = 0.2;
constexpr double kPausedPollS = 0.2;
// Longer than a machine with a full buffer ignores queries; after that a cancel does not wait.
constexpr double kLongMuteS = 5;

}  // namespace

SessionEnd SessionRun::run() {
  end_.fates.reserve(program_.strokes.size());
  try {
    if (const Result<void> done = phases(); !done) end_.error = done.error();
    journal_.settle(ready_bytes_, good_bytes_, accepted_ + in_doubt_);
    if (!end_.error) end_.error = journal_.failure();
  } catch (const std::bad_alloc&) {
    lift_without_memory();
    end_.error =
        Error{ErrorKind::Internal, "", "out of memory"};  // short enough to need no allocation
  }
  end_.seconds = to_seconds(transport_.now() - begun_);
  end_.confirmed = answers_ && !end_.error;
  if (end_.error && phase_ >= SessionPhase::Cutting) end_.likely_stroke = likely_stroke();
  const std::vector<std::uint64_t>& lines = journal_.first_lines();
  for (std::size_t k = 0; k < lines.size(); ++k)
    end_.fates.push_back(fate_of({lines[k], program_.strokes[k].end}, ready_bytes_, good_bytes_,
                                 accepted_ + in_doubt_, machine_.buffer_bytes));
  return std::move(end_);
}

/// Up to which byte a machine has done all commands that end within `seconds` of the geometry.
std::uint64_t SessionRun::byte_at(double seconds) const {
  const auto at =
      std::upper_bound(plan_.geometry.begin(), plan_.geometry.end(), seconds,
                       [](double s, const TimedCommand& command) { return s < command.seconds; });
  return at == plan_.geometry.begin() ? 0 : std::prev(at)->end_byte;
}

/// The stroke in which the knife is now: the first that ends after where the model is.
std::optional<std::size_t> SessionRun::likely_stroke() {
  const auto& strokes = program_.strokes;
  const auto found = std::upper_bound(
      strokes.begin(), strokes.end(), byte_at(model_s()),
      [](std::uint64_t value, const ByteRange& stroke) { return value < stroke.end; });
  // It has not gone beyond what was sent.
  const std::vector<std::uint64_t>& lines = journal_.first_lines();
  const auto sent = std::lower_bound(lines.begin(), lines.end(), accepted_ + in_doubt_);
  const auto at_stroke =
      std::min(found - strokes.begin(), static_cast<std::ptrdiff_t>(sent - lines.begin()) - 1);
  if (at_stroke < 0) return std::nullopt;
  const auto index = static_cast<std::size_t>(at_stroke);
  if (strokes[index].end <= ready_bytes_) return std::nullopt;
  return index;
}

/// Sends the trailer (tool up and parked) if the bytes sent so far end with a whole command.
void SessionRun::lift_without_memory() {
  const std::uint64_t whole =
      next_command_ == 0 ? program_.geometry.begin : plan_.geometry[next_command_ - 1].end_byte;
  if (in_doubt_ > 0 || phase_ == SessionPhase::Parking || accepted_ != whole) return;
  try {
    std::uint64_t at = program_.trailer.begin;
    (void)send(program_.trailer, at);
  } catch (const std::bad_alloc&) {
    end_.remarks.clear();  // the tool stays where it is; the fates are those of the bytes sent
  }
}

void SessionRun::report(SessionPhase phase) {
  phase_ = phase;
  if (!options_.progress) return;
  // Strokes that end before the command at which the model is.
  const double now_s = model_s();
  const std::uint64_t byte = byte_at(now_s);
  const auto& strokes = program_.strokes;
  while (strokes_passed_ < strokes.size() && strokes[strokes_passed_].end <= byte)
    ++strokes_passed_;
  double left = (plan_.geometry_s - now_s) / pace_.rate() + plan_.trailer_s + plan_.feed_out_s;
  if (phase == SessionPhase::Connecting || phase == SessionPhase::Settings) left += plan_.setup_s;
  if (phase == SessionPhase::Parking) left = plan_.trailer_s + plan_.feed_out_s;
  options_.progress({phase, strokes_passed_, strokes.size(), std::max(left, 0.0), mute_s(), asks_});
}

Result<void> SessionRun::phases() {
  Result<Schedule> plan = schedule(program_, machine_, journal_.first_lines());
  if (!plan) return tl::unexpected(plan.error());
  plan_ = std::move(*plan);
  Time from{};
  const auto timed = [&](double& seconds, Result<void> done) {
    const Time to = answers_ && rested_at_ > from ? rested_at_ : transport_.now();
    if (done) seconds = to_seconds(to - from);
    from = transport_.now();
    return done;
  };
  double unused = 0;
  return timed(unused, connect())
      .and_then([&] { return timed(end_.setup_s, settings()); })
      .and_then([&] { return timed(unused, search()); })
      .and_then([&] { return timed(end_.geometry_s, geometry()); })
      .and_then([&] { return timed(end_.trailer_s, park()); });
}

std::uint64_t SessionRun::affordable() {
  pace_.advance(transport_.now(), sent_s_);
  const Whereabouts machine{pace_.least_s(), pace_.most_s(), pace_.slow(), pace_.fast()};
  const std::uint64_t end =
      affordable_end(plan_, next_command_, sent_s_, machine, options_.window_s, kMaxWriteBytes);
  return std::max(end, accepted_);
}

Result<void> SessionRun::geometry() {
  report(SessionPhase::Cutting);
  accepted_ = std::max(accepted_, program_.geometry.begin);
  sent_s_ = 0;
  pace_.start(transport_.now(), 0);
  next_poll_ = transport_.now() + to_time(options_.poll_s);
  std::uint64_t end = program_.geometry.end;
  const std::uint64_t nowhere = end;
  std::uint64_t hold_at = nowhere;
  std::uint64_t sync_at = nowhere;
  bool stopping = false;
  while (accepted_ < end) {
    // First, since whoever sees the progress may ask for a stop.
    if (transport_.now() >= next_poll_) {
      if (const Result<void> polled = poll(); !polled) return polled;
      report(SessionPhase::Cutting);
    }
    if (stopping || !pause_asked())
      hold_at = nowhere;
    else if (hold_at == nowhere)
      hold_at = journal_.stop_after(accepted_);
    if (accepted_ == hold_at) {
      if (const Result<void> held = hold(); !held) return held;
      hold_at = nowhere;
    }
    if (sync_at == nowhere && !options_.timed && pace_.sync_due())
      sync_at = journal_.stop_after(accepted_);
    if (accepted_ == sync_at) {
      if (const Result<void> synced = synchronise(); !synced) return synced;
      sync_at = nowhere;
      continue;  // somebody may have asked for a pause meanwhile
    }
    if (give_up_asked()) return give_up();
    if (!stopping && (cancel_asked() || journal_.failure())) {
      stopping = true;
      end_.cancelled = cancel_asked();
      end = journal_.stop_after(accepted_);
      continue;
    }
    const std::uint64_t until = std::min({affordable(), end, hold_at, sync_at});
    if (until > accepted_) {
      if (!stopping && !journal_.intend(until)) continue;
      if (const Result<void> sent = send_until(until); !sent) return sent;
      continue;
    }
    // Until the machine, at its fastest, has half of what it must never be short of.
    const double spare = (sent_s_ - pace_.most_s()) / pace_.fast() - 0.25 * options_.window_s;
    const nanoseconds nap = std::min(to_time(std::clamp(spare, 0.01, 0.25 * options_.window_s)),
                                     next_poll_ - transport_.now());
    transport_.wait(std::max(nap, nanoseconds(1'000'000)));
  }
  report(SessionPhase::Finishing);
  Result<void> ready = wait_ready(slowest_left_s(), left_s());
  if (ready || ready.error().kind != ErrorKind::Timeout || status_ != DeviceStatus::Moving)
    return ready;
  // All was sent, and the machine should have done it long ago. The trailer lifts the tool, should
  // it be down, and cuts nothing.
  std::uint64_t at = program_.trailer.begin;
  if (const Result<void> sent = send(program_.trailer, at); !sent) return sent;
  return fail(ErrorKind::Timeout, "",
              ready.error().detail +
                  ". All was sent, also the end of the job, which lifts the tool and parks");
}

/// Waits at the end of a stroke, with the tool up, until the machine has done all that was sent:
/// then all of it is certain, and how long it took corrects the model's speed.
Result<void> SessionRun::synchronise() {
  constexpr double kNapS = 0.1;
  return lift().and_then([&] { return wait_ready(slowest_left_s(), left_s(), kNapS); });
}

/// Lifts the tool where a stroke ends: the end of a stroke alone leaves it in the sheet.
/// These bytes belong to no stroke, and the ledger does not count them.
Result<void> SessionRun::lift() {
  const std::string bytes = journal_.lift_at(accepted_);
  std::uint64_t count = 0;
  return send(std::as_bytes(std::span(bytes)), count);
}

/// Waits at the end of a stroke, with the tool up, until the host continues or ends the job.
Result<void> SessionRun::hold() {
  Result<void> at_rest = lift().and_then([&] {
    report(SessionPhase::Held);
    return wait_ready(slowest_left_s(), left_s());
  });
  if (!at_rest) return at_rest;
  return stay();
}

/// Held, with the tool up and the machine at rest, until the host continues or ends the job.
Result<void> SessionRun::stay() {
  while (pause_asked() && !cancel_asked() && !give_up_asked() && !journal_.failure()) {
    report(SessionPhase::Held);
    transport_.wait(to_time(kPausedPollS));
    if (transport_.now() < next_poll_) continue;
    if (const Result<void> polled = poll(); !polled) return polled;
  }
  pace_.start(transport_.now(), sent_s_);
  asks_ = false;
  report(SessionPhase::Cutting);
  return {};
}

/// Ends after a whole command without waiting for the machine.
Result<void> SessionRun::give_up() {
  end_.cancelled = true;
  std::uint64_t at = program_.trailer.begin;
  if (phase_ != SessionPhase::Parking)
    if (const Result<void> sent = send(program_.trailer, at); !sent) return sent;
  return tl::unexpected(refused(
      "stopped while the machine was busy; it still cuts what it has received, then parks"));
}

Result<void> SessionRun::park() {
  report(SessionPhase::Parking);
  // After a cancel the rest of the geometry is skipped and the trailer follows.
  std::uint64_t at = program_.trailer.begin;
  Result<void> parked =
      send(program_.trailer, at).and_then([&] { return wait_ready(plan_.trailer_s); });
  // What was stopped stays where it can be continued.
  if (parked && !end_.cancelled && program_.feed_out.begin < program_.feed_out.end)
    parked = send(program_.feed_out, at = program_.feed_out.begin).and_then([&] {
      return wait_ready(plan_.feed_out_s);
    });
  const bool moves = !parked && parked.error().kind == ErrorKind::Timeout &&
                     status_ == DeviceStatus::Moving && ready_bytes_ >= accepted_;
  if (!moves) return parked;
  // All strokes are certain: what failed is only the way home.
  end_.remarks.push_back(
      "the machine was ready after the last stroke, but still says that it moves after the way to "
      "its park position; check that its tool is up, then switch it off and on");
  return {};
}

/// Sends the program's bytes from `accepted_` to `end`, without those of `left_out_`.
Result<void> SessionRun::send_program(std::uint64_t end) {
  Result<void> sent;
  while (sent && accepted_ < end) {
    const auto next = std::find_if(left_out_.begin(), left_out_.end(),
                                   [&](const ByteRange& range) { return range.end > accepted_; });
    const ByteRange gap = next == left_out_.end() ? ByteRange{end, end} : *next;
    if (gap.begin <= accepted_)
      accepted_ = std::min(gap.end, end);
    else
      sent = send({accepted_, std::min(gap.begin, end)}, accepted_);
  }
  return sent;
}

Result<void> SessionRun::send_until(std::uint64_t end) {
  Result<void> sent = send_program(end);
  while (next_command_ < plan_.geometry.size() &&
         plan_.geometry[next_command_].end_byte <= accepted_)
    sent_s_ = plan_.geometry[next_command_++].seconds;
  return sent;
}

/// Sends bytes and adds the accepted ones to `count`, also on error. Back-pressure is no fault:
/// sending continues at the exact byte.
Result<void> SessionRun::send(std::span<const std::byte> bytes, std::uint64_t& count) {
  constexpr double kSliceS = 0.25;
  while (!bytes.empty()) {
    const nanoseconds before = transport_.now();
    const Result<bool> paid = inquirer_.pay_debt(transport_.now() + to_time(kSliceS));
    if (!paid) return tl::unexpected(paid.error());
    const std::size_t piece = *paid ? std::min(bytes.size(), kMaxWriteBytes) : 0;
    const bool counted = &count == &accepted_;
    if (counted) in_doubt_ = piece;  // in case there is no memory to report how it ended
    const Transport::WriteEnd end =
        transport_.write(bytes.first(piece), transport_.now() + to_time(kSliceS));
    bytes = bytes.subspan(end.taken);
    count += end.taken;
    const bool failed = end.error && end.error->kind != ErrorKind::Timeout;
    if (counted) in_doubt_ = failed ? end.in_doubt : 0;
    if (failed) return tl::unexpected(*end.error);
    if (end.taken > 0) {
      mute_since_.reset();
      continue;
    }
    if (!mute_since_) mute_since_ = before;
    if (cancel_asked() || give_up_asked()) {
      end_.cancelled = true;
      return tl::unexpected(refused(
          "cancelled while the machine takes no data; stop it on its panel, or it may still cut "
          "what it has received"));
    }
    if (to_seconds(transport_.now() - *mute_since_) > options_.stuck_s) return stuck();
    transport_.wait(nanoseconds(1'000'000));
    report(phase_);
  }
  return {};
}

Result<void> SessionRun::stuck() const {
  return fail(ErrorKind::Timeout, "",
              fmt::format("the machine has taken no data for {:g} s; check whether it is paused or "
                          "jammed",
                          options_.stuck_s));
}

/// The machine is at rest: it has done all that it had when it was asked.
void SessionRun::note_ready(std::uint64_t bytes, Time asked_at) {
  ready_bytes_ = good_bytes_ = bytes;
  // It may have waited for more since before the last query that it answered "moving".
  const Time earliest = std::min(busy_at_, asked_at);
  const bool waited = to_seconds(asked_at - earliest) > 0.3;
  // It last moved within a poll of now, or nobody saw it move.
  rested_at_ =
      to_seconds(asked_at - earliest) < 2 * options_.poll_s ? (earliest + asked_at) / 2 : asked_at;
  pace_.rest(asked_at, earliest, sent_s_, waited);
}

Result<void> SessionRun::poll() {
  Result<void> looked = look();
  journal_.settle(ready_bytes_, good_bytes_, accepted_);
  return looked;
}

Result<void> SessionRun::look() {
  next_poll_ = transport_.now() + to_time(options_.poll_s);
  const std::uint64_t asked = accepted_;
  const Time asked_at = transport_.now();
  if (!answers_) {
    good_bytes_ = asked - std::min<std::uint64_t>(asked, transport_.in_transit());
    return {};
  }
  const Result<std::optional<DeviceStatus>> status = inquirer_.status();
  if (!status) return tl::unexpected(status.error());
  status_ = status->value_or(DeviceStatus::Unknown);
  if (*status)
    mute_since_.reset();
  else if (!mute_since_)
    mute_since_ = transport_.now();
  if (mute_since_ && to_seconds(transport_.now() - *mute_since_) > options_.stuck_s) return stuck();
  switch (status_) {
    case DeviceStatus::Unknown:
      return {};  // busy: it accepts no query
    case DeviceStatus::Ready:
      note_ready(asked, asked_at);
      return {};
    case DeviceStatus::Moving:
      good_bytes_ = asked;
      busy_at_ = asked_at;
      return {};
    case DeviceStatus::Paused:
      good_bytes_ = asked;
      return sit_out_pause();
    default:
      return stopped(status_);
  }
}

Result<void> SessionRun::stopped(DeviceStatus status) const {
  if (status == DeviceStatus::NoMedia)
    return tl::unexpected(refused("the sheet came out of the machine; the rest of it was not cut",
                                  ErrorReason::NoMedia));
  return tl::unexpected(
      refused("the job was cancelled on the machine's panel", ErrorReason::PanelStop));
}

std::optional<std::string> SessionRun::window_reply() {
  const Result<std::optional<std::string>> reply = inquirer_.ask(kWindowQuery);
  if (!reply || !*reply || !parse_numbers(**reply, 2, 2)) return std::nullopt;
  return **reply;
}

/// After a pause the machine is ready, and nobody saw it move. Either it went on and has done all
/// that it had, or the job was cancelled on the panel, which also resets the machine. `unseen_s` is
/// the time since it last said that it is paused.
///
/// A machine that was reset reports another window than the one that was set. One that cannot have
/// finished in the time was cancelled. Whatever is then still open, a person is asked.
Result<void> SessionRun::check_resumed(double unseen_s) {
  const double least_left_s = (sent_s_ - pace_.most_s()) / pace_.fast();
  const double most_left_s = (sent_s_ - pace_.least_s()) / pace_.slow();
  const std::optional<std::string> window = window_said_ ? window_reply() : std::nullopt;
  if (window && *window != *window_said_) return stopped(DeviceStatus::Cancelled);
  const double likely_left_s = (sent_s_ - pace_.at_s()) / pace_.rate();
  if (window ? likely_left_s <= unseen_s + kMissedCancelS : most_left_s <= unseen_s + kSurelyDoneS)
    return {};
  if (!window && least_left_s > unseen_s + kMissedCancelS) return stopped(DeviceStatus::Cancelled);
  if (!options_.ask || options_.pause == nullptr)
    return tl::unexpected(refused(
        "the machine was paused on its panel and then ready, and popcut cannot tell whether "
        "the job was cancelled there; look at the sheet",
        ErrorReason::PanelStop));
  asks_ = true;
  options_.ask();
  return stay().and_then([&]() -> Result<void> {
    if (cancel_asked() || give_up_asked()) {
      end_.cancelled = true;
      return tl::unexpected(refused("cancelled after a pause on the machine's panel"));
    }
    return {};
  });
}

Result<void> SessionRun::sit_out_pause() {
  const SessionPhase phase = phase_;
  pace_.advance(transport_.now(), sent_s_);
  const nanoseconds since = transport_.now();
  nanoseconds last_paused = since;
  for (;;) {
    pace_.stand_still(transport_.now());
    report(SessionPhase::Paused);
    transport_.wait(to_time(kPausedPollS));
    const std::uint64_t asked = accepted_;
    const nanoseconds asked_at = transport_.now();
    const Result<std::optional<DeviceStatus>> status = inquirer_.status();
    if (!status) return tl::unexpected(status.error());
    status_ = status->value_or(DeviceStatus::Paused);
    pace_.stand_still(transport_.now());
    if (status_ == DeviceStatus::Ready)
      if (const Result<void> sure = check_resumed(to_seconds(transport_.now() - last_paused));
          !sure)
        return sure;
    last_paused = asked_at;
    if (status_ == DeviceStatus::NoMedia || status_ == DeviceStatus::Cancelled)
      return stopped(status_);
    if (status_ != DeviceStatus::Paused) {
      if (status_ == DeviceStatus::Ready) note_ready(asked, asked_at);
      next_poll_ = transport_.now() + to_time(options_.poll_s);
      report(phase);
      return {};
    }
    if (cancel_asked() || give_up_asked()) {
      end_.cancelled = true;
      return tl::unexpected(refused(
          "cancelled while the machine is paused; cancel it on its panel too, or it will cut what "
          "it has received"));
    }
    if (to_seconds(transport_.now() - since) > options_.pause_limit_s)
      return tl::unexpected(
          refused(fmt::format("the machine was paused on its panel for {:g} s; the job was ended",
                              options_.pause_limit_s),
                  ErrorReason::PanelStop));
  }
}

/// Waits until the machine reports ready, at most three times `whole_s`, the estimate for the whole
/// phase. For a machine that answers nothing, waits `left_s`, the estimate for what is left.
Result<void> SessionRun::wait_ready(double whole_s, double left_s, double nap_s) {
  if (!answers_) {
    transport_.wait(to_time(std::max(left_s, 0.0)));
    good_bytes_ = accepted_ - std::min<std::uint64_t>(accepted_, transport_.in_transit());
    return {};
  }
  double waited = 0;
  for (;;) {
    const nanoseconds before = transport_.now();
    if (const Result<void> polled = poll(); !polled) return polled;
    if (status_ == DeviceStatus::Ready) return {};
    if (cancel_asked() && phase_ < SessionPhase::Searching) {
      end_.cancelled = true;
      return tl::unexpected(refused("cancelled while the machine was busy; nothing was cut"));
    }
    if (give_up_asked() || (cancel_asked() && mute_s() > kLongMuteS)) return give_up();
    if (waited > 3 * whole_s + options_.stuck_s)
      return fail(
          ErrorKind::Timeout, "",
          fmt::format(
              "the machine is still busy after {:.0f} s, where {:.0f} s were expected; check "
              "what it is doing",
              waited, left_s));
    report(phase_);
    const nanoseconds polled_at = transport_.now();
    transport_.wait(to_time(nap_s));
    // A pause, which the poll waits out, does not count.
    waited += to_seconds(transport_.now() - polled_at) +
              std::min(to_seconds(polled_at - before), options_.reply_s);
  }
}

}  // namespace popcut
