// SPDX-License-Identifier: MIT
#include "daemon/devices/cutter.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "device/doctor.hpp"
#include "protocol/replies.hpp"

namespace popcut::daemon {
namespace {

using std::chrono::steady_clock;

// Without memory a thread that has a cutter waits for some rather than take popcutd down with it.
template <typename Work>
void insist(Work work) {
  constexpr int kTries = 100;
  for (int tries = 1;; ++tries) {
    try {
      return work();
    } catch (const std::bad_alloc&) {
      if (tries == kTries) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

DeviceRecord record_of(const CutterLine& line, bool enabled) {
  DeviceRecord record;
  record.id = line.device.text;
  record.model = line.machine.name;
  record.title = line.machine.title;
  record.enabled = enabled;
  record.simulated = line.simulated();
  record.width_mm = line.machine.width_mm;
  record.length_mm = line.machine.length_mm;
  for (const Mat& mat : line.machine.mats) {
    record.width_mm = std::max(record.width_mm, mat.width_mm);
    record.length_mm = std::max(record.length_mm, mat.length_mm);
  }
  return record;
}

}  // namespace

Cutter::Cutter(CutterLine line, bool enabled, const SessionOptions& session,
               std::function<void()> changed)
    : line_(std::move(line)),
      options_(session),
      changed_(std::move(changed)),
      record_(record_of(line_, enabled)) {
  refresh();
  thread_ = std::thread([this] { serve(); });
}

Cutter::~Cutter() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  cancel_ = true;
  wake_.notify_all();
  thread_.join();
}

DeviceRecord Cutter::record() const {
  const std::lock_guard lock(mutex_);
  return record_;
}

bool Cutter::busy() const {
  const std::lock_guard lock(mutex_);
  return cutting_ || next_;
}

bool Cutter::at_rest() const {
  const std::lock_guard lock(mutex_);
  return !cutting_ && !next_ && !telling_;
}

bool Cutter::refresh() {
  std::string state = "idle";
  std::vector<std::string> reasons;
  if (cutting_ || next_) {
    state = "busy";
  } else if (!there_) {
    state = "absent";
  } else if (!hindrance_.empty()) {
    state = "offline";
    reasons = {hindrance_};
  } else if (condition_ != Condition::None) {
    state = condition_ == Condition::Fault ? "fault" : "attention";
    reasons = {condition_text_};
  }
  if (record_.state == state && record_.reasons == reasons) return false;
  record_.state = std::move(state);
  record_.reasons = std::move(reasons);
  ++record_.rev;
  return true;
}

void Cutter::tell() const {
  if (changed_) changed_();
}

void Cutter::set_presence(bool there, const std::string& hindrance, const std::string& node) {
  {
    const std::lock_guard lock(mutex_);
    const bool moved = there && !node.empty() && !node_.empty() && node != node_;
    if (there && !node.empty()) node_ = node;
    // Plugged in again, it may be another machine: earlier faults no longer count.
    const bool replugged = (!there_ && there) || moved;
    if (replugged) {
      condition_ = Condition::None;
      ++record_.plugs;
    }
    there_ = there;
    hindrance_ = hindrance;
    if (!refresh() && !replugged) return;
  }
  tell();
}

Result<void> Cutter::cut(CutOrder order, std::shared_ptr<CutJournal> journal) {
  {
    const std::lock_guard lock(mutex_);
    const std::string& id = record_.id;
    if (stopping_) return fail(ErrorKind::Refused, id, "popcutd is stopping; start it again later");
    if (cutting_ || next_)
      return fail(ErrorKind::Refused, id, "is cutting; wait until it has finished");
    if (!there_) return fail(ErrorKind::DeviceGone, id, "is unplugged or switched off");
    if (!hindrance_.empty()) return fail(ErrorKind::Refused, id, hindrance_);
    if (condition_ == Condition::Fault)
      return fail(ErrorKind::Refused, id, condition_text_ + "; fix it, then reset the device");
    cancel_ = false;
    pause_ = false;
    condition_ = Condition::None;
    next_ = Work{std::move(order), std::move(journal)};
  }
  wake_.notify_all();
  // It is taken, whatever becomes of the news.
  try {
    {
      const std::lock_guard lock(mutex_);
      refresh();
    }
    tell();
  } catch (const std::bad_alloc&) {
  }
  return {};
}

Result<void> Cutter::reset() {
  std::unique_lock lock(mutex_);
  if (cutting_ || next_)
    return fail(ErrorKind::Refused, record_.id, "is cutting; cancel the job first");
  if (!there_) return fail(ErrorKind::DeviceGone, record_.id, "is unplugged or switched off");
  const std::uint64_t before = resets_done_;
  reset_wanted_ = true;
  wake_.notify_all();
  constexpr auto kMost = std::chrono::seconds(20);
  const bool done = wake_.wait_for(lock, kMost, [&] { return resets_done_ > before || stopping_; });
  if (!done) return fail(ErrorKind::Timeout, record_.id, "is not answering; switch it off and on");
  if (condition_ != Condition::None) return fail(ErrorKind::Refused, record_.id, condition_text_);
  return {};
}

void Cutter::serve() {
  std::unique_lock lock(mutex_);
  for (;;) {
    touch();
    if (next_) {
      Work work = std::move(*next_);
      next_.reset();
      cutting_ = true;
      lock.unlock();
      carry_out(std::move(work));
      lock.lock();
      continue;
    }
    if (std::exchange(reset_wanted_, false)) {
      lock.unlock();
      insist([&] { ask_state(); });
      lock.lock();
      ++resets_done_;
      wake_.notify_all();
      continue;
    }
    if (stopping_) return;
    wake_.wait_for(lock, std::chrono::seconds(1));
  }
}

SessionEnd Cutter::session(const Work& work, std::int64_t& last_intended) {
  SessionEnd end;
  auto open = OpenLine::open(
      line_, work.order.attempt, work.order.area_mm, [this] { touch(); }, &figures_);
  if (!open) {
    end.error = open.error();
    end.fates.assign(work.order.program.strokes.size(), StrokeFate::NotSent);
    return end;
  }
  CutJournal& journal = *work.journal;
  SessionOptions options = options_;
  options.cancel = &cancel_;
  options.give_up = &give_up_;
  options.pause = &pause_;
  options.ask = [this] { pause_ = true; };
  options.first_stroke =
      static_cast<std::size_t>(std::max<std::int64_t>(0, work.order.first_stroke));
  options.progress = [&](const SessionProgress& progress) {
    touch();
    try {
      journal.progress(progress);
    } catch (const std::exception&) {  // no memory to tell how far it is: it goes on all the same
    }
  };
  options.intend = [&](std::int64_t last) {
    last_intended = last;
    return journal.intend(last);
  };
  options.settle = [&](std::int64_t certain, std::int64_t taken, std::uint64_t bytes) {
    return journal.settle(certain, taken, bytes);
  };
  end = run_session(open->transport(), line_.machine, work.order.program, options);
  try {
    // A simulated cutter without memory does not know what it did.
    if (!end.error || end.error->kind != ErrorKind::Internal)
      open->keep_trace(line_, work.order.attempt);
  } catch (const std::exception&) {  // a trace is a help, never in the way
  }
  return end;
}

void Cutter::carry_out(Work work) {
  SessionEnd end;
  std::vector<StrokeFate> spare;
  std::int64_t last_intended = -1;
  try {
    spare.assign(work.order.program.strokes.size(), StrokeFate::NotSent);
    end = session(work, last_intended);
  } catch (const std::exception&) {
    // Nobody knows how it ended, so all strokes that were to be sent are in doubt.
    for (std::int64_t k = std::max<std::int64_t>(0, work.order.first_stroke); k <= last_intended;
         ++k)
      if (const auto at = static_cast<std::size_t>(k); at < spare.size())
        spare[at] = StrokeFate::InDoubt;
    end.error = Error{ErrorKind::Internal, "", "out of memory"};  // so short that it needs none
    end.fates = std::move(spare);
  }
  insist([&] {
    const std::lock_guard lock(mutex_);
    note_end(end);
    cutting_ = false;
    telling_ = true;
    refresh();
  });
  insist([&] { work.journal->ended(end); });
  {
    const std::lock_guard lock(mutex_);
    telling_ = false;
  }
  insist([&] { tell(); });
}

/// Notes what the end of a session says about the machine. An error of the journal says nothing.
void Cutter::note_end(const SessionEnd& end) {
  if (end.error && end.error->kind == ErrorKind::Timeout) figures_.note_error(*end.error, false);
  if (const Result<Identity> identity = parse_identity(end.identity); identity)
    record_.firmware = identity->firmware;
  condition_ = Condition::None;
  if (end.error) condition_text_ = end.error->detail;
  if (!end.error) ++record_.sheets_done;
  if (!end.error || end.cancelled) return;
  if (end.error->kind == ErrorKind::DeviceGone) ++record_.plugs;
  const bool broken =
      end.error->reason == ErrorReason::Stalled || end.error->reason == ErrorReason::Overflow;
  if (end.error->kind == ErrorKind::DeviceGone || end.error->kind == ErrorKind::Timeout || broken)
    condition_ = Condition::Fault;
  else if (end.error->kind == ErrorKind::Refused)
    condition_ = Condition::Attention;
}

/// Opens the machine again, drops what it sent meanwhile, and asks for its state. Sends nothing
/// that could be cut.
void Cutter::ask_state() {
  Condition condition = Condition::None;
  std::string text;
  if (!line_.simulated()) {
    auto open = OpenLine::open(
        line_, "", {}, [this] { touch(); }, &figures_);
    if (!open) {
      condition = Condition::Fault;
      text = open.error().detail;
    } else if (line_.machine.language == "gpgl" && open->transport().answers()) {
      const auto answers = ask_machine(open->transport());
      if (!answers || !answers->status) {
        condition = Condition::Fault;
        text =
            answers ? "the machine accepts no data; switch it off and on" : answers.error().detail;
      }
    }
  }
  {
    const std::lock_guard lock(mutex_);
    condition_ = condition;
    condition_text_ = text;
    refresh();
  }
  tell();
}

}  // namespace popcut::daemon
