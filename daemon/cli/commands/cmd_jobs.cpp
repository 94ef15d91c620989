// SPDX-License-Identifier: MIT
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <optional>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/text/words.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/help/terminal_text.hpp"
#include "daemon/cli/view/job_follow.hpp"
#include "daemon/cli/view/job_view.hpp"
#include "daemon/client/api.hpp"

namespace popcut::cli {
namespace jobs_command {
namespace {

using client::Api;
using Json = nlohmann::json;

struct Options {
  std::string job, state;
  bool watch{false}, all{false};
};

Result<std::vector<Json>> wanted_jobs(Api& api, const Options& options) {
  if (!options.state.empty())
    return api.list("/v1/jobs?state=" + percent_encoded(options.state), "--state");
  return options.all ? api.list("/v1/jobs", "jobs") : api.open_jobs();
}

bool on_terminal() { return isatty(STDOUT_FILENO) == 1; }

ViewStyle style_of_terminal() {
  ViewStyle style;
  style.width = on_terminal() ? terminal_columns(STDOUT_FILENO, 80) : 1000;
  const char* const plain = std::getenv("NO_COLOR");
  style.colour = on_terminal() && (plain == nullptr || *plain == '\0');
  return style;
}

int rows_of_terminal() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 4 ? size.ws_row : 24;
}

std::string time_now() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%H:%M:%S}", fmt::localtime(now));
}

/// Puts those that wait for a cutter in the order of the queue; all others keep theirs, behind.
void order_as_queue(Api& api, std::vector<Json>& jobs) {
  constexpr std::size_t kMost = 200;  // as many as the view shows
  if (jobs.size() < 2) return;
  const auto queue = api.list("/v1/queue", "queue", kMost);
  if (!queue) return;  // the view without it is better than none
  std::map<std::string, std::size_t> places;
  for (const Json& job : *queue) places.emplace(client::text_of(job, "id"), places.size());
  const auto place_of = [&](const Json& job) {
    const auto found = places.find(client::text_of(job, "id"));
    return found == places.end() ? places.size() : found->second;
  };
  std::stable_sort(jobs.begin(), jobs.end(),
                   [&](const Json& a, const Json& b) { return place_of(a) < place_of(b); });
}

// The list

Result<void> list_jobs(Api& api, const Options& options, const Globals& globals) {
  auto jobs = wanted_jobs(api, options);
  if (!jobs) return tl::unexpected(jobs.error());
  return answer(globals, Json{{"jobs", *jobs}}, [&] {
    order_as_queue(api, *jobs);
    for (const std::string& line : jobs_view(*jobs, style_of_terminal())) fmt::print("{}\n", line);
    if (jobs->empty() && !globals.quiet)
      fmt::print(stderr, "no jobs{}; 'popcut cut FILE' queues one\n",
                 options.all ? "" : " in progress (--all includes finished jobs)");
  });
}

void print_job(Api& api, Json job) {
  const std::string path = "/v1/jobs/" + client::text_of(job, "id") + "/sheets";
  const auto sheets = api.list(path, "sheets");
  std::optional<Json> ledger;
  if (client::text_of(job, "state") == "interrupted")
    if (auto found = api.get(fmt::format("{}/{}/ledger", path, job.value("sheet", Json(1)).dump()),
                             "ledger"))
      ledger = std::move(*found);
  if (!api.http().address().path.empty())  // a socket is of this computer
    for (const char* key : {"owner", "operator"})
      if (const std::string name = client::text_of(job, key); !name.empty())
        job[key] = person_name(name);
  for (const std::string& line :
       job_details(job, sheets ? *sheets : std::vector<Json>{}, ledger, style_of_terminal().width))
    fmt::print("{}\n", line);
}

Result<void> show_job(Api& api, const Options& options, const Globals& globals) {
  const auto job = api.find_job(options.job);
  if (!job) return tl::unexpected(job.error());
  return answer(globals, *job, [&] { print_job(api, *job); });
}

// The live view

/// Draws over what it drew before.
class Screen {
 public:
  void draw(const std::vector<std::string>& lines) {
    // At another width what was drawn has wrapped: nobody knows where it begins.
    const std::size_t columns = terminal_columns(STDOUT_FILENO, 80);
    const bool resized = lines_ > 0 && columns != columns_;
    columns_ = columns;
    std::string frame = resized      ? "\x1b[2J\x1b[H"
                        : lines_ > 0 ? fmt::format("\x1b[{}A\r", lines_)
                                     : "";
    const auto rows = static_cast<std::size_t>(rows_of_terminal() - 1);
    const std::size_t shown = std::min(lines.size(), rows);
    const bool all = shown == lines.size();
    for (std::size_t k = 0; k + (all ? 0 : 1) < shown; ++k) frame += lines[k] + "\x1b[K\n";
    if (!all)
      frame += fitted(fmt::format("... {} more lines; 'popcut jobs' shows all",
                                  lines.size() - shown + 1),
                      columns) +
               "\x1b[K\n";
    frame += "\x1b[J";
    fmt::print("{}", frame);
    std::fflush(stdout);
    lines_ = shown;
  }

 private:
  std::size_t lines_{0}, columns_{0};
};

/// Where there is no terminal: a line for each change.
class ChangeList {
 public:
  void tell(const std::vector<Json>& jobs, bool json) {
    for (const Json& job : jobs) {
      const std::string now = client::text_of(job, "state") + job.value("sheet", Json()).dump() +
                              job.value("attention", Json()).dump();
      std::string& before = seen_[client::text_of(job, "id")];
      if (now == before) continue;
      before = now;
      if (json) {
        fmt::print("{}\n", json_line(job));
        continue;
      }
      fmt::print("{} {} {}: {}\n", time_now(), short_id(job), job_title(job), job_summary(job));
      for (const std::string& wait : waiting_for(job)) fmt::print("  -> {}\n", wait);
    }
    std::fflush(stdout);
  }
  void tell_gone(const Json& job, bool json) {
    seen_.erase(client::text_of(job, "id"));
    if (json) return;
    fmt::print("{} {} {}: popcutd no longer has it\n", time_now(), short_id(job), job_title(job));
    std::fflush(stdout);
  }

 private:
  std::map<std::string, std::string> seen_;
};

/// The jobs in a view: those that were open, and those that have ended since. Jobs that popcutd no
/// longer has, because they were deleted or an older database was restored, leave it.
class JobsInView {
 public:
  /// @return the jobs that left
  std::vector<Json> take(Api& api, std::vector<Json> open) {
    std::vector<Json> gone;
    std::vector<std::string> ended;
    for (auto it = seen_.begin(); it != seen_.end();) {
      const bool is_open = std::any_of(open.begin(), open.end(), [&](const Json& one) {
        return client::text_of(one, "id") == it->first;
      });
      if (!is_open && has_ended(it->second)) ended.push_back(it->first);
      const bool stays = is_open || has_ended(it->second) || look(api, it->second);
      if (!stays) gone.push_back(std::move(it->second));
      it = stays ? std::next(it) : seen_.erase(it);
    }
    // Those that have ended change only if somebody removes them: a few of them at each look.
    for (std::size_t k = 0; k < std::min(kEndedAtOnce, ended.size()); ++k) {
      const auto one = seen_.find(ended[next_++ % ended.size()]);
      if (one == seen_.end() || look(api, one->second)) continue;
      gone.push_back(std::move(one->second));
      seen_.erase(one);
    }
    for (Json& job : open) {
      std::string id = client::text_of(job, "id");
      seen_[std::move(id)] = std::move(job);
    }
    return gone;
  }
  [[nodiscard]] std::vector<Json> all() const {
    std::vector<Json> jobs;
    for (const auto& [id, job] : seen_) jobs.push_back(job);
    return jobs;
  }
  [[nodiscard]] bool empty() const { return seen_.empty(); }

 private:
  static constexpr std::size_t kEndedAtOnce = 8;

  /// Reads the job again; false if popcutd does not have it.
  static bool look(Api& api, Json& job) {
    const std::string id = client::text_of(job, "id");
    auto now = api.get("/v1/jobs/" + id, "job " + id);
    if (now) job = std::move(*now);
    return now || now.error().reason != ErrorReason::NotThere;
  }

  std::map<std::string, Json> seen_;
  std::size_t next_{0};
};

Result<void> watch_jobs(Api& api, const Options& options, const Globals& globals) {
  Screen screen;
  ChangeList changes;
  JobsInView view;
  return watch_events(api, [&]() -> Result<bool> {
    auto jobs = wanted_jobs(api, options);
    if (!jobs && jobs.error().kind != ErrorKind::DeviceGone) return tl::unexpected(jobs.error());
    const bool away = !jobs;
    if (away && view.empty()) return tl::unexpected(jobs.error());
    std::vector<Json> gone;
    if (jobs) gone = view.take(api, std::move(*jobs));
    std::vector<Json> all = view.all();
    if (!on_terminal() || globals.json) {
      for (const Json& job : gone) changes.tell_gone(job, globals.json);
      changes.tell(all, globals.json);
      return true;
    }
    order_as_queue(api, all);
    const ViewStyle style = style_of_terminal();
    std::vector<std::string> lines = jobs_view(all, style);
    const std::string head =
        fmt::format("{}  {}  (Ctrl-C ends this view, not the jobs)", time_now(),
                    away ? "popcutd does not answer; trying again" : api.http().address().text());
    const std::vector<std::string> header = wrapped(head, style.width, 2);
    lines.insert(lines.begin(), header.begin(), header.end());
    if (all.empty())
      for (std::string& line : wrapped("no jobs; 'popcut cut FILE' queues one", style.width, 2))
        lines.push_back(std::move(line));
    screen.draw(lines);
    return true;
  });
}

Result<void> run_jobs(Api& api, const Options& options, const Globals& globals) {
  if (options.job.empty())
    return options.watch ? watch_jobs(api, options, globals) : list_jobs(api, options, globals);
  if (!options.watch) return show_job(api, options, globals);
  const auto job = api.find_job(options.job);
  if (!job) return tl::unexpected(job.error());
  const auto last =
      follow_job(api, client::text_of(*job, "id"), globals, [](const Json&) { return false; });
  if (!last) return tl::unexpected(last.error());
  if (globals.json) print_json(*last);
  return {};
}

constexpr const char* kHelp =
    "List the jobs of popcutd, with the next command for each.\n\n"
    "  popcut jobs --watch           # a live view; Ctrl-C ends it\n"
    "  popcut jobs                   # all jobs that are not finished\n"
    "  popcut jobs 01JDX7            # one job in full; the first letters of its id are enough\n"
    "  popcut jobs 01JDX7 --watch    # follow one job until it ends\n\n"
    "A job is queued, planning, ready (load the sheet, then 'popcut arm'), armed (then 'popcut\n"
    "start'), cutting, paused, interrupted, done, failed or cancelled. If the output is not a\n"
    "terminal, --watch prints a line for each change. With --json, each line is a JSON document.";

}  // namespace
}  // namespace jobs_command

void register_jobs(const Command& app, const Globals& globals, Run& run) {
  using namespace jobs_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("jobs", kHelp);
  command.add_option("JOB", options->job, "Id of a job, or its first letters");
  command.add_flag("--watch", options->watch, "Keep running and show changes");
  command.add_flag("--all", options->all, "Include finished jobs");
  command.add_option("--state", options->state, "Only jobs in these states, separated by commas")
      .value_text("STATE");
  when_chosen(command, run, [options, &globals] {
    return with_popcutd([&](Api& api) { return run_jobs(api, *options, globals); });
  });
}

}  // namespace popcut::cli
