// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/formats/svg/svg_reader.hpp"
#include "core/plan/plan_json.hpp"
#include "core/plan/sheet_svg.hpp"
#include "core/plan/test_shape.hpp"
#include "core/text/shown_text.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/cut_queue.hpp"
#include "daemon/cli/cut_device.hpp"
#include "daemon/cli/expectation.hpp"
#include "daemon/cli/fault_file.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/options/plan_job.hpp"
#include "daemon/cli/view/pause_key.hpp"
#include "daemon/cli/view/progress_bar.hpp"
#include "daemon/files/output_folder.hpp"
#include "device/compare/expect.hpp"
#include "device/session/session.hpp"

namespace popcut::cli {
namespace cut_command {
namespace {

struct Options {
  PlanJobOptions job;
  std::string device, treat_as, folder, faults;
  bool direct{false}, yes{false}, test{false};
  int copies{1}, priority{0};
  std::string name;
  bool wait{false};
  std::map<std::string, std::string> plan_words{};  ///< options of the plan as they were typed
};

// Ctrl-C asks the session to stop at the end of a stroke, with the tool up.
std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");
extern "C" void ask_to_stop(int) { stop_asked = true; }

class InterruptGuard {
 public:
  InterruptGuard() : before_(std::signal(SIGINT, ask_to_stop)) { stop_asked = false; }
  ~InterruptGuard() { std::signal(SIGINT, before_); }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  void (*before_)(int);
};

// 1. May it be cut?

/// A person says yes to each sheet, or --yes stands for it.
Result<void> ask(const Options& options, const PlanJob& job, std::size_t sheet,
                 const CutTarget& target) {
  if (options.yes || target.device.kind == DeviceKind::File) return {};
  if (isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1)
    return fail(ErrorKind::Refused, "",
                "nobody to ask whether to start: not on a terminal; with a simulated device --yes "
                "answers");
  const PlannedSheet& planned = job.plan.sheets[sheet];
  const std::string mat =
      planned.mat.name.empty() ? "" : fmt::format(" on the {} mat", planned.mat.name);
  fmt::print(
      stderr, "Load sheet {} of {} ({}){} into {}, about {:.0f} min. Start cutting? [y/N] ",
      sheet + 1, job.plan.sheets.size(), job.plan.material.title, mat,
      target.simulated() ? target.device.text : target.machine.title + " at " + target.device.text,
      std::ceil(planned.seconds / 60));
  std::string answer;
  std::getline(std::cin, answer);
  if (answer == "y" || answer == "Y" || answer == "yes") return {};
  return fail(ErrorKind::Refused, "",
              fmt::format("sheet {} was not started, since nobody said yes; what is cut so far "
                          "stays",
                          sheet + 1));
}

// 2. One sheet.

struct CutSheet {
  SessionEnd end;
  std::optional<Trace> trace;  ///< of a simulated cutter
  std::uint64_t certain{}, in_doubt{}, not_sent{};
};

Result<CutSheet> cut_sheet(const PlanJob& job, std::size_t sheet, const CutTarget& target,
                           const Globals& globals) {
  const PlannedSheet& planned = job.plan.sheets[sheet];
  auto cable = Cable::open(target, sheet_path(target, sheet, job.plan.sheets.size()),
                           {planned.area_mm[0], planned.area_mm[1]});
  if (!cable) return tl::unexpected(cable.error());
  ProgressBar bar(!globals.quiet);
  const double whole = planned.seconds;
  PauseKey pause;
  SessionOptions options;
  options.cancel = &stop_asked;
  options.pause = &pause.asked();
  options.progress = [&](const SessionProgress& p) {
    pause.look();
    const std::string what =
        p.phase == SessionPhase::Cutting
            ? fmt::format("cutting, stroke {} of {}", p.strokes_done, p.strokes)
        : p.phase == SessionPhase::Held ? "held with the tool up, p goes on"
                                        : std::string(name_of(p.phase));
    bar.show(what, 1 - p.seconds_left / std::max(whole, 1.0), p.seconds_left);
  };
  CutSheet cut;
  const InterruptGuard guard;  // at the question, Ctrl-C ends popcut as usual
  cut.end = run_session(cable->transport(), target.machine, job.programs[sheet], options);
  cut.trace = cable->trace();
  if (!cut.end.error && !cut.end.cancelled)
    if (const auto kept = cable->finish(); !kept) cut.end.error = kept.error();
  for (const StrokeFate fate : cut.end.fates)
    ++(fate == StrokeFate::Certain   ? cut.certain
       : fate == StrokeFate::InDoubt ? cut.in_doubt
                                     : cut.not_sent);
  cut.not_sent -= job.programs[sheet].dots.size();
  return cut;
}

/// What became of the sheet, as an error if it is not whole. The simulated cutter is asked what it
/// really drew.
Result<void> judge(const PlanJob& job, std::size_t sheet, const CutSheet& cut) {
  const std::string place = fmt::format("sheet {}", sheet + 1);
  const std::string ledger = fmt::format("{} strokes are cut, {} in doubt, {} not sent",
                                         cut.certain, cut.in_doubt, cut.not_sent);
  if (cut.end.error) {
    Error error = within(place, *cut.end.error);
    error.detail += "; " + ledger;
    return tl::unexpected(error);
  }
  if (cut.end.cancelled)
    return fail(ErrorKind::Refused, place,
                "stopped as asked, with the tool up and parked; " + ledger);
  if (!cut.trace) return {};
  Expected expected;
  auto drawing = linework_from_svg(sheet_svg(job.plan.sheets[sheet], ""), SvgProfile::Popcut);
  if (!drawing) return tl::unexpected(within(place, drawing.error()));
  expected.drawing = std::move(*drawing);
  add_knife(job.plan.sheets[sheet].knife, expected);
  const auto held = expect(*cut.trace, expected);
  if (!held) return tl::unexpected(within(place, held.error()));
  return {};
}

Result<void> keep(OutputFolder& folder, const PlanJob& job, std::size_t sheet,
                  const CutSheet& cut) {
  const std::string title = fmt::format("{}: sheet {}", job.plan.name, sheet + 1);
  const auto name = [&](const char* ending) { return PlanJob::sheet_file(sheet, ending); };
  const auto sent = folder.add(job.program_file(sheet), job.programs[sheet].bytes).and_then([&] {
    return folder.add(name("svg"), sheet_svg(job.plan.sheets[sheet], title));
  });
  if (!sent || !cut.trace) return sent;
  return folder.add(name("cut.svg"), trace_svg(*cut.trace)).and_then([&] {
    return folder.add(name("trace.json"), trace_json(*cut.trace));
  });
}

nlohmann::ordered_json sheet_json(const CutSheet& cut, std::size_t sheet,
                                  const Result<void>& judged) {
  nlohmann::ordered_json json{
      {"sheet", sheet + 1},
      {"done", judged.has_value()},
      {"confirmed", cut.end.confirmed},
      {"strokes",
       {{"certain", cut.certain}, {"in_doubt", cut.in_doubt}, {"not_sent", cut.not_sent}}},
      {"seconds", cut.end.seconds},
      {"identity", cut.end.identity}};
  if (cut.trace) json["cut_mm"] = cut.trace->cut_mm;
  if (!judged) json["error"] = message(judged.error());
  return json;
}

void say(const PlanJob& job, std::size_t sheet, const CutSheet& cut, const CutTarget& target) {
  const std::size_t sheets = job.plan.sheets.size();
  if (target.device.kind == DeviceKind::File) {
    fmt::print(stderr, "sheet {} of {}: the program is in {}; nothing is cut\n", sheet + 1, sheets,
               sheet_path(target, sheet, sheets));
    return;
  }
  if (cut.trace)
    fmt::print(stderr, "sheet {} of {}: {} strokes, {:.0f} mm cut on {} in {:.0f} s of its time\n",
               sheet + 1, sheets, cut.trace->lifts, cut.trace->cut_mm, target.device.text,
               cut.end.seconds);
  else
    fmt::print(stderr,
               "sheet {} of {}: {} strokes cut, {} in doubt, {} not sent, on {} in {:.0f} s\n",
               sheet + 1, sheets, cut.certain, cut.in_doubt, cut.not_sent, target.device.text,
               cut.end.seconds);
  if (!cut.end.confirmed && !cut.end.error)
    fmt::print(stderr,
               "  this machine answers nothing: {} strokes count as cut, {} are in doubt "
               "until a person looks\n",
               cut.certain, cut.in_doubt);
}

// 3. The work.

Result<void> cut_all(const Options& options, const Globals& globals, const PlanJob& job,
                     const CutTarget& target, std::optional<OutputFolder>& folder,
                     nlohmann::ordered_json& sheets) {
  for (std::size_t sheet = 0; sheet < job.plan.sheets.size(); ++sheet) {
    if (auto asked = ask(options, job, sheet, target); !asked) return asked;
    const auto cut = cut_sheet(job, sheet, target, globals);
    if (!cut) return tl::unexpected(cut.error());
    const Result<void> judged = judge(job, sheet, *cut);
    sheets.push_back(sheet_json(*cut, sheet, judged));
    if (folder)
      if (auto kept = keep(*folder, job, sheet, *cut); !kept) return kept;
    if (!globals.quiet) say(job, sheet, *cut, target);
    std::fflush(stderr);  // the next sheet may take long
    if (!judged) return judged;
  }
  return {};
}

/// What stands in the way of leaving the cut to popcutd, or doing it from here.
Result<void> check_words(const Options& options) {
  const auto wrong = [](const char* option, const char* why) {
    return fail(ErrorKind::Usage, option, why);
  };
  if (options.direct && (options.wait || options.copies != 1 || options.priority != 0))
    return wrong("--direct",
                 "cuts from here and at once; --wait, --copies and --priority are for "
                 "the queue of popcutd");
  if (options.direct) return {};
  if (options.test && (options.copies != 1 || options.priority != 0 ||
                       !options.plan_words.empty() || !options.name.empty()))
    return wrong("--test",
                 "takes --device, --material and --wait; popcutd plans its shape itself; more "
                 "with --direct");
  if (options.yes)
    return wrong("--yes",
                 "works with --direct only: a job waits for 'popcut arm' and 'popcut "
                 "start'");
  if (!options.faults.empty())
    return wrong("--faults", "works with --direct; popcutd has them in its configuration");
  if (!options.folder.empty())
    return wrong("--output",
                 "works with --direct; popcutd keeps the plan's files, see 'popcut "
                 "jobs JOB'");
  if (!options.job.machine.empty() || !options.treat_as.empty())
    return wrong(options.treat_as.empty() ? "--machine" : "--treat-as",
                 "works with --direct; with popcutd the device says what it is: --device");
  return {};
}

Result<void> run_cut(const Options& options, const Globals& globals) {
  if (options.test != options.job.input.empty())
    return fail(ErrorKind::Usage, "command line",
                options.test ? "INPUT and --test both; --test cuts a shape of its own"
                             : "INPUT is missing; name a SPEC or a pattern, or give --test");
  if (const auto lawful = check_words(options); !lawful) return lawful;
  if (!options.direct) {
    const QueueWish wish{options.job.input,  options.device, options.job.material, options.name,
                         options.plan_words, options.copies, options.priority,     options.wait};
    return options.test ? queue_test_cut(wish, globals) : queue_cut(wish, globals);
  }
  const bool simulated = options.device.empty() || options.device.rfind("sim:", 0) == 0;
  if (options.yes && !simulated)
    return fail(ErrorKind::Usage, "--yes",
                fmt::format("works with simulated devices only, and {} is none: a person must look "
                            "at each sheet before it is cut; leave --yes out",
                            options.device));
  auto target = choose_target({options.device, options.job.machine, options.treat_as});
  if (!target) return tl::unexpected(target.error());
  if (!options.faults.empty()) {
    auto faults = read_faults(options.faults, *target);
    if (!faults) return tl::unexpected(faults.error());
    target->faults = std::move(*faults);
  }
  PlanJobOptions how = options.job;
  how.machine = target->machine.name;
  how.order.progress = !globals.quiet;
  if (options.test) {
    how.drawing = test_shape();
    if (how.at.empty() && !how.marks.wanted) how.at = "5,5";
  }
  const auto job = make_plan_job(how);
  if (!job) return tl::unexpected(job.error());
  std::optional<OutputFolder> folder;
  if (!options.folder.empty()) {
    auto opened = OutputFolder::open(options.folder);
    if (!opened) return tl::unexpected(opened.error());
    folder = std::move(*opened);
  }
  if (!globals.quiet)
    for (const std::string& warning : job->plan.warnings)
      fmt::print(stderr, "warning: {}\n", shown_text(warning));
  nlohmann::ordered_json sheets = nlohmann::ordered_json::array();
  // What happened is kept, whatever happened.
  const Result<void> cut = cut_all(options, globals, *job, *target, folder, sheets);
  if (folder) {
    if (auto done = folder->add("plan.json", plan_json(job->plan)); !done) return done;
    if (auto done = folder->commit("popcut cut " POPCUT_VERSION); !done) return done;
    if (!globals.quiet)
      fmt::print(stderr, "programs, drawings and traces are in {}\n", options.folder);
  }
  if (globals.json) {
    const nlohmann::ordered_json json{
        {"device", target->device.text}, {"machine", target->machine.name}, {"sheets", sheets}};
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  return cut;
}

/// The options of the plan that were given, as popcutd takes them: names without dashes.
std::map<std::string, std::string> plan_words(const CLI::App& command) {
  static const std::set<std::string> kOwn{"INPUT",  "test", "device",   "treat-as", "faults",
                                          "direct", "yes",  "output",   "copies",   "name",
                                          "wait",   "help", "priority", "material", "machine"};
  std::map<std::string, std::string> words;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    if (kOwn.contains(name)) continue;
    words[name] = option->get_expected_max() == 0
                      ? "true"
                      : fmt::format("{}", fmt::join(option->results(), ","));
  }
  return words;
}

constexpr const char* kHelp =
    "Cut a spec or a pattern: queued with popcutd, or with --direct from here.\n\n"
    "  popcut cut sphere.json --wait                       # a job; tells when a person is needed\n"
    "  popcut arm                                          # the sheet is loaded\n"
    "  popcut start                                        # the knife goes down\n\n"
    "  popcut cut --test --device usb:51053P               # first a small shape, in the same "
    "way\n\n"
    "  popcut cut sphere.json --direct                     # asks for each sheet, then cuts it\n"
    "  popcut cut sphere.json --direct --yes -o cut        # simulated: no questions\n"
    "  popcut cut sphere.json --direct --device usb:51053P # the cutter of that serial number\n\n"
    "--direct plans as 'popcut plan' does, then sends each sheet to the cutter and waits for it.\n"
    "Ctrl-C stops at the end of the stroke, with the tool up and parked; the key p holds there "
    "and\n"
    "goes on. With -o DIR it keeps for each sheet the program, its drawing, and what the "
    "simulated\n"
    "knife did (sheet-NN.cut.svg, .trace.json).\n"
    "Devices:\n\n"
    "  sim:NAME, usb:ID, lp:/dev/usb/lp0\n"
    "  serial:/dev/ttyUSB0[,baud=9600][,flow=none|rtscts|xonxoff]\n"
    "  file:NAME                          # writes the program, cuts nothing";

}  // namespace
}  // namespace cut_command

void register_cut(CLI::App& app, const Globals& globals, Run& run) {
  using namespace cut_command;
  auto options = std::make_shared<Options>();
  CLI::App* const command = app.add_subcommand("cut", kHelp);
  add_plan_options(*command, options->job);
  command->get_option("INPUT")->required(false);
  command->add_flag("--test", options->test,
                    "Cut a small shape to try the material: a square, a triangle, a fold");
  command->add_option("--device", options->device, "Where to cut; 'popcut devices' lists them")
      ->option_text("ID [sim:cameo3]");
  command
      ->add_option("--treat-as", options->treat_as,
                   "Drive a cutter whose model is not known as this machine")
      ->option_text("NAME");
  command
      ->add_option("--faults", options->faults,
                   "What goes wrong with a simulated device; docs/simulator.md has the form")
      ->option_text("FILE");
  command->add_flag("--direct", options->direct, "Without popcutd, from here");
  command->add_flag("--yes", options->yes, "Ask nothing; with simulated devices only");
  command->add_option("-o,--output", options->folder, "Keep programs, drawings and traces there")
      ->option_text("DIR");
  whole_number(command->add_option("--copies", options->copies,
                                   "How many of it popcutd is to cut, each on its own blanks"),
               1, 1000)
      ->option_text("N [1]");
  whole_number(
      command->add_option("--priority", options->priority, "Before (above 0) or after other jobs"),
      -10, 10)
      ->option_text("-10..10 [0]");
  command->add_option("--name", options->name, "What the job is called; else the input's name")
      ->option_text("TEXT");
  command->add_flag("--wait", options->wait,
                    "Tell each thing that waits for a person; return when the job has ended");
  command->callback([options, command, &globals, &run] {
    options->plan_words = plan_words(*command);
    run = [options, &globals] { return run_cut(*options, globals); };
  });
}

}  // namespace popcut::cli
