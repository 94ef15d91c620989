// SPDX-License-Identifier: MIT
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/view/job_follow.hpp"
#include "daemon/cli/view/job_view.hpp"
#include "daemon/client/api.hpp"

namespace popcut::cli {
namespace job_actions_command {
namespace {

using client::Api;
using Json = nlohmann::json;

// As popcutd takes them.
constexpr std::int64_t kMostSheet = 10'000, kMostBlank = 1'000'000;
constexpr std::int64_t kMostPath = std::int64_t{1} << 40;

struct Options {
  std::string job, result, reason, before, device, registration{"kept"};
  std::optional<std::string> name{}, note{}, new_device{}, site{}, material{};
  std::optional<int> priority{};
  std::optional<int> sheet{}, blank{};
  std::optional<std::int64_t> from{};
  bool double_cut{false}, skip_in_doubt{false}, wait{false}, accept_warnings{false};
  bool plan_again{false};
  bool has_from{false};  ///< --from stands there, with a path or without
};

Result<Json> job_for(Api& api, const Options& options, const char* action) {
  return options.job.empty() ? api.only_job_for(action) : api.find_job(options.job);
}

/// The sheet that was named, or the job's current one.
Json sheet_of(const Options& options, const Json& job) {
  return options.sheet ? Json(*options.sheet) : job.value("sheet", Json());
}

Result<Json> act(Api& api, const Options& options, const char* action,
                 const std::function<Json(const Json&)>& body) {
  const auto job = job_for(api, options, action);
  if (!job) return tl::unexpected(job.error());
  return api.act(*job, action, body(*job));
}

/// Shows what may spoil the cut, and asks whether to cut all the same. Without a terminal nobody
/// can be asked; then popcutd refuses.
bool accepts_warnings(const Options& options, const Json& job) {
  const std::vector<std::string> warnings = unaccepted_warnings(job);
  if (warnings.empty()) return false;
  const bool asks =
      !options.accept_warnings && isatty(STDIN_FILENO) == 1 && isatty(STDERR_FILENO) == 1;
  if (options.accept_warnings || asks)
    for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
  if (!asks) return options.accept_warnings;
  fmt::print(stderr, "This may spoil the sheet. Arm it anyway? [y/N] ");
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "Y" || answer == "yes";
}

Result<Json> arm(Api& api, const Options& options) {
  const auto job = job_for(api, options, "arm");
  if (!job) return tl::unexpected(job.error());
  Json body{{"sheet", sheet_of(options, *job)},
            {"blank", options.blank ? Json(*options.blank) : job->value("blank", Json(1))}};
  if (!options.device.empty()) body["device"] = options.device;
  if (accepts_warnings(options, *job)) body["accept_warnings"] = (*job)["unaccepted_warnings"];
  return api.act(*job, "arm", body);
}

Result<Json> change(Api& api, const Options& options) {
  if (options.job.empty())
    return fail(ErrorKind::Usage, "JOB", "is empty; give an id from 'popcut jobs'");
  Json members = Json::object();
  if (options.priority) members["priority"] = *options.priority;
  if (options.name) members["name"] = *options.name;
  if (options.note) members["note"] = *options.note;
  if (options.new_device) members["device"] = *options.new_device;
  if (options.site) members["site"] = *options.site;
  if (options.material) members["material"] = *options.material;
  if (options.plan_again) members["plan_again"] = true;
  if (members.empty())
    return fail(
        ErrorKind::Usage, "command line",
        "nothing to change; give --priority, --name, --note, --device, --site or --plan-again");
  const auto job = api.find_job(options.job);
  if (!job) return job;
  return api.patch(*job, members);
}

Result<Json> start(Api& api, const Options& options) {
  return act(api, options, "start", [](const Json& job) {
    return Json{{"sheet", job.value("sheet", Json())}};
  });
}

Result<Json> plain(Api& api, const Options& options, const char* action) {
  return act(api, options, action, [](const Json&) { return Json::object(); });
}

Result<Json> cancel(Api& api, const Options& options) {
  return act(api, options, "cancel", [&](const Json&) {
    return options.reason.empty() ? Json::object() : Json{{"reason", options.reason}};
  });
}

/// --from without a path: the whole commands, to choose from.
Result<Json> say_how_to_resume(Api& api, const Options& options) {
  const auto named = job_for(api, options, "resume-from");
  if (!named) return tl::unexpected(named.error());
  const auto job = api.get("/v1/jobs/" + client::text_of(*named, "id"), "job " + options.job);
  if (!job) return job;
  std::string lines;
  for (const std::string& wait : waiting_for(*job)) {
    const std::size_t begin = wait.find("popcut resume "), comment = wait.find(" # ");
    if (begin == std::string::npos) continue;
    std::string line = wait.substr(begin, comment - begin);
    line.resize(line.find_last_not_of(' ') + 1);
    lines += (lines.empty() ? "" : ", or ") + line;
    if (comment != std::string::npos) lines += " (" + wait.substr(comment + 3) + ")";
  }
  return fail(
      ErrorKind::Usage, "--from",
      lines.empty()
          ? fmt::format("needs a path; no sheet of this job can be resumed, see popcut jobs {}",
                        short_id(*job))
          : "needs a path; possible now: " + lines);
}

Result<Json> resume(Api& api, const Options& options) {
  if (options.has_from && !options.from) return say_how_to_resume(api, options);
  if (!options.from) return plain(api, options, "resume");
  return act(api, options, "resume-from", [&](const Json&) {
    Json body{{"from_path", *options.from}, {"registration", options.registration}};
    if (options.double_cut) body["i_accept_double_cut"] = true;
    if (options.skip_in_doubt) body["skip_in_doubt"] = true;
    return body;
  });
}

Result<Json> with_sheet(Api& api, const Options& options, const char* action) {
  return act(api, options, action, [&](const Json& job) {
    return Json{{"sheet", sheet_of(options, job)}};
  });
}

Result<Json> confirm(Api& api, const Options& options) {
  return act(api, options, "confirm-result", [&](const Json& job) {
    return Json{{"sheet", sheet_of(options, job)}, {"good", options.result == "good"}};
  });
}

Result<Json> in_queue(Api& api, const Options& options, const char* action) {
  const auto job = api.find_job(options.job);
  if (!job) return tl::unexpected(job.error());
  Json body{{"job", client::text_of(*job, "id")}};
  if (!options.before.empty()) {
    const auto before = api.find_job(options.before);
    if (!before) return tl::unexpected(before.error());
    if (client::text_of(*before, "id") == client::text_of(*job, "id"))
      return fail(ErrorKind::Usage, "--before",
                  fmt::format("{} is the job to move; name another job, or leave --before out to "
                              "move it after all others of its priority",
                              options.before));
    body["before"] = client::text_of(*before, "id");
  }
  return api.post(fmt::format("/v1/queue/actions/{}", action), body,
                  "job " + client::text_of(*job, "id"), client::revision_of(*job));
}

/// Waits until the sheet that was started is no longer being cut.
Result<Json> wait_for_sheet(Api& api, const Json& job, const Globals& globals) {
  return follow_job(api, client::text_of(job, "id"), globals, [&](const Json& now) {
    const std::string state = client::text_of(now, "state");
    return state != "cutting" && state != "paused" && state != "armed";
  });
}

using Work = std::function<Result<Json>(Api&, const Options&)>;

/// The new state of the job, in a line.
using Outcome = std::function<std::string(const Json&, const Options&)>;

std::string state_line(const Json& job, const Options&) { return job_summary(job); }

std::string cancel_line(const Json& job, const Options&) {
  return has_ended(job)
             ? job_summary(job)
             : "is being cancelled; the cut stops after the current stroke, with the tool up";
}

std::string move_line(const Json& job, const Options& options) {
  return options.before.empty()
             ? "is now last of its priority; " + job_summary(job)
             : fmt::format("is now before {}; {}", options.before, job_summary(job));
}

Result<void> run_action(Api& api, const Options& options, const Globals& globals, const Work& work,
                        const Outcome& outcome) {
  auto job = work(api, options);
  if (job && options.wait) job = wait_for_sheet(api, *job, globals);
  if (!job) return tl::unexpected(job.error());
  if (globals.json) print_json(*job);
  if (!globals.quiet && !options.wait) {
    fmt::print(stderr, "{}: {}\n", job_title(*job), outcome(*job, options));
    std::vector<std::string> next = waiting_for(*job);
    if (next.empty() && !has_ended(*job))
      next.push_back(fmt::format("popcut jobs {} --watch", short_id(*job)));
    for (const std::string& line : waiting_lines(next, 2)) fmt::print(stderr, "{}\n", line);
  }
  if (options.wait && client::text_of(*job, "state") == "interrupted") return verdict(*job);
  return {};
}

// The commands

struct Words {
  const char* name;
  const char* help;
  Work work;
  bool job_needed{false};
  Outcome outcome{state_line};
};

Command add(const Command& app, const Globals& globals, Run& run, const Words& words,
            const std::shared_ptr<Options>& options) {
  const Command command = app.add_command(words.name, words.help);
  command
      .add_option("JOB", options->job,
                  words.job_needed ? "Id of the job, or its first letters"
                                   : "Id of the job, or its first letters; you can leave it out if "
                                     "this is possible for only one job now")
      .required(words.job_needed);
  command.on_choice([options, &globals, &run, words] {
    run = [options, &globals, words] {
      return with_popcutd(
          [&](Api& api) { return run_action(api, *options, globals, words.work, words.outcome); });
    };
  });
  return command;
}

void add_sheet(const Command& command, const std::shared_ptr<Options>& options) {
  whole_number(command.add_option("SHEET", options->sheet,
                                  "Number of the sheet, from 1; default: the current one"),
               1, kMostSheet);
}

Work named(Result<Json> (*work)(Api&, const Options&, const char*), const char* action) {
  return [work, action](Api& api, const Options& options) { return work(api, options, action); };
}

constexpr const char* kArmHelp =
    "Tell popcutd that the sheet is in the cutter and may be cut. Nothing moves yet.\n\n"
    "  popcut arm 01JDX7 2          # sheet 2 is loaded\n"
    "  popcut start 01JDX7          # cut it, within 10 minutes\n\n"
    "This allows one cut of this sheet on this blank (the paper you loaded). After 10 minutes, or\n"
    "if popcutd restarts, arm it again. If a warning says that the cut may be spoiled, popcut "
    "asks\n"
    "you first.";
constexpr const char* kStartHelp =
    "Cut the sheet that you armed.\n\n"
    "  popcut start 01JDX7\n"
    "  popcut start 01JDX7 --wait   # return when the sheet is cut";
constexpr const char* kPauseHelp =
    "Pause a cut after the current stroke, with the tool up; 'popcut resume' continues it.\n\n"
    "  popcut pause 01JDX7";
constexpr const char* kResumeHelp =
    "Continue a paused cut or an interrupted sheet.\n\n"
    "  popcut resume 01JDX7                 # after 'popcut pause'\n"
    "  popcut resume 01JDX7 --from          # after an interruption: the commands to choose from\n"
    "  popcut resume 01JDX7 --from 118      # cut from path 118 on\n\n"
    "After --from, arm and start the sheet again. A new sheet ('popcut retry') is safer.";
constexpr const char* kCancelHelp =
    "Cancel a job. A running cut stops after the current stroke, with the tool up.\n\n"
    "  popcut cancel 01JDX7 --reason 'wrong colour'";
constexpr const char* kDisarmHelp =
    "Undo 'popcut arm': do not cut the sheet now.\n\n"
    "  popcut disarm 01JDX7";
constexpr const char* kRetryHelp =
    "Cut a sheet again on a new blank. Nothing moves until you arm and start it.\n\n"
    "  popcut retry 01JDX7 2";
constexpr const char* kConfirmHelp =
    "Tell popcutd whether a sheet came out good or bad.\n\n"
    "  popcut confirm 01JDX7 2 good\n"
    "  popcut confirm 01JDX7 2 bad";
constexpr const char* kSkipHelp =
    "Skip a sheet and continue with the next one.\n\n"
    "  popcut skip 01JDX7 2";
constexpr const char* kHoldHelp =
    "Hold a job back: nobody can arm it until 'popcut release'.\n\n"
    "  popcut hold 01JDX7";
constexpr const char* kReleaseHelp =
    "Release a held job.\n\n"
    "  popcut release 01JDX7";
constexpr const char* kChangeHelp =
    "Change a queued, planning or ready job: its priority, name, note, cutter or site.\n\n"
    "  popcut change 01JDX7 --priority 5\n"
    "  popcut change 01JDX7 --device usb:51053P\n"
    "  popcut change 01JDX7 --device ''         # any cutter that fits\n"
    "  popcut change 01JDX7 --site upstairs     # only a cutter there\n"
    "  popcut change 01JDX7 --device sim:cameo4 --plan-again\n\n"
    "A plan is for one model of cutter. --plan-again makes a new one for the cutter and the "
    "material\n"
    "that you name, as long as nothing of the job has been cut.";
constexpr const char* kMoveHelp =
    "Move a job before another of the same priority, or after all of them.\n\n"
    "  popcut move 01JDX7 --before 01JDX2\n"
    "  popcut move 01JDX7";

void add_resume(const Command& app, const Globals& globals, Run& run) {
  auto options = std::make_shared<Options>();
  const Command command = add(app, globals, run, {"resume", kResumeHelp, resume}, options);
  const Option from = command.add_option(
      "--from", options->from,
      "First path to cut, counted from 0; without a value: print the commands to choose from");
  whole_number_if_given(from, 0, kMostPath).value_text("PATH");
  command.on_read([options, from] { options->has_from = from.is_given(); });
  one_word(
      command.add_option(
          "--registration", options->registration,
          "kept: the sheet has not moved; re-registered: you loaded it again in the same place"),
      {"kept", "re-registered"}, "kept");
  command.add_flag("--accept-double-cut", options->double_cut,
                   "Allow popcutd to cut a path a second time if it is cut already, or perhaps cut "
                   "(in doubt)");
  command.add_flag("--skip-in-doubt", options->skip_in_doubt,
                   "Leave out paths in doubt (perhaps cut) before --from");
}

void add_change(const Command& app, const Globals& globals, Run& run) {
  auto options = std::make_shared<Options>();
  const Command command = add(app, globals, run, {"change", kChangeHelp, change, true}, options);
  whole_number(command.add_option("--priority", options->priority,
                                  "Priority in the queue; higher goes first"),
               -10, 10)
      .value_text("-10..10");
  command.add_option("--name", options->name, "Name of the job").value_text("TEXT");
  command.add_option("--note", options->note, "Note for the person who cuts it").value_text("TEXT");
  command.add_option("--device", options->new_device, "Cutter to use; empty: any that fits")
      .value_text("ID");
  command
      .add_option("--site", options->site,
                  "Site of the cutters that may cut it, as 'popcut devices' shows it; empty: any")
      .value_text("TEXT");
  command.add_option("--material", options->material, "Material to use; needs --plan-again")
      .value_text("NAME");
  command.add_flag("--plan-again", options->plan_again,
                   "Make a new plan, for the cutter and the material");
}

}  // namespace
}  // namespace job_actions_command

void register_job_actions(const Command& app, const Globals& globals, Run& run) {
  using namespace job_actions_command;
  const auto fresh = [] { return std::make_shared<Options>(); };
  auto options = fresh();
  Command command = add(app, globals, run, {"arm", kArmHelp, arm}, options);
  add_sheet(command, options);
  whole_number(
      command.add_option("--blank", options->blank,
                         "Number of the blank (the paper), from 1; default: the current one"),
      1, kMostBlank)
      .value_text("N");
  command
      .add_option(
          "--device", options->device,
          "Cutter that holds the sheet, if several could cut it; 'popcut devices' lists them")
      .value_text("ID");
  command.add_flag(
      "--accept-warnings", options->accept_warnings,
      "Arm the sheet although a warning of 'popcut jobs JOB' says that the cut may be spoiled");
  options = fresh();
  command = add(app, globals, run, {"start", kStartHelp, start}, options);
  command.add_flag("--wait", options->wait, "Wait until the sheet is cut");
  add(app, globals, run, {"pause", kPauseHelp, named(plain, "pause")}, fresh());
  add_resume(app, globals, run);
  add_change(app, globals, run);
  options = fresh();
  command = add(app, globals, run, {"cancel", kCancelHelp, cancel, true, cancel_line}, options);
  command.add_option("--reason", options->reason, "Reason, for the record").value_text("TEXT");
  add(app, globals, run, {"disarm", kDisarmHelp, named(plain, "disarm")}, fresh());
  options = fresh();
  add_sheet(add(app, globals, run, {"retry", kRetryHelp, named(with_sheet, "retry-sheet"), true},
                options),
            options);
  options = fresh();
  command = add(app, globals, run, {"confirm", kConfirmHelp, confirm, true}, options);
  whole_number(command.add_option("SHEET", options->sheet, "Number of the sheet, from 1"), 1,
               kMostSheet)
      .required();
  one_word(command.add_option("RESULT", options->result, "good or bad"), {"good", "bad"})
      .required();
  options = fresh();
  add_sheet(
      add(app, globals, run, {"skip", kSkipHelp, named(with_sheet, "skip-sheet"), true}, options),
      options);
  add(app, globals, run, {"hold", kHoldHelp, named(in_queue, "hold"), true}, fresh());
  add(app, globals, run, {"release", kReleaseHelp, named(in_queue, "release"), true}, fresh());
  options = fresh();
  command = add(app, globals, run, {"move", kMoveHelp, named(in_queue, "move"), true, move_line},
                options);
  command
      .add_option("--before", options->before,
                  "Move it before this job; default: after all others of its priority")
      .value_text("JOB");
}

}  // namespace popcut::cli
