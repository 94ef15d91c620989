// SPDX-License-Identifier: MIT
#include "daemon/planning/worker_talk.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "daemon/planning/frames.hpp"
#include "daemon/planning/pdf_task.hpp"
#include "daemon/planning/task_json.hpp"
#include "daemon/planning/worker_process.hpp"

namespace popcut::planning {
namespace {

using daemon::PlanningFile;
using daemon::PlanningLimits;
using daemon::PlanningOutcome;
using daemon::PlanningTask;
using std::chrono::steady_clock;

constexpr std::size_t kBlock = 1u << 16;
constexpr std::size_t kMostFiles = 100'000;
constexpr std::chrono::milliseconds kTellEach{500}, kTellAgain{2000};

/// A stored file on its way into the pipe: head first, then the bytes as they are read.
class Source {
 public:
  static Result<Source> memory(FrameKind kind, std::string_view bytes) {
    Source source;
    source.pending_ = frame_head(kind, "", bytes.size()) + std::string(bytes);
    return source;
  }
  static Result<Source> file(FrameKind kind, const std::string& name, const std::string& path) {
    Source source;
    source.file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    struct stat status {};
    if (source.file_ < 0 || ::fstat(source.file_, &status) != 0 || !S_ISREG(status.st_mode))
      return fail(ErrorKind::Internal, path,
                  std::string("the stored file cannot be read: ") + std::strerror(errno));
    source.left_ = static_cast<std::uint64_t>(status.st_size);
    source.pending_ = frame_head(kind, name, source.left_);
    return source;
  }
  Source(Source&& other) noexcept
      : file_(std::exchange(other.file_, -1)),
        left_(other.left_),
        pending_(std::move(other.pending_)),
        at_(other.at_) {}
  Source& operator=(Source&&) = delete;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source() {
    if (file_ >= 0) ::close(file_);
  }

  /// What is next; empty: all is sent.
  Result<std::string_view> next() {
    if (at_ == pending_.size() && left_ > 0) {
      pending_.resize(std::min<std::uint64_t>(kBlock, left_));
      const ssize_t got = ::read(file_, pending_.data(), pending_.size());
      if (got <= 0) return fail(ErrorKind::Internal, "design", "the stored file became shorter");
      pending_.resize(static_cast<std::size_t>(got));
      left_ -= static_cast<std::uint64_t>(got);
      at_ = 0;
    }
    return std::string_view(pending_).substr(at_);
  }
  void sent(std::size_t bytes) { at_ += bytes; }

 private:
  Source() = default;
  int file_{-1};
  std::uint64_t left_{};
  std::string pending_;
  std::size_t at_{};
};

/// Passes on what a worker says it is at, but not as often as it says it.
class PhaseTeller {
 public:
  explicit PhaseTeller(const std::function<void(const daemon::PlanningPhase&)>& tell)
      : tell_(tell) {}

  void hear(std::string json) {
    if (!tell_) return;
    json_ = std::move(json);  // read only if it is told: a hostile worker says much
    is_new_ = true;
  }
  void tell_if_due(steady_clock::time_point now) {
    if (now < due()) return;
    if (std::exchange(is_new_, false)) phase_ = planning::read_phase(json_);
    told_ = now;
    if (phase_) tell_(*phase_);
  }
  /// When it is to be looked at again.
  [[nodiscard]] steady_clock::time_point due() const {
    if (is_new_) return told_ + kTellEach;
    return phase_ ? told_ + kTellAgain : steady_clock::time_point::max();
  }

 private:
  const std::function<void(const daemon::PlanningPhase&)>& tell_;
  std::string json_{};
  std::optional<daemon::PlanningPhase> phase_{};
  bool is_new_{false};
  steady_clock::time_point told_{};  ///< the epoch: never
};

/// A write to a worker that died must not end this process.
class PipeSignalBlocked {
 public:
  PipeSignalBlocked() {
    sigset_t pipe;
    ::sigemptyset(&pipe);
    ::sigaddset(&pipe, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe, &before_);
  }
  ~PipeSignalBlocked() {
    // One that came meanwhile is taken away, unless it was blocked before.
    sigset_t pipe;
    ::sigemptyset(&pipe);
    ::sigaddset(&pipe, SIGPIPE);
    constexpr timespec kNow{0, 0};
    if (::sigismember(&before_, SIGPIPE) == 0)
      while (::sigtimedwait(&pipe, nullptr, &kNow) > 0) {
      }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  PipeSignalBlocked(const PipeSignalBlocked&) = delete;
  PipeSignalBlocked& operator=(const PipeSignalBlocked&) = delete;

 private:
  sigset_t before_{};
};

Error infeasible(std::string detail) { return {ErrorKind::Infeasible, "", std::move(detail)}; }

/// It is over a limit of time: with another limit, or on an idle computer, it may be made.
Error too_long(std::string detail) {
  return {ErrorKind::Infeasible, "", std::move(detail), ErrorReason::TooMuch};
}

/// The last line that a worker said on standard error, printable.
std::string last_words(const std::string& errors) {
  std::string line = errors.substr(0, errors.find_last_not_of(" \n") + 1);
  if (const auto at = line.rfind('\n'); at != std::string::npos) line.erase(0, at + 1);
  for (char& c : line)
    if (c < 0x20 || c > 0x7E) c = '?';
  return line.empty() ? "" : " (" + line.substr(0, 200) + ")";
}

/// The task and its owner, for the log.
std::string name_of(const PlanningTask& task) {
  constexpr std::array kWords{"check",  "plan",  "test cut", "preview", "lattice", "picture",
                              "export", "place", "artwork",  "PDF",     "make",    "search"};
  static_assert(kWords.size() == static_cast<std::size_t>(PlanningTask::Kind::Search) + 1);
  const std::string file = task.design_path.substr(task.design_path.rfind('/') + 1);
  return fmt::format("a {}{}{} of {}", kWords.at(static_cast<std::size_t>(task.kind)),
                     file.empty() ? "" : " of ", file, task.who.empty() ? "popcutd" : task.who);
}

class Talk {
 public:
  /// See `run_in_worker`, after `run`.
  [[nodiscard]] int killed_by() const { return killed_by_; }
  [[nodiscard]] bool ran_out_of_time() const { return ran_out_of_time_; }

  /// @param keeps  the worker waits for another task when it has answered this one
  Talk(const PlanningTask& task, const PlanningLimits& limits, const CallOff& call_off,
       WorkerProcess& process, bool keeps)
      : limits_(limits),
        call_off_(call_off),
        process_(process),
        keeps_(keeps),
        place_(limits.together, process.pid(), task.who),
        name_(name_of(task)),
        is_search_(task.kind == PlanningTask::Kind::Search),
        teller_(task.progress),
        reader_(limits.output_bytes),
        until_(steady_clock::now() + std::chrono::milliseconds(static_cast<std::int64_t>(
                                         1000 * std::clamp(limits.wall_s, 0.01, 1e8)))),
        cpu_until_s_(process.cpu_so_far_s() + limits.cpu_s) {}

  Result<PlanningOutcome> run(std::deque<Source> sources) {
    sources_ = std::move(sources);
    Result<void> talked = talk();
    if (keeps_ && talked && answer_) {
      if (sources_.empty() && reader_.at_rest()) return std::move(*answer_);
      talked = fail(ErrorKind::Internal, "worker", "it answered before it was asked, or said more");
    }
    if (!talked) process_.kill();
    const int status = process_.wait();
    if (!talked) return tl::unexpected(talked.error());
    if (answer_) return std::move(*answer_);
    constexpr std::array kFromOutside{SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGQUIT};
    if (WIFSIGNALED(status) && !process_.is_ended_by_us() && !took_its_time(status) &&
        std::find(kFromOutside.begin(), kFromOutside.end(), WTERMSIG(status)) != kFromOutside.end())
      killed_by_ = WTERMSIG(status);
    return tl::unexpected(how_it_died(status));
  }

 private:
  Result<void> talk() {
    while (process_.from() >= 0 && !done_ && !(keeps_ && answer_)) {
      const bool is_doomed = call_off_.at() != CallOff::Clock::time_point::max();
      std::array<pollfd, 4> waits{pollfd{process_.from(), POLLIN, 0},
                                  {process_.errors(), POLLIN, 0},
                                  {is_doomed ? -1 : call_off_.descriptor(), POLLIN, 0},
                                  {sources_.empty() ? -1 : process_.to(), POLLOUT, 0}};
      const auto now = steady_clock::now();
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until_ - now);
      if (left.count() <= 0)
        return tl::unexpected(
            too_long(fmt::format("took longer than the {:g} s that {}", limits_.wall_s,
                                 advice("may take", "planner.wall_s"))));
      teller_.tell_if_due(now);
      auto most = std::min<std::int64_t>(left.count() + 1, limits_.together ? 100 : 1000);
      // One that does a task after another has a limit of the kernel for all of them only.
      if (const double cpu_left_s = cpu_until_s_ - process_.cpu_so_far_s(); keeps_) {
        ran_out_of_time_ = cpu_left_s <= 0;
        if (ran_out_of_time_) return tl::unexpected(out_of_time());
        most = std::min(most, static_cast<std::int64_t>(1000 * cpu_left_s) + 1);
      }
      if (const auto due = teller_.due(); due < now + std::chrono::seconds(1))
        most = std::min<std::int64_t>(
            most, std::chrono::ceil<std::chrono::milliseconds>(due - now).count());
      if (is_doomed && call_off_.at() > now)
        most = std::min<std::int64_t>(
            most, std::chrono::ceil<std::chrono::milliseconds>(call_off_.at() - now).count());
      if (::poll(waits.data(), waits.size(), static_cast<int>(most)) < 0 && errno != EINTR)
        return fail(ErrorKind::Internal, "worker", std::strerror(errno));
      if (call_off_.called()) return fail(ErrorKind::Refused, "", "the planning was cancelled");
      if (place_.must_end()) {
        report(fmt::format("ended: all workers together may use {} MiB",
                           limits_.together->bytes() >> 20));
        return tl::unexpected(infeasible(
            fmt::format("needs more memory than is left of the {} MiB for all designs at "
                        "work; make it smaller or simpler, or try again later",
                        limits_.together->bytes() >> 20)));
      }
      if (waits[1].revents != 0) hear_errors();
      if (waits[3].revents != 0)
        if (const Result<void> sent = send(); !sent) return sent;
      if (waits[0].revents != 0)
        if (const Result<void> heard = hear(); !heard) return heard;
    }
    return {};
  }

  Result<void> send() {
    while (!sources_.empty()) {
      const Result<std::string_view> bytes = sources_.front().next();
      if (!bytes) return tl::unexpected(bytes.error());
      if (bytes->empty()) {
        sources_.pop_front();
        continue;
      }
      const ssize_t put = ::write(process_.to(), bytes->data(), bytes->size());
      if (put < 0 && (errno == EAGAIN || errno == EINTR)) return {};
      if (put <= 0) break;  // it reads no more: what it says tells why
      sources_.front().sent(static_cast<std::size_t>(put));
    }
    sources_.clear();
    if (!keeps_) process_.close_to();
    return {};
  }

  /// What to do about a limit; `key` of the configuration raises it, but not that of a preview.
  [[nodiscard]] std::string advice(const char* what, const char* key) const {
    if (is_search_)
      return fmt::format(
          "a search {}; lower `effort`, use a mesh with fewer triangles, or raise {} in "
          "popcutd.toml",
          what, key);
    if (limits_.is_preview)
      return fmt::format("a preview {}; use fewer slices or units, or plan it: a plan has more",
                         what);
    return fmt::format("a design {}; make it smaller or simpler, or raise {} in popcutd.toml", what,
                       key);
  }

  void hear_errors() {
    std::array<char, 4096> block{};
    const ssize_t got = ::read(process_.errors(), block.data(), block.size());
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (got <= 0) return process_.close_errors();
    errors_.append(block.data(), static_cast<std::size_t>(got));
    if (errors_.size() > 2 * block.size()) errors_.erase(0, errors_.size() - block.size());
  }

  Result<void> hear() {
    block_.resize(kBlock);
    const ssize_t got = ::read(process_.from(), block_.data(), block_.size());
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return {};
    done_ = got <= 0;
    if (done_) return {};
    const Result<void> fed =
        reader_.feed(std::string_view(block_).substr(0, static_cast<std::size_t>(got)),
                     [this](Frame frame) { return take(std::move(frame)); });
    if (fed) return fed;
    if (fed.error().kind == ErrorKind::OutOfRange)
      return tl::unexpected(
          infeasible(fmt::format("makes more than the {} bytes that {}", limits_.output_bytes,
                                 advice("may make", "planner.output_mib"))));
    return fail(ErrorKind::Internal, "worker", message(fed.error()));
  }

  Result<void> take(Frame frame) {
    const auto wrong = [](const char* what) { return fail(ErrorKind::Malformed, "pipe", what); };
    if (answer_) return wrong("a frame after the last one");
    switch (frame.kind) {
      case FrameKind::File:
        if (frame.name.empty() || !names_.insert(frame.name).second || names_.size() > kMostFiles)
          return wrong("two files of one name, or too many files");
        files_.push_back(PlanningFile{std::move(frame.name), std::move(frame.bytes)});
        return {};
      case FrameKind::Outcome: {
        Result<PlanningOutcome> outcome = read_outcome(frame.bytes);
        if (!outcome) return tl::unexpected(outcome.error());
        outcome->files = std::move(files_);
        answer_ = std::move(outcome);
        return {};
      }
      case FrameKind::Failure:
        answer_ = tl::unexpected(read_error(frame.bytes));
        return {};
      case FrameKind::Phase:
        teller_.hear(std::move(frame.bytes));
        return {};
      default:
        return wrong("a frame that only popcutd sends");
    }
  }

  /// It was ended by its limit of processor time, which the kernel does with a SIGKILL.
  [[nodiscard]] bool took_its_time(int status) const {
    if (WIFEXITED(status)) return WEXITSTATUS(status) == kOutOfTimeCode;
    // The kernel holds to the limit by counting ticks: on a busy computer it has counted 2 s when
    // 1.5 s were used. What is left to signal 9 is a worker that did not answer SIGXCPU.
    const bool out_of_time = process_.cpu_s() > std::max(1.0, limits_.cpu_s) / 2;
    return WTERMSIG(status) == SIGXCPU || (WTERMSIG(status) == SIGKILL && out_of_time);
  }

  [[nodiscard]] Error out_of_time() const {
    return too_long(
        fmt::format("took more than the {:g} s of processor time that {}", limits_.cpu_s,
                    advice("may take", limits_.is_check ? "planner.check_s" : "planner.cpu_s")));
  }

  void report(const std::string& what) const {
    if (limits_.report) limits_.report(fmt::format("the worker for {} {}", name_, what));
  }

  [[nodiscard]] Error how_it_died(int status) const {
    if (took_its_time(status)) return out_of_time();
    if (WIFSIGNALED(status))
      report(fmt::format("crashed (signal {}){}", WTERMSIG(status), last_words(errors_)));
    if (WIFSIGNALED(status))
      return infeasible(fmt::format("crashed the planner (signal {}){}; please report the design",
                                    WTERMSIG(status), last_words(errors_)));
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (code == kOutOfMemoryCode)
      return infeasible("needs more memory than " + advice("may use", "planner.memory_mib"));
    if (code == 126 || code == 127)
      return {ErrorKind::Internal, "worker",
              "cannot be started; check the installation of popcutd"};
    report(fmt::format("ended with code {}{}", code, last_words(errors_)));
    return infeasible(fmt::format("ended the planner with code {}{}; please report the design",
                                  code, last_words(errors_)));
  }

  const PlanningLimits& limits_;
  const CallOff& call_off_;
  WorkerProcess& process_;
  bool keeps_;
  WorkerMemory::Place place_;
  std::string name_;
  bool is_search_;
  PhaseTeller teller_;
  FrameReader reader_;
  steady_clock::time_point until_;
  double cpu_until_s_;
  bool ran_out_of_time_{false};
  std::deque<Source> sources_;
  std::string block_, errors_;
  std::set<std::string> names_;
  std::vector<PlanningFile> files_;
  std::optional<Result<PlanningOutcome>> answer_;
  bool done_{false};
  int killed_by_{0};
};

Result<std::deque<Source>> sources_of(const PlanningTask& task) {
  WorkerTask words;
  words.kind = task.kind;
  words.design_kind = task.design_kind;
  words.machine_json = task.machine_json;
  words.profile_json = task.profile_json;
  words.material_json = task.material_json;
  words.options = task.options;
  std::deque<Source> sources;
  const auto keep = [&](Result<Source> source) -> Result<void> {
    if (!source) return tl::unexpected(source.error());
    sources.push_back(std::move(*source));
    return {};
  };
  Result<void> kept = keep(Source::memory(FrameKind::Task, task_json(words)));
  if (kept && task.kind != PlanningTask::Kind::TestCut)
    kept = keep(task.design_path.empty() ? Source::memory(FrameKind::Design, task.design_text)
                                         : Source::file(FrameKind::Design, "", task.design_path));
  for (const auto& [id, path] : task.asset_paths)
    if (kept) kept = keep(Source::file(FrameKind::Asset, id, path));
  if (kept) kept = keep(Source::memory(FrameKind::Go, ""));
  if (!kept) return tl::unexpected(kept.error());
  return sources;
}

}  // namespace

CallOff::CallOff() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
CallOff::~CallOff() {
  if (event_ >= 0) ::close(event_);
}

void CallOff::call(Clock::time_point at) {
  Clock::time_point before = at_.load();
  while (at < before && !at_.compare_exchange_weak(before, at)) {
  }
  const std::uint64_t one = 1;
  if (event_ >= 0 && ::write(event_, &one, sizeof one) < 0) { /* it is seen within a second */
  }
}

Result<PlanningOutcome> run_in_worker(const PlanningTask& task, const PlanningLimits& limits,
                                      const std::string& program, const CallOff& call_off,
                                      int* killed_by) {
  auto sources = sources_of(task);
  if (!sources) return tl::unexpected(sources.error());
  auto process = WorkerProcess::start(program, limits, has_pdf(task) ? "pdf" : nullptr);
  if (!process) return tl::unexpected(process.error());
  const PipeSignalBlocked blocked;
  Talk talk(task, limits, call_off, *process, false);
  Result<PlanningOutcome> outcome = talk.run(std::move(*sources));
  if (killed_by != nullptr) *killed_by = talk.killed_by();
  return outcome;
}

WarmWorker::WarmWorker(const PlanningLimits& limits, std::string program)
    : limits_(limits), program_(std::move(program)) {}

bool WarmWorker::is_running() const { return process_.has_value(); }

void WarmWorker::end() {
  process_.reset();
  served_ = 0;
}

Result<PlanningOutcome> WarmWorker::run(const PlanningTask& task, const CallOff& call_off,
                                        int* killed_by) {
  if (has_pdf(task)) {
    daemon::PlanningLimits one = limits_;
    one.cpu_s /= kMostTasks;
    return run_in_worker(task, one, program_, call_off, killed_by);
  }
  if (served_ >= kMostTasks) end();
  const bool was_used = is_running();
  Result<PlanningOutcome> outcome = run_once(task, call_off, killed_by);
  // What it died of may be what is left of earlier tasks: then a fresh one can do it.
  if (outcome || !was_used || !died_) return outcome;
  return run_once(task, call_off, killed_by);
}

Result<PlanningOutcome> WarmWorker::run_once(const PlanningTask& task, const CallOff& call_off,
                                             int* killed_by) {
  died_ = false;
  auto sources = sources_of(task);
  if (!sources) return tl::unexpected(sources.error());
  if (!process_) {
    PlanningLimits of_all = limits_;
    of_all.cpu_s *= kMostTasks;
    auto started = WorkerProcess::start(program_, of_all, "serve");
    if (!started) return tl::unexpected(started.error());
    process_.emplace(std::move(*started));
  }
  ++served_;
  const PipeSignalBlocked blocked;
  Talk talk(task, limits_, call_off, *process_, true);
  Result<PlanningOutcome> outcome = talk.run(std::move(*sources));
  if (killed_by != nullptr) *killed_by = talk.killed_by();
  ran_out_of_time_ = talk.ran_out_of_time();
  if (process_->has_ended()) {
    died_ = !process_->is_ended_by_us();
    end();
  }
  return outcome;
}

}  // namespace popcut::planning
