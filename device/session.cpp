// SPDX-License-Identifier: MIT
#include "device/session.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "device/inquirer.hpp"
#include "device/schedule.hpp"
#include "device/stroke_journal.hpp"

namespace popcut {
namespace {

using std::chrono::nanoseconds;

nanoseconds to_time(double seconds) { return nanoseconds(std::llround(seconds * 1e9)); }
double to_seconds(nanoseconds time) { return std::chrono::duration<double>(time).count(); }

constexpr std::size_t kMaxWriteBytes = 4096;
// A pause that ends in "ready" with more motion than this outstanding was a cancel that we missed.
constexpr double kMissedCancelS = 1.0;
constexpr double kPausedPollS = 0.2;

Error refused(std::string detail) { return {ErrorKind::Refused, "", std::move(detail)}; }

class Run {
 public:
  Run(Transport& transport, const Machine& machine, const EncodedProgram& program,
      const SessionOptions& options)
      : transport_(transport),
        machine_(machine),
        program_(program),
        options_(options),
        inquirer_(transport, {options.reply_s, options.tries, 0.1}),
        journal_(program, machine, options),
        answers_(program.dialect == Dialect::Gpgl && transport.answers()),
        begun_(transport.now()) {}

  SessionEnd run() {
    Result<Schedule> plan = schedule(program_, machine_);
    if (plan) {
      plan_ = std::move(*plan);
      Result<void> done =
          connect().and_then([&] { return settings(); }).and_then([&] { return search(); });
      done = done.and_then([&] { return geometry(); }).and_then([&] { return park(); });
      if (!done) end_.error = done.error();
    } else {
      end_.error = plan.error();
    }
    journal_.settle(ready_bytes_, good_bytes_, accepted_ + in_doubt_);
    if (!end_.error) end_.error = journal_.failure();
    end_.seconds = to_seconds(transport_.now() - begun_);
    end_.confirmed = answers_ && !end_.error;
    for (const ByteRange& stroke : program_.strokes)
      end_.fates.push_back(
          fate_of(stroke, ready_bytes_, good_bytes_, accepted_ + in_doubt_, machine_.buffer_bytes));
    return std::move(end_);
  }

 private:
  // The phases.
  Result<void> connect();
  Result<void> check_identity();
  Result<void> settings();
  Result<void> search();
  Result<void> geometry();
  Result<void> park();

  // Streaming.
  Result<void> send(std::span<const std::byte> bytes, std::uint64_t& count);
  Result<void> send(ByteRange range, std::uint64_t& at) {
    at = range.begin;
    return send(program_.view(range), at);
  }
  Result<void> send_until(std::uint64_t end);
  [[nodiscard]] std::uint64_t affordable() const;
  [[nodiscard]] bool cancel_asked() const {
    return options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed);
  }

  // Holding.
  [[nodiscard]] bool pause_asked() const {
    return options_.pause != nullptr && options_.pause->load(std::memory_order_relaxed);
  }
  Result<void> hold();
  Result<void> lift();

  // The machine's state.
  Result<void> poll(), look();
  void note_ready(std::uint64_t bytes);
  [[nodiscard]] Result<void> stuck() const;
  [[nodiscard]] Result<void> stopped(DeviceStatus status) const;
  Result<void> sit_out_pause();
  Result<void> wait_ready(double whole_s, double left_s);
  Result<void> wait_ready(double whole_s) { return wait_ready(whole_s, whole_s); }

  // The model's clock: seconds of the geometry that the machine should have behind it.
  [[nodiscard]] double model_s() const {
    return std::min(to_seconds(transport_.now() - model_zero_), sent_s_);
  }
  void set_model(double seconds) { model_zero_ = transport_.now() - to_time(seconds); }

  void tell(SessionPhase phase);

  Transport& transport_;
  const Machine& machine_;
  const EncodedProgram& program_;
  const SessionOptions& options_;
  Inquirer inquirer_;
  StrokeJournal journal_;
  bool answers_;
  nanoseconds begun_;
  Schedule plan_;
  SessionEnd end_;
  SessionPhase phase_{SessionPhase::Connecting};
  std::uint64_t accepted_{}, ready_bytes_{}, good_bytes_{};
  std::uint64_t in_doubt_{};  ///< after `accepted_`, when the last write failed
  DeviceStatus status_{DeviceStatus::Unknown};
  nanoseconds model_zero_{};
  nanoseconds next_poll_{};
  std::optional<nanoseconds> mute_since_;  ///< since when it takes no query
  std::size_t next_command_{};             ///< first of `plan_.geometry` that is not sent
  double sent_s_{};                        ///< when the last command sent should end
  std::size_t strokes_passed_{};
};

void Run::tell(SessionPhase phase) {
  phase_ = phase;
  if (!options_.progress) return;
  // Strokes whose bytes end before the command that the model is at.
  const double now_s = model_s();
  const auto at =
      std::upper_bound(plan_.geometry.begin(), plan_.geometry.end(), now_s,
                       [](double s, const TimedCommand& command) { return s < command.seconds; });
  const std::uint64_t byte = at == plan_.geometry.begin() ? 0 : std::prev(at)->end_byte;
  const auto& strokes = program_.strokes;
  while (strokes_passed_ < strokes.size() && strokes[strokes_passed_].end <= byte)
    ++strokes_passed_;
  double left = plan_.geometry_s - now_s + plan_.trailer_s;
  if (phase == SessionPhase::Connecting || phase == SessionPhase::Settings) left += plan_.setup_s;
  if (phase == SessionPhase::Parking) left = plan_.trailer_s;
  options_.progress({phase, strokes_passed_, strokes.size(), std::max(left, 0.0)});
}

Result<void> Run::connect() {
  tell(SessionPhase::Connecting);
  if (!answers_) return {};
  Result<std::optional<DeviceStatus>> status = std::nullopt;
  for (int i = 0; i < options_.tries && status && !*status; ++i) status = inquirer_.status();
  if (!status) return tl::unexpected(status.error());
  if (!*status)
    return fail(ErrorKind::Timeout, "",
                fmt::format("the machine took no query for {:g} s; is it switched on, and not busy "
                            "with another program?",
                            options_.reply_s * options_.tries));
  if (*status == DeviceStatus::NoMedia)
    return tl::unexpected(refused("no media in the machine; load a sheet, then start again"));
  if (*status == DeviceStatus::Cancelled)
    return tl::unexpected(refused(
        "the last job was cancelled on the panel; wait until the machine is ready, then start "
        "again"));
  status_ = **status;
  if (const Result<void> ready = wait_ready(0); !ready) return ready;
  return check_identity();
}

Result<void> Run::check_identity() {
  Result<Identity> said = fail(ErrorKind::Timeout, "", "");
  for (int i = 0; i < options_.tries && !said; ++i) {
    const Result<std::optional<std::string>> reply = inquirer_.ask(kIdentityQuery);
    if (!reply && reply.error().kind != ErrorKind::Timeout) return tl::unexpected(reply.error());
    if (!reply || !*reply) continue;
    end_.identity = **reply;
    said = parse_identity(**reply);
  }
  if (!said && said.error().kind == ErrorKind::Timeout)
    return fail(ErrorKind::Timeout, "",
                "the machine gave its status but not its name; switch it off and on");
  if (!said)
    return tl::unexpected(
        refused("the machine's name cannot be read; check that it is a " + machine_.title));
  const Result<Identity> meant = parse_identity(machine_.identity);
  if (meant && meant->model != said->model)
    return tl::unexpected(
        refused(fmt::format("the machine says it is a {}, not a {}; give its "
                            "name with --machine",
                            said->model, meant->model)));
  return {};
}

Result<void> Run::settings() {
  tell(SessionPhase::Settings);
  for (const ByteRange& block : program_.setup)
    if (const Result<void> sent = send(block, accepted_); !sent) return sent;
  return wait_ready(plan_.setup_s);
}

/// Registration marks: the machine searches them and answers once, without being asked. Until then
/// nothing else is asked, since replies do not say what they answer.
Result<void> Run::search() {
  if (program_.search.begin == program_.search.end) return {};
  tell(SessionPhase::Searching);
  if (!answers_) return send(program_.search, accepted_);  // a file
  constexpr double kLongestS = 40;
  if (const Result<void> clean = inquirer_.forget(); !clean) return clean;
  if (const Result<void> sent = send(program_.search, accepted_); !sent) return sent;
  Result<std::string> reply = fail(ErrorKind::Timeout, "", "");
  for (double waited = 0; waited < kLongestS; waited += options_.poll_s) {
    reply = inquirer_.await(options_.poll_s);
    if (reply || reply.error().kind != ErrorKind::Timeout) break;
    if (cancel_asked()) {
      end_.cancelled = true;
      return tl::unexpected(
          refused("cancelled while the machine searched the registration marks; nothing was cut"));
    }
    tell(SessionPhase::Searching);
  }
  if (!reply && reply.error().kind == ErrorKind::Timeout)
    return fail(
        ErrorKind::Timeout, "",
        fmt::format("the machine did not say within {:g} s whether it found the registration "
                    "marks; nothing was cut",
                    kLongestS));
  if (!reply) return tl::unexpected(reply.error());
  const Result<double> found = parse_number(*reply);
  if (!found || *found != 0)
    return tl::unexpected(
        refused("the registration marks were not found, and nothing was cut; see that the sheet is "
                "printed at 100 %, lies as the plan says, and has its square at the upper left"));
  return wait_ready(plan_.setup_s);
}

std::uint64_t Run::affordable() const {
  const std::uint64_t end =
      affordable_end(plan_, next_command_, sent_s_, model_s(), options_.window_s, kMaxWriteBytes);
  return std::max(end, accepted_);
}

Result<void> Run::geometry() {
  tell(SessionPhase::Cutting);
  accepted_ = std::max(accepted_, program_.geometry.begin);
  sent_s_ = 0;
  set_model(0);
  next_poll_ = transport_.now() + to_time(options_.poll_s);
  std::uint64_t end = program_.geometry.end;
  const std::uint64_t nowhere = end;
  std::uint64_t hold_at = nowhere;
  bool stopping = false;
  while (accepted_ < end) {
    if (stopping || !pause_asked())
      hold_at = nowhere;
    else if (hold_at == nowhere)
      hold_at = stroke_end_after(program_, accepted_);
    if (accepted_ == hold_at) {
      if (const Result<void> held = hold(); !held) return held;
      hold_at = nowhere;
    }
    if (!stopping && (cancel_asked() || journal_.failure())) {
      stopping = true;
      end_.cancelled = cancel_asked();
      end = stroke_end_after(program_, accepted_);
      continue;
    }
    if (transport_.now() >= next_poll_) {
      if (const Result<void> polled = poll(); !polled) return polled;
      tell(SessionPhase::Cutting);
    }
    // The model stands still at what was sent: a machine that has nothing to do is not ahead of us.
    set_model(model_s());
    const std::uint64_t until = std::min({affordable(), end, hold_at});
    if (until > accepted_) {
      if (!stopping && !journal_.intend(until)) continue;
      if (const Result<void> sent = send_until(until); !sent) return sent;
      continue;
    }
    const double spare = sent_s_ - model_s() - 0.75 * options_.window_s;
    const nanoseconds nap = std::min(to_time(std::max(spare, 0.01)), next_poll_ - transport_.now());
    transport_.wait(std::max(nap, nanoseconds(1'000'000)));
  }
  tell(SessionPhase::Finishing);
  return wait_ready(plan_.geometry_s, sent_s_ - model_s());
}

/// The tool is lifted where the last stroke ends: the end of a stroke alone leaves it in the sheet.
/// These bytes belong to no stroke, and the ledger does not count them.
Result<void> Run::lift() {
  const std::string bytes = lift_at(program_, accepted_);
  std::uint64_t count = 0;
  return send(std::as_bytes(std::span(bytes)), count);
}

/// Waits at the end of a stroke, with the tool up, until the host lets the job go on or ends it.
Result<void> Run::hold() {
  const Result<void> at_rest = lift().and_then([&] {
    tell(SessionPhase::Held);
    return wait_ready(plan_.geometry_s, sent_s_ - model_s());
  });
  if (!at_rest) return at_rest;
  while (pause_asked() && !cancel_asked() && !journal_.failure()) {
    tell(SessionPhase::Held);
    transport_.wait(to_time(kPausedPollS));
    if (transport_.now() < next_poll_) continue;
    if (const Result<void> polled = poll(); !polled) return polled;
  }
  set_model(sent_s_);
  tell(SessionPhase::Cutting);
  return {};
}

Result<void> Run::park() {
  tell(SessionPhase::Parking);
  // After a cancel the rest of the geometry is left out: the trailer comes next.
  std::uint64_t at = program_.trailer.begin;
  return send(program_.trailer, at).and_then([&] { return wait_ready(plan_.trailer_s); });
}

Result<void> Run::send_until(std::uint64_t end) {
  const Result<void> sent = send({accepted_, end}, accepted_);
  while (next_command_ < plan_.geometry.size() &&
         plan_.geometry[next_command_].end_byte <= accepted_)
    sent_s_ = plan_.geometry[next_command_++].seconds;
  return sent;
}

/// Sends bytes and adds to `count` what was accepted, also on error. Back-pressure is no fault: the
/// rest follows from the exact byte.
Result<void> Run::send(std::span<const std::byte> bytes, std::uint64_t& count) {
  constexpr double kSliceS = 0.25;
  nanoseconds moved = transport_.now();
  while (!bytes.empty()) {
    const Result<bool> paid = inquirer_.pay_debt(transport_.now() + to_time(kSliceS));
    if (!paid) return tl::unexpected(paid.error());
    const std::size_t piece = *paid ? std::min(bytes.size(), kMaxWriteBytes) : 0;
    const Transport::WriteEnd end =
        transport_.write(bytes.first(piece), transport_.now() + to_time(kSliceS));
    bytes = bytes.subspan(end.taken);
    count += end.taken;
    if (end.error && end.error->kind != ErrorKind::Timeout) {
      if (&count == &accepted_) in_doubt_ = end.in_doubt;
      return tl::unexpected(*end.error);
    }
    if (end.taken > 0) {
      moved = transport_.now();
      continue;
    }
    if (cancel_asked()) {
      end_.cancelled = true;
      return tl::unexpected(refused(
          "cancelled while the machine takes no data; stop it on its panel, what it already has "
          "may still be cut"));
    }
    if (to_seconds(transport_.now() - moved) > options_.stuck_s) return stuck();
    transport_.wait(nanoseconds(1'000'000));
    tell(phase_);
  }
  return {};
}

Result<void> Run::stuck() const {
  return fail(ErrorKind::Timeout, "",
              fmt::format("the machine has taken no data for {:g} s; see whether it is paused or "
                          "jammed",
                          options_.stuck_s));
}

void Run::note_ready(std::uint64_t bytes) {
  ready_bytes_ = good_bytes_ = bytes;
  set_model(sent_s_);
}

Result<void> Run::poll() {
  const Result<void> looked = look();
  journal_.settle(ready_bytes_, good_bytes_, accepted_);
  return looked;
}

Result<void> Run::look() {
  next_poll_ = transport_.now() + to_time(options_.poll_s);
  const std::uint64_t asked = accepted_;
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
      return {};  // busy with what it has: it takes no query
    case DeviceStatus::Ready:
      note_ready(asked);
      return {};
    case DeviceStatus::Moving:
      good_bytes_ = asked;
      return {};
    case DeviceStatus::Paused:
      good_bytes_ = asked;
      return sit_out_pause();
    default:
      return stopped(status_);
  }
}

Result<void> Run::stopped(DeviceStatus status) const {
  if (status == DeviceStatus::NoMedia)
    return tl::unexpected(
        refused("the sheet came out of the machine; what it had not cut is lost"));
  return tl::unexpected(refused("the job was cancelled on the machine's panel"));
}

Result<void> Run::sit_out_pause() {
  const SessionPhase phase = phase_;
  const double model_before = model_s();
  const nanoseconds since = transport_.now();
  for (;;) {
    set_model(model_before);
    tell(SessionPhase::Paused);
    transport_.wait(to_time(kPausedPollS));
    const std::uint64_t asked = accepted_;
    const Result<std::optional<DeviceStatus>> status = inquirer_.status();
    if (!status) return tl::unexpected(status.error());
    status_ = status->value_or(DeviceStatus::Paused);
    set_model(model_before);
    if (status_ == DeviceStatus::Ready && sent_s_ - model_before > kMissedCancelS)
      return stopped(DeviceStatus::Cancelled);
    if (status_ == DeviceStatus::NoMedia || status_ == DeviceStatus::Cancelled)
      return stopped(status_);
    if (status_ != DeviceStatus::Paused) {
      if (status_ == DeviceStatus::Ready) note_ready(asked);
      next_poll_ = transport_.now() + to_time(options_.poll_s);
      tell(phase);
      return {};
    }
    if (cancel_asked()) {
      end_.cancelled = true;
      return tl::unexpected(refused(
          "cancelled while the machine is paused; cancel it on its panel too, what it already has "
          "would be cut"));
    }
    if (to_seconds(transport_.now() - since) > options_.pause_limit_s)
      return tl::unexpected(
          refused(fmt::format("the machine was paused on its panel for {:g} s; the job is given up",
                              options_.pause_limit_s)));
  }
}

/// Waits until the machine says ready. It is given up when it takes three times as long as all of
/// its phase should: `whole_s`. One that answers nothing is given the `left_s` that its model says.
Result<void> Run::wait_ready(double whole_s, double left_s) {
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
    if (waited > 3 * whole_s + options_.stuck_s)
      return fail(
          ErrorKind::Timeout, "",
          fmt::format("the machine is still busy after {:.0f} s; see what it is doing", waited));
    tell(phase_);
    const nanoseconds polled_at = transport_.now();
    transport_.wait(to_time(options_.poll_s));
    // A pause, which the poll sits out, does not count.
    waited += to_seconds(transport_.now() - polled_at) +
              std::min(to_seconds(polled_at - before), options_.reply_s);
  }
}

}  // namespace

SessionEnd run_session(Transport& transport, const Machine& machine, const EncodedProgram& program,
                       const SessionOptions& options) {
  if (options.first_stroke > 0) return run_rest(transport, machine, program, options);
  return Run(transport, machine, program, options).run();
}

}  // namespace popcut
