// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/recovery.hpp"

#include <fmt/format.h>

#include "daemon/service/repositories/reports.hpp"

namespace popcut::daemon {
namespace {

// The attempts that nobody ended, and what they leave of their jobs.
void close_attempts(ServiceStore& store, JobRepository& jobs) {
  AttemptTable& attempts = jobs.attempts();
  for (const AttemptRow& open : attempts.open()) {
    attempts.crash(open.id, store.now());
    Answer<JobRow> row = jobs.row(open.job);
    if (!row || is_terminal(row->state)) continue;
    std::vector<std::vector<FateRun>> fates;
    for (const AttemptRow& attempt : attempts.of_sheet(open.job, open.sheet))
      if (attempt.blank == open.blank) fates.push_back(attempts.fates(attempt.id));
    row->paths_certain = row->paths_sent = 0;
    for (const FateRun& run : merged_fates(open.strokes, fates)) {
      const std::int64_t count = run.paths.last - run.paths.first + 1;
      if (run.fate == PathFate::Certain) row->paths_certain += count;
      if (run.fate != PathFate::NotSent) row->paths_sent += count;
    }
    jobs.table().update(*row);
    record_usage(store, *row,
                 {.operator_name = open.operator_name, .device = open.device, .sheet = open.sheet});
  }
}

}  // namespace

Answer<void> recover(ServiceStore& store, JobRepository& jobs) {
  return store.change([&]() -> Answer<void> {
    close_attempts(store, jobs);
    store.db().run("DELETE FROM arm");
    for (const JobState state :
         {JobState::Cutting, JobState::Paused, JobState::Armed, JobState::Planning}) {
      JobFilter filter;
      filter.states = {state};
      // Each leaves its state, so the next few are the first ones.
      std::string looked_to;
      for (;;) {
        const std::string after = looked_to;
        std::vector<JobRow> rows = jobs.table().list(filter, after, 100, looked_to);
        if (rows.empty() && looked_to.empty()) break;
        for (JobRow& row : rows) {
          const std::string from(name_of(row.state));
          const Step step = step_of(row.state, JobEvent::Restarts);
          if (step == Step::ToInterrupted)
            jobs.set_attention(row, "in_doubt",
                               "popcutd ended during the cut; see which paths are in doubt");
          jobs.take(row, step, step == Step::ToInterrupted ? "crash" : "restart");
          store.emit("job", row.id,
                     fmt::format(R"("state":"{}","rev":{},"recovered":{{"from":"{}","to":"{}"}})",
                                 name_of(row.state), row.rev, from, name_of(row.state)));
          store.log(fmt::format("job {}: {} after a restart, it was {}", row.id, name_of(row.state),
                                from));
        }
      }
    }
    return {};
  });
}

}  // namespace popcut::daemon
