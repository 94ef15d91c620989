// SPDX-License-Identifier: MIT
#include "tests/support/fleet_load.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <queue>
#include <thread>

#include <fmt/format.h>

#include "daemon/fleet/postgres_database.hpp"
#include "daemon/store/attempt_table.hpp"
#include "daemon/store/job_table.hpp"

namespace popcut::testing {
namespace {

using namespace popcut::daemon;
using Clock = std::chrono::steady_clock;

constexpr const char* kLogin = "popcut_n_load";
constexpr std::int64_t kStrokes = 10;
constexpr double kLeaseS = 3600;  // longer than any measurement

double ms_since(Clock::time_point begun) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begun).count();
}

Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

/// A node's connection. Whose calls it makes is in `mark`.
struct Workshop {
  explicit Workshop(const std::string& url)
      : database({.url = url, .answer_s = 60}),
        jobs(database),
        attempts(database, mark),
        line(url) {}

  // As ServiceStore does.
  void emit(Events events, const std::string& job, const std::string& state) {
    if (events == Events::None) return;
    const std::string data = fmt::format(R"("kind":"job","job":"{}","state":"{}")", job, state);
    database.insert_later("event_new(time, kind, job, data)", 1, "job", job, data + "}");
  }
  void number(Events events) {
    if (events == Events::None) return;
    while (database.number("SELECT event_number(?)", mark.name) != 0) continue;
  }
  void audit(const std::string& action, const std::string& job) {
    database.insert_later("audit(time, principal, action, subject, detail)", 1, "olga", action, job,
                          "");
  }
  /// A transaction; again if it was overtaken. Then its events get their numbers.
  void change(std::atomic<std::size_t>& again, Events events, const std::function<void()>& work) {
    for (;;) {
      try {
        Transaction all(database);
        work();
        all.commit();
        number(events);
        return;
      } catch (const StoreFault& fault) {
        if (fault.kind() != FaultKind::Again) throw;
        ++again;
      }
    }
  }

  NodeMark mark{};
  PostgresDatabase database;
  JobTable jobs;
  AttemptTable attempts;
  FleetLine line;  ///< the same, without the service's code
};

std::string job_id(std::int64_t number) { return fmt::format("J{:025}", number); }
std::string attempt_id(std::int64_t number) { return fmt::format("A{:025}", number); }

}  // namespace

CallTimes call_times(std::vector<double> times_ms) {
  if (times_ms.empty()) return {};
  std::sort(times_ms.begin(), times_ms.end());
  const auto at = [&](double share) {
    return times_ms[static_cast<std::size_t>(share * static_cast<double>(times_ms.size() - 1))];
  };
  return {times_ms.size(), at(0.5), at(0.99), times_ms.back()};
}

struct FleetLoad::Parts {
  FleetSql& fleet;
  int nodes;
  std::vector<NodeMark> marks{};
  std::vector<std::unique_ptr<Workshop>> desks{};
  std::int64_t next_job{0};  ///< those before are used
  std::atomic<std::size_t> again{0};

  /// That many more jobs that are ready; the number of the first.
  std::int64_t add_jobs(std::int64_t count) {
    fleet(new_jobs_sql(next_job, next_job + count - 1, "ready"));
    fleet("ANALYZE");
    const std::int64_t first = next_job;
    next_job += count;
    return first;
  }

  void arm(Workshop& shop, Events events, std::int64_t number, int node) {
    shop.mark = marks[static_cast<std::size_t>(node)];
    const std::string device = fmt::format("dev-{}", node);
    shop.change(again, events, [&] {
      JobRow row = shop.jobs.find(job_id(number)).value();
      row.state = JobState::Armed;
      row.device = device;
      row.operator_name = "olga";
      shop.attempts.put_sheet(row.id, row.sheet, row.blank, row.segment, "armed", {}, {});
      shop.jobs.update(row);
      shop.attempts.arm({.job = row.id,
                         .sheet = row.sheet,
                         .blank = row.blank,
                         .device = device,
                         .plan_sha256 = FleetSql::plan_sha256(),
                         .operator_name = "olga",
                         .armed = 1,
                         .invocation = "run"});
      shop.audit("arm", row.id);
      shop.emit(events, row.id, "armed");
    });
  }

  void start(Workshop& shop, Events events, std::int64_t number, int node) {
    shop.mark = marks[static_cast<std::size_t>(node)];
    shop.change(again, events, [&] {
      JobRow row = shop.jobs.find(job_id(number)).value();
      (void)shop.attempts.armed(row.id);
      (void)shop.attempts.start({.id = attempt_id(number),
                                 .job = row.id,
                                 .sheet = row.sheet,
                                 .blank = row.blank,
                                 .segment = row.segment,
                                 .strokes = kStrokes,
                                 .device = row.device,
                                 .device_session = "1",
                                 .operator_name = "olga",
                                 .plan_sha256 = FleetSql::plan_sha256(),
                                 .invocation = "run",
                                 .created = 1,
                                 .started = 1});
      row.state = JobState::Cutting;
      row.started = 1;
      shop.attempts.put_sheet(row.id, row.sheet, row.blank, row.segment, "cutting", 1, {});
      shop.jobs.update(row);
      shop.audit("start", row.id);
      shop.emit(events, row.id, "cutting");
    });
  }

  void mark(Workshop& shop, std::int64_t number, int node, int which) {
    shop.mark = marks[static_cast<std::size_t>(node)];
    const std::int64_t done = which;
    shop.attempts.mark(attempt_id(number),
                       {.certain = done - 1, .taken = done, .intended = done + 2},
                       static_cast<std::uint64_t>(100 * which));
  }

  void end(Workshop& shop, Events events, std::int64_t number, int node) {
    shop.mark = marks[static_cast<std::size_t>(node)];
    shop.change(again, events, [&] {
      shop.attempts.finish(attempt_id(number), 2, "done", "", 1000,
                           {{{0, kStrokes - 1}, PathFate::Certain}});
      JobRow row = shop.jobs.find(job_id(number)).value();
      row.state = JobState::Done;
      row.finished = 2;
      row.outcome = "done";
      row.paths_certain = row.paths_sent = kStrokes;
      shop.attempts.put_sheet(row.id, row.sheet, row.blank, row.segment, "done", {}, 2);
      shop.jobs.update(row);
      shop.database.insert_later(
          "usage(time, owner, operator, device, material, job, k, seconds, cut_mm, sheets)", 2,
          row.owner, "olga", row.device, row.material, row.id, 1, 60.0, 100.0, 1);
      shop.database.later("UPDATE device SET sheets_done=sheets_done+?, cut_mm=cut_mm+? WHERE id=?",
                          1, 100.0, row.device);
      shop.emit(events, row.id, "done");
    });
  }

  void beat(Workshop& shop, int node) {
    const NodeMark& one = marks[static_cast<std::size_t>(node)];
    Rows answer = shop.database.rows("SELECT alive, now_ms FROM node_beat(?, ?, ?, 0)", one.name,
                                     one.epoch, kLeaseS);
    if (!answer.next() || answer.integer(0) == 0)
      throw StoreFault(FaultKind::Other, one.name + " is not alive");
  }

  // The tables of a queue that knows no knife: 3 215 claims/s were measured with it.
  void make_bare_queue(std::int64_t sheets) {
    fleet(
        "DROP SCHEMA IF EXISTS bare CASCADE; CREATE SCHEMA bare; "
        "CREATE SEQUENCE bare.fence; "
        "CREATE TABLE bare.sheet(job bigint, k int, blank int DEFAULT 1, segment int DEFAULT 1, "
        "site text, prio int DEFAULT 0, state text, PRIMARY KEY(job, k)) WITH (fillfactor=70); "
        "CREATE INDEX ON bare.sheet(site, prio DESC, job, k) WHERE state='pending'; "
        "CREATE TABLE bare.attempt(id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, job bigint, "
        "k int, blank int, segment int, cutter text, epoch bigint, fence bigint UNIQUE DEFAULT "
        "nextval('bare.fence'), state text, claimed_at timestamptz DEFAULT now(), lease_until "
        "timestamptz NOT NULL, started_at timestamptz) WITH (fillfactor=70); "
        "CREATE UNIQUE INDEX ON bare.attempt(job, k) WHERE state IN ('claimed', 'armed', "
        "'cutting'); "
        "CREATE UNIQUE INDEX ON bare.attempt(job, k, blank, segment) WHERE started_at IS NOT NULL; "
        "CREATE UNIQUE INDEX ON bare.attempt(cutter) WHERE state='cutting'; "
        "CREATE INDEX ON bare.attempt(lease_until) WHERE state IN ('claimed', 'armed', 'cutting')");
    fleet(
        fmt::format("INSERT INTO bare.sheet(job, k, site, state) SELECT n, 1, 'lab', 'pending' "
                    "FROM generate_series(1, {}) n",
                    sheets));
    fleet(
        fmt::format("ANALYZE bare.sheet; GRANT USAGE ON SCHEMA bare TO {0}; GRANT ALL ON ALL "
                    "TABLES IN SCHEMA bare TO {0}; GRANT ALL ON ALL SEQUENCES IN SCHEMA bare "
                    "TO {0}",
                    kLogin));
  }

  void bare_claim(Workshop& shop, const std::string& cutter) {
    const std::string got = shop.line.prepared(
        "WITH c AS (SELECT job, k, blank, segment FROM bare.sheet WHERE site=$1 AND "
        "state='pending' ORDER BY prio DESC, job, k LIMIT 1 FOR UPDATE SKIP LOCKED), u AS "
        "(UPDATE bare.sheet s SET state='claimed' FROM c WHERE (s.job, s.k)=(c.job, c.k) "
        "RETURNING 1) INSERT INTO bare.attempt(job, k, blank, segment, cutter, epoch, state, "
        "lease_until) SELECT job, k, blank, segment, $2, 1, 'claimed', now() + '60 s' FROM c "
        "RETURNING id, fence",
        {"lab", cutter});
    if (got.empty()) throw std::runtime_error("there are no more sheets");
  }

  /// `work(shop, its number)` on a thread for each connection; the first fault.
  std::string on_all(const std::function<void(Workshop&, int)>& work) {
    std::mutex lock;
    std::string first;
    std::vector<std::thread> threads;
    for (int i = 0; i < static_cast<int>(desks.size()); ++i)
      threads.emplace_back([&, i] {
        try {
          work(*desks[static_cast<std::size_t>(i)], i);
        } catch (const std::exception& fault) {
          const std::lock_guard hold(lock);
          if (first.empty()) first = fault.what();
        }
      });
    for (std::thread& one : threads) one.join();
    return first;
  }
};

FleetLoad::FleetLoad(FleetSql& fleet, int nodes, int connections)
    : parts_(new Parts{.fleet = fleet, .nodes = nodes}) {
  (void)fleet.line(kLogin);
  fleet(
      fmt::format("SELECT count(node_join('node-' || n, '{0}')) FROM generate_series(0, {1}) n; "
                  "SELECT sum((node_begin('node-' || n, 'here', '', '', NULL, 0)).epoch) FROM "
                  "generate_series(0, {1}) n",
                  kLogin, nodes - 1));
  fleet(fmt::format(
      "SELECT count(node_reported(name, epoch)), count(node_beat(name, epoch, 3600, 0)) FROM node; "
      "INSERT INTO device(id, rev, model, title, simulated, width_mm, length_mm, enabled, state, "
      "sheets_done, cut_mm, node) SELECT 'dev-' || n, 1, 'portrait', '', 1, 210, 297, 1, 'idle', "
      "0, 0, 'node-' || n FROM generate_series(0, {}) n",
      nodes - 1));
  for (int n = 0; n < nodes; ++n) {
    NodeMark mark{.name = fmt::format("node-{}", n)};
    mark.epoch = std::stoll(fleet("SELECT epoch FROM node WHERE name='" + mark.name + "'"));
    parts_->marks.push_back(std::move(mark));
  }
  const std::string url = fleet.database().url(kLogin);
  for (int i = 0; i < connections; ++i) parts_->desks.push_back(std::make_unique<Workshop>(url));
}

FleetLoad::~FleetLoad() = default;

namespace {

enum class Call { Beat, Arm, Start, Mark, End, Bare };
constexpr std::array<const char*, 6> kCallNames{"beat", "arm", "start",
                                                "mark", "end", "bare claim"};

struct Due {
  Clock::time_point when;
  Call call;
  std::int64_t job;
  int node;
  int mark;
  bool operator>(const Due& other) const { return when > other.when; }
};

/// Work with a time for each piece, the earliest first. For many threads.
class Agenda {
 public:
  void add(Due one) {
    {
      const std::lock_guard hold(lock_);
      all_.push(one);
    }
    changed_.notify_one();
  }
  /// Waits for the time of the earliest piece, and gives it; nothing when no work is left.
  std::optional<Due> take() {
    std::unique_lock hold(lock_);
    for (;;) {
      if (left_ == 0) {
        changed_.notify_all();
        return std::nullopt;
      }
      if (all_.empty()) {
        changed_.wait(hold);
      } else if (all_.top().when <= Clock::now()) {
        const Due one = all_.top();
        all_.pop();
        --left_;
        return one;
      } else {
        changed_.wait_until(hold, all_.top().when);
      }
    }
  }
  void expect(std::size_t calls) { left_ += calls; }
  void give_up() {
    const std::lock_guard hold(lock_);
    left_ = 0;
    changed_.notify_all();
  }

 private:
  std::mutex lock_;
  std::condition_variable changed_;
  std::priority_queue<Due, std::vector<Due>, std::greater<>> all_;
  std::size_t left_{0};
};

}  // namespace

FleetLoad::Figures FleetLoad::paced(const Pace& pace) {
  Parts& parts = *parts_;
  parts.again = 0;
  const auto sheets = static_cast<std::int64_t>(pace.seconds * pace.sheets_s);
  const std::int64_t first = parts.add_jobs(sheets);
  parts.make_bare_queue(sheets);
  Agenda agenda;
  const Clock::time_point begun = Clock::now() + std::chrono::milliseconds(200);
  const auto at = [&](double s) { return begun + seconds(s); };
  for (std::int64_t k = 0; k < sheets; ++k)
    agenda.add({at(static_cast<double>(k) / pace.sheets_s), Call::Arm, first + k,
                static_cast<int>(k % parts.nodes), 0});
  for (std::int64_t k = 0; k < sheets; ++k)
    agenda.add({at((static_cast<double>(k) + 0.5) / pace.sheets_s), Call::Bare, 0,
                static_cast<int>(k % parts.nodes), 0});
  agenda.expect(static_cast<std::size_t>(sheets) * static_cast<std::size_t>(4 + pace.marks));
  for (int n = 0; n < parts.nodes; ++n)
    for (double s = pace.beat_s * n / parts.nodes; s < pace.seconds; s += pace.beat_s) {
      agenda.add({at(s), Call::Beat, 0, n, 0});
      agenda.expect(1);
    }
  std::mutex lock;
  std::array<std::vector<double>, kCallNames.size()> times;
  std::atomic<std::size_t> cut{0};
  const std::string fault = parts.on_all([&](Workshop& shop, int) {
    try {
      while (const auto due = agenda.take()) {
        Due next = *due;
        switch (due->call) {
          case Call::Beat:
            parts.beat(shop, due->node);
            break;
          case Call::Arm:
            parts.arm(shop, pace.events, due->job, due->node);
            next.call = Call::Start;
            break;
          case Call::Start:
            parts.start(shop, pace.events, due->job, due->node);
            next.call = pace.marks > 0 ? Call::Mark : Call::End;
            break;
          case Call::Mark:
            parts.mark(shop, due->job, due->node, ++next.mark);
            if (next.mark == pace.marks) next.call = Call::End;
            break;
          case Call::End:
            parts.end(shop, pace.events, due->job, due->node);
            ++cut;
            break;
          case Call::Bare:
            parts.bare_claim(shop, fmt::format("dev-{}", due->node));
            break;
        }
        const double took_ms = ms_since(due->when);
        {
          const std::lock_guard hold(lock);
          times[static_cast<std::size_t>(due->call)].push_back(took_ms);
        }
        if (due->call == Call::Beat || due->call == Call::End || due->call == Call::Bare) continue;
        next.when = Clock::now() + std::chrono::milliseconds(300);
        agenda.add(next);
      }
    } catch (...) {
      agenda.give_up();
      throw;
    }
  });
  Figures figures;
  figures.sheets = cut;
  figures.again = parts.again;
  figures.fault = fault;
  for (std::size_t call = 0; call < times.size(); ++call)
    figures.calls[kCallNames[call]] = call_times(std::move(times[call]));
  return figures;
}

double FleetLoad::most_sheets_s(double length_s, Events events) {
  Parts& parts = *parts_;
  constexpr std::int64_t kPerSecond = 2500;  // more than there can be
  const auto most = static_cast<std::int64_t>(length_s * kPerSecond);
  const std::int64_t first = parts.add_jobs(most);
  std::atomic<std::int64_t> next{0}, done{0};
  const Clock::time_point begun = Clock::now(), until = begun + seconds(length_s);
  const std::string fault = parts.on_all([&](Workshop& shop, int which) {
    const int step = static_cast<int>(parts.desks.size());
    // Each has nodes of its own: a machine cuts one sheet at a time.
    const int own = std::max(1, parts.nodes / step);
    for (int k = 0; Clock::now() < until; ++k) {
      const int node = which + step * (k % own);
      const std::int64_t one = next++;
      if (one >= most) throw std::runtime_error("there are no more jobs");
      parts.arm(shop, events, first + one, node);
      parts.start(shop, events, first + one, node);
      parts.end(shop, events, first + one, node);
      ++done;
    }
  });
  if (!fault.empty()) throw std::runtime_error(fault);
  return static_cast<double>(done) * 1000 / ms_since(begun);
}

double FleetLoad::bare_claims_s(double length_s) {
  Parts& parts = *parts_;
  constexpr double kPerSecond = 30'000;  // more than there can be
  parts.make_bare_queue(static_cast<std::int64_t>(length_s * kPerSecond));
  std::atomic<std::int64_t> done{0};
  const Clock::time_point begun = Clock::now(), until = begun + seconds(length_s);
  const std::string fault = parts.on_all([&](Workshop& shop, int which) {
    const std::string cutter = fmt::format("dev-{}", which);
    while (Clock::now() < until) {
      parts.bare_claim(shop, cutter);
      ++done;
    }
  });
  if (!fault.empty()) throw std::runtime_error(fault);
  return static_cast<double>(done) * 1000 / ms_since(begun);
}

double FleetLoad::most_calls_s(double length_s) {
  Parts& parts = *parts_;
  constexpr std::int64_t kPerSecond = 2500;  // sheets; more than there can be
  const auto most = static_cast<std::int64_t>(length_s * kPerSecond);
  const std::int64_t first = parts.add_jobs(most);
  std::atomic<std::int64_t> next{0}, done{0};
  const Clock::time_point begun = Clock::now(), until = begun + seconds(length_s);
  const std::string fault = parts.on_all([&](Workshop& shop, int which) {
    const NodeMark& node = parts.marks[static_cast<std::size_t>(which)];
    const std::string device = fmt::format("dev-{}", which), epoch = std::to_string(node.epoch);
    const std::string plan = FleetSql::plan_sha256();
    while (Clock::now() < until) {
      const std::int64_t one = next++;
      if (one >= most) throw std::runtime_error("there are no more jobs");
      const std::string job = job_id(first + one), attempt = attempt_id(first + one);
      (void)shop.line.prepared(
          "WITH j AS (UPDATE job SET state='armed', device=$1, rev=2 WHERE id=$2 AND rev=1 "
          "RETURNING id, sheet, blank) SELECT knife_arm($3, $4, id, sheet, blank, $1, $5, 'olga', "
          "1, 'run') FROM j",
          {device, job, node.name, epoch, plan});
      ++done;
      const std::string fence = shop.line.prepared(
          "WITH j AS (UPDATE job SET state='cutting', started=1, rev=3 WHERE id=$2 AND rev=2 "
          "RETURNING id, sheet, blank, segment) SELECT knife_start($3, $4, $6, id, sheet, blank, "
          "segment, 0, 10, $1, '1', 'olga', $5, 'run', 1, 0) FROM j",
          {device, job, node.name, epoch, plan, attempt});
      if (fence.empty()) throw std::runtime_error("a job was not armed");
      ++done;
      (void)shop.line.prepared(
          "WITH j AS (UPDATE job SET state='done', finished=2, rev=4 WHERE id=$1 AND rev=3 "
          "RETURNING id) SELECT knife_end($2, $3, $4, 2, 'done', '', 1000, '{0}', '{9}', "
          "'{certain}') FROM j",
          {job, node.name, epoch, attempt});
      ++done;
    }
  });
  if (!fault.empty()) throw std::runtime_error(fault);
  return static_cast<double>(done) * 1000 / ms_since(begun);
}

}  // namespace popcut::testing
