// SPDX-License-Identifier: MIT
#include "daemon/previews/previewer.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/planning/fair_line.hpp"
#include "daemon/planning/worker_talk.hpp"

namespace popcut::daemon {
namespace {

using planning::CallOff;
using planning::WarmWorker;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostWaiting = 64, kMostEach = 16;
constexpr int kMostTries = 3;  // of a task whose worker somebody killed

Problem superseded() { return {ProblemKind::Superseded, "a newer preview took its place"}; }
Problem called_off() { return {ProblemKind::Unavailable, "the preview was called off"}; }
Problem too_many() {
  Problem full{ProblemKind::Unavailable, "too many previews wait already; try again"};
  full.retry_after_s = 1;
  return full;
}

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * s));
}

class ProcessPreviewer final : public Previewer {
 public:
  ProcessPreviewer(const PreviewLimits& limits, std::string program)
      : limits_(limits), program_(std::move(program)) {
    for (int k = 0; k < std::max(1, limits_.processes); ++k)
      lanes_.emplace_back(&quick_, limits_.quick, program_);
    for (int k = 0; k < std::max(1, limits_.openings); ++k)
      lanes_.emplace_back(&opening_, limits_.slow, program_);
    for (int k = 0; k < std::max(1, limits_.files); ++k)
      lanes_.emplace_back(&slow_, limits_.slow, program_);
    for (Lane& lane : lanes_) lane.thread = std::thread([this, &lane] { work(lane); });
  }

  ~ProcessPreviewer() override { stop(); }
  ProcessPreviewer(const ProcessPreviewer&) = delete;
  ProcessPreviewer& operator=(const ProcessPreviewer&) = delete;

  void stop() override {
    std::map<std::uint64_t, Waiting> dropped;
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      dropped.swap(waiting_);
      for (const auto& [id, running] : running_) running->call_off.call();
    }
    changed_.notify_all();
    for (const auto& [id, one] : dropped) one.done(tl::unexpected(called_off()));
    for (Lane& lane : lanes_)
      if (lane.thread.joinable()) lane.thread.join();
  }

  std::uint64_t start(PreviewTask task, Done done) override {
    Done refused;
    std::vector<Done> older;
    std::uint64_t id = 0;
    {
      const std::lock_guard lock(mutex_);
      id = ++last_id_;
      const FairLine::Added added =
          stopping_ ? FairLine::Added{} : line_of(task).line.add({id, task.who, task.key});
      if (added.is_taken) end_older(task, older);
      if (added.replaced) {
        auto replaced = waiting_.extract(*added.replaced);
        older.push_back(std::move(replaced.mapped().done));
      }
      if (added.is_taken)
        waiting_.emplace(id, Waiting{std::move(task), std::move(done)});
      else
        refused = std::move(done);
    }
    changed_.notify_all();
    for (const Done& done_before : older) done_before(tl::unexpected(superseded()));
    if (refused) refused(tl::unexpected(too_many()));
    return id;
  }

  void cancel(std::uint64_t id) override {
    Done dropped;
    {
      const std::lock_guard lock(mutex_);
      if (const auto at_work = running_.find(id); at_work != running_.end())
        return at_work->second->call_off.call();
      const auto waits = waiting_.find(id);
      if (waits == waiting_.end()) return;
      line_of(waits->second.task).line.remove(id);
      dropped = std::move(waits->second.done);
      waiting_.erase(waits);
    }
    dropped(tl::unexpected(called_off()));
  }

 private:
  struct Line {
    FairLine line{kMostWaiting, kMostEach};
    std::vector<std::string> at_work{};  ///< principals: each one has one task at work
  };
  struct Waiting {
    PreviewTask task;
    Done done;
  };
  struct Running {
    std::string who, key;
    bool is_patient;
    Clock::time_point begun{Clock::now()};
    bool is_superseded{false};
    CallOff call_off{};
  };
  /// A thread that works off a line, and its worker. A worker ends with its thread.
  struct Lane {
    Lane(Line* from, const PlanningLimits& limits, const std::string& program)
        : line(from), worker(limits, program) {}
    Line* line;
    WarmWorker worker;
    std::string owner{};  ///< for whom the worker is warm; empty: there is none
    bool is_at_work{false};
    std::thread thread{};
  };

  [[nodiscard]] static bool is_warm(const PreviewTask& task) {
    return task.task.kind == PlanningTask::Kind::Preview && !task.is_long;
  }
  [[nodiscard]] Line& line_of(const PreviewTask& task) {
    using Kind = PlanningTask::Kind;
    const Kind kind = task.task.kind;
    if (kind == Kind::Preview) return task.is_long ? opening_ : quick_;
    return kind == Kind::Lattice || kind == Kind::Place ? opening_ : slow_;
  }

  [[nodiscard]] Clock::duration grace() const {
    return std::chrono::duration_cast<Clock::duration>(seconds(limits_.grace_s));
  }

  /// Ends what is at work and older than `task`, and takes out what waits to go on.
  void end_older(const PreviewTask& task, std::vector<Done>& out) {
    if (task.key.empty()) return;
    for (auto one = waiting_.begin(); one != waiting_.end();) {
      const PreviewTask& waits = one->second.task;
      if (!waits.is_long || waits.who != task.who || waits.key != task.key) {
        ++one;
        continue;
      }
      opening_.line.remove(one->first);
      out.push_back(std::move(one->second.done));
      one = waiting_.erase(one);
    }
    for (const auto& [id, running] : running_) {
      if (running->who != task.who || running->key != task.key) continue;
      running->is_superseded = true;
      running->call_off.call(running->is_patient ? running->begun + grace() : Clock::now());
    }
  }

  /// Whether this lane may begin something of `who`: not while another lane does, nor if another
  /// one has nothing to do and the worker that is warm for them, or no worker to end for them.
  [[nodiscard]] bool may_begin(const Lane& lane, const std::string& who) const {
    const std::vector<std::string>& busy = lane.line->at_work;
    if (std::find(busy.begin(), busy.end(), who) != busy.end()) return false;
    return lane.owner == who || std::none_of(lanes_.begin(), lanes_.end(), [&](const Lane& other) {
             return other.line == lane.line && !other.is_at_work &&
                    (other.owner == who || (other.owner.empty() && !lane.owner.empty()));
           });
  }

  void work(Lane& lane) {
    std::unique_lock lock(mutex_);
    auto idle_since = Clock::now();
    while (!stopping_) {
      const auto place =
          lane.line->line.next([&](const std::string& who) { return may_begin(lane, who); });
      if (place) {
        do_one(lane, *place, lock);
        idle_since = Clock::now();
      } else if (lane.owner.empty()) {
        changed_.wait(lock);
      } else if (changed_.wait_until(lock, idle_since + seconds(limits_.idle_s)) ==
                 std::cv_status::timeout) {
        lane.owner.clear();
        lock.unlock();
        lane.worker.end();
        changed_.notify_all();  // another lane may have left something to this one
        lock.lock();
      }
    }
    lock.unlock();
    lane.worker.end();
  }

  void do_one(Lane& lane, const FairLine::Place& place, std::unique_lock<std::mutex>& lock) {
    auto node = waiting_.extract(place.id);
    Waiting one = std::move(node.mapped());
    one.task.task.who = place.who;
    auto running = std::make_shared<Running>();
    running->who = place.who;
    running->key = place.key;
    running->is_patient = one.task.is_patient;
    running_[place.id] = running;
    lane.line->at_work.push_back(place.who);
    lane.is_at_work = true;
    lock.unlock();
    Result<PlanningOutcome> outcome = outcome_of(lane, one.task, running->call_off);
    lock.lock();
    running_.erase(place.id);
    std::erase(lane.line->at_work, place.who);
    lane.is_at_work = false;
    if (is_warm(one.task)) lane.owner = place.who;
    if (!lane.worker.is_running()) lane.owner.clear();
    const bool is_superseded = running->is_superseded;
    if (!outcome && goes_on(lane, one.task, *running)) {
      one.task.is_long = true;
      if (opening_.line.add({place.id, place.who, ""}).is_taken) {
        waiting_.emplace(place.id, std::move(one));
        changed_.notify_all();
        return;
      }
    }
    lock.unlock();
    changed_.notify_all();
    try {
      if (outcome)
        one.done(std::move(*outcome));
      else if (outcome.error().kind != ErrorKind::Refused)
        one.done(tl::unexpected(problem_from(outcome.error())));
      else
        one.done(tl::unexpected(is_superseded ? superseded() : called_off()));
    } catch (const std::exception&) {  // no memory to take it; an exception here would end popcutd
    }
    one = {};
    lock.lock();
  }

  /// Whether what ran out of the time of previews is one that somebody still waits for at rest.
  [[nodiscard]] bool goes_on(const Lane& lane, const PreviewTask& task,
                             const Running& running) const {
    return is_warm(task) && lane.worker.ran_out_of_time() && !task.is_patient &&
           !running.call_off.called() && !stopping_;
  }

  /// Like `run`. An exception that left the thread would end popcutd, and with it a cut.
  Result<PlanningOutcome> outcome_of(Lane& lane, PreviewTask& task, const CallOff& call_off) {
    try {
      find_assets(task.task);
      return run(lane, task, call_off);
    } catch (const std::exception&) {
      lane.worker.end();                                      // it may have got a part of the task
      return fail(ErrorKind::Internal, "", "out of memory");  // so short that it needs none
    }
  }

  Result<PlanningOutcome> run(Lane& lane, const PreviewTask& task, const CallOff& call_off) {
    const bool warm = is_warm(task);
    if (warm && lane.owner != task.who) lane.worker.end();
    for (int tries = 1;; ++tries) {
      int killed_by = 0;
      Result<PlanningOutcome> outcome =
          warm ? lane.worker.run(task.task, call_off, &killed_by)
               : planning::run_in_worker(task.task, limits_.slow, program_, call_off, &killed_by);
      if (killed_by == 0 || tries == kMostTries || call_off.called()) return outcome;
    }
  }

  const PreviewLimits limits_;
  const std::string program_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Line quick_, opening_, slow_;
  std::map<std::uint64_t, Waiting> waiting_;
  std::map<std::uint64_t, std::shared_ptr<Running>> running_;
  std::uint64_t last_id_{0};
  bool stopping_{false};
  std::deque<Lane> lanes_;
};

}  // namespace

std::unique_ptr<Previewer> make_previewer(const PreviewLimits& limits, std::string program) {
  return std::make_unique<ProcessPreviewer>(limits, std::move(program));
}

}  // namespace popcut::daemon
