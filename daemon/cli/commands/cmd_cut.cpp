// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/formats/svg/svg_reader.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/plan_options.hpp"
#include "core/text/utf8.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/cutter/cut_device.hpp"
#include "daemon/cli/cutter/cut_queue.hpp"
#include "daemon/cli/cutter/cut_session.hpp"
#include "daemon/cli/input/expectation.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/options/plan_arguments.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "device/compare/expect.hpp"
#include "device/session/session.hpp"

namespace popcut::cli {
namespace cut_command {
namespace {

struct Options {
  PlanArguments plan;
  std::string device, treat_as, folder, faults;
  bool direct{false}, yes{false}, test{false}, frame{false};
  int copies{1}, priority{0};
  std::string name, site;
  bool wait{false};
};

// 1. May it be cut?

/// Moves the tool, up, round what is going to be cut.
Result<void> go_round(const PlanJob& job, std::size_t sheet, const CutTarget& target,
                      const Globals& globals) {
  const PlannedSheet& planned = job.plan.sheets[sheet];
  JobOptions options = on_mat(planned.mat);
  options.page_width_mm = planned.area_mm[0];
  options.page_length_mm = planned.area_mm[1];
  if (planned.mat.code == 0) options.mat_code.reset();
  Box box;
  for (const PagePoint& p : planned.sent_path().points) box.add(p);
  const auto program = frame_of(box, target.machine, job.plan.material, options);
  if (!program) return tl::unexpected(program.error());
  const auto sent =
      send_program(target, target.machine,
                   {*program, "", {planned.area_mm[0], planned.area_mm[1]}, 10}, !globals.quiet);
  if (!sent) return tl::unexpected(sent.error());
  if (sent->end.error) return tl::unexpected(within("--frame", *sent->end.error));
  if (sent->end.cancelled || sent->stop_asked)
    return fail(ErrorKind::Refused, "--frame", "stopped as you asked; nothing was cut");
  if (sent->trace && !sent->trace->strokes.empty())
    return fail(ErrorKind::Internal, "--frame", "the tool came down");
  if (!globals.quiet)
    fmt::print(stderr,
               "sheet {}: the lifted tool went around {:.1f} x {:.1f} mm at {:.1f}, {:.1f}\n",
               sheet + 1, box.width(), box.height(), box.x0, box.y0);
  return {};
}

/// How far right and into the sheet the drawing should go, in mm, before it is cut.
struct Shift {
  double across_mm{}, along_mm{};
};

std::optional<PagePoint> place_in(const std::string& text) {
  const auto options = read_plan_options({{"at", text}});
  return options ? options->place.at : std::nullopt;
}

/// A person says yes to each sheet, or --yes stands for it. After the tool went round the only
/// sheet, the answer may also be how far to move the drawing.
Result<std::optional<Shift>> ask(const Options& options, const PlanJob& job, std::size_t sheet,
                                 const CutTarget& target) {
  if (options.yes || target.device.kind == DeviceKind::File) return std::nullopt;
  if (isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1)
    return fail(ErrorKind::Refused, "",
                "cannot ask whether to start, because this is not a terminal; with a simulated "
                "device add --yes");
  const PlannedSheet& planned = job.plan.sheets[sheet];
  const bool can_move = options.frame && job.plan.sheets.size() == 1;
  const std::string mat =
      planned.mat.name.empty() ? "" : fmt::format(" on the {} mat", planned.mat.name);
  fmt::print(
      stderr,
      "Load sheet {} of {} ({}, {:.5g} mm across x {:.5g} mm, drawn side up){} into {}, about "
      "{:.0f} min. Start cutting? [y/N{}] ",
      sheet + 1, job.plan.sheets.size(), job.plan.material.title, planned.area_mm[0],
      planned.area_mm[1], mat,
      target.simulated() ? target.device.text : target.machine.title + " at " + target.device.text,
      std::ceil(planned.seconds / 60),
      can_move ? ", or X,Y: move it X mm to the right and Y mm further in, such as 5,-2" : "");
  std::string answer;
  std::getline(std::cin, answer);
  if (answer == "y" || answer == "Y" || answer == "yes") return std::nullopt;
  if (can_move)
    if (const auto by = place_in(answer)) return Shift{by->x, by->y};
  return fail(ErrorKind::Refused, "",
              fmt::format("sheet {} was not started; {}", sheet + 1,
                          sheet == 0 ? "nothing was cut" : "the sheets before it are cut"));
}

// 2. One sheet.

struct CutSheet {
  SessionEnd end;
  std::optional<Trace> trace;  ///< of a simulated cutter
  std::uint64_t certain{}, in_doubt{}, not_sent{};
  bool stop_asked{};  ///< perhaps so late that the whole sheet is cut
};

Result<CutSheet> cut_sheet(const PlanJob& job, std::size_t sheet, const CutTarget& target,
                           const Globals& globals) {
  const PlannedSheet& planned = job.plan.sheets[sheet];
  auto sent = send_program(target, target.machine,
                           {job.programs[sheet],
                            sheet_path(target, sheet, job.plan.sheets.size()),
                            {planned.area_mm[0], planned.area_mm[1]},
                            planned.seconds},
                           !globals.quiet);
  if (!sent) return tl::unexpected(sent.error());
  CutSheet cut;
  cut.end = std::move(sent->end);
  cut.trace = std::move(sent->trace);
  cut.stop_asked = sent->stop_asked;
  for (const StrokeFate fate : cut.end.fates)
    ++(fate == StrokeFate::Certain   ? cut.certain
       : fate == StrokeFate::InDoubt ? cut.in_doubt
                                     : cut.not_sent);
  cut.not_sent -= job.programs[sheet].dots.size();
  return cut;
}

/// The error if the sheet is not completely cut. For a simulated cutter, compares what it drew.
Result<void> judge(const PlanJob& job, std::size_t sheet, const CutSheet& cut) {
  const std::string place = fmt::format("sheet {}", sheet + 1);
  const std::string ledger = fmt::format("{} strokes are cut, {} are in doubt, {} were not sent",
                                         cut.certain, cut.in_doubt, cut.not_sent);
  if (cut.end.error) {
    Error error = within(place, *cut.end.error);
    error.detail += "; " + ledger;
    if (cut.end.likely_stroke)
      error.detail +=
          fmt::format("; the knife was most likely in stroke {}", *cut.end.likely_stroke + 1);
    return tl::unexpected(error);
  }
  if (cut.end.cancelled)
    return fail(ErrorKind::Refused, place,
                "stopped as you asked, with the tool up and parked; " + ledger);
  if (!cut.trace) return {};
  Expected expected;
  auto drawing = linework_from_svg(sheet_svg(job.plan.sheets[sheet], ""), SvgProfile::Popcut);
  if (!drawing) return tl::unexpected(within(place, drawing.error()));
  expected.drawing = std::move(*drawing);
  expected.drawing.dashed = true;  // as it is drawn, whole folds too
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
  if (cut.end.likely_stroke) json["likely_stroke"] = *cut.end.likely_stroke + 1;
  if (cut.trace) json["cut_mm"] = cut.trace->cut_mm;
  if (!judged) json["error"] = message(judged.error());
  return json;
}

void say(const PlanJob& job, std::size_t sheet, const CutSheet& cut, const CutTarget& target) {
  const std::size_t sheets = job.plan.sheets.size();
  if (target.device.kind == DeviceKind::File) {
    fmt::print(stderr, "sheet {} of {}: the program is in {}; nothing was cut\n", sheet + 1, sheets,
               sheet_path(target, sheet, sheets));
    return;
  }
  if (cut.trace)
    fmt::print(stderr, "sheet {} of {}: {} strokes, {:.0f} mm cut on {} in {:.0f} s (simulated)\n",
               sheet + 1, sheets, cut.trace->lifts, cut.trace->cut_mm, target.device.text,
               cut.end.seconds);
  else
    fmt::print(stderr,
               "sheet {} of {}: {} strokes cut, {} in doubt, {} not sent, on {} in {:.0f} s\n",
               sheet + 1, sheets, cut.certain, cut.in_doubt, cut.not_sent, target.device.text,
               cut.end.seconds);
  if (!cut.end.confirmed && !cut.end.error)
    fmt::print(stderr,
               "  this machine reports nothing back: {} strokes count as cut, {} are in doubt; "
               "look at the sheet\n",
               cut.certain, cut.in_doubt);
}

// 3. The work.

/// Cuts each sheet to which a person says yes; or says how far to move the drawing first.
Result<std::optional<Shift>> cut_all(const Options& options, const Globals& globals,
                                     const PlanJob& job, const CutTarget& target,
                                     std::optional<OutputFolder>& folder,
                                     nlohmann::ordered_json& sheets) {
  for (std::size_t sheet = 0; sheet < job.plan.sheets.size(); ++sheet) {
    if (options.frame) {
      if (!options.yes && isatty(STDIN_FILENO) == 1) {
        fmt::print(stderr, "Load sheet {}, then press Enter: the lifted tool goes around it. ",
                   sheet + 1);
        std::string enter;
        std::getline(std::cin, enter);
      }
      if (auto round = go_round(job, sheet, target, globals); !round)
        return tl::unexpected(round.error());
    }
    if (auto asked = ask(options, job, sheet, target); !asked || *asked) return asked;
    const auto cut = cut_sheet(job, sheet, target, globals);
    if (!cut) return tl::unexpected(cut.error());
    const Result<void> judged = judge(job, sheet, *cut);
    sheets.push_back(sheet_json(*cut, sheet, judged));
    if (folder)
      if (auto kept = keep(*folder, job, sheet, *cut); !kept) return tl::unexpected(kept.error());
    if (!globals.quiet) say(job, sheet, *cut, target);
    std::fflush(stderr);  // the next sheet may take long
    if (!judged) return tl::unexpected(judged.error());
    if (cut->stop_asked && sheet + 1 < job.plan.sheets.size())
      return fail(ErrorKind::Refused, fmt::format("sheet {}", sheet + 1),
                  fmt::format("is cut; stopped as you asked before sheet {}", sheet + 2));
  }
  return std::nullopt;
}

/// Plans again with the drawing moved, until a person wants it where it is. A place where it does
/// not fit is said, and the drawing stays.
Result<void> cut_where_it_fits(const Options& options, const Globals& globals,
                               PlanArguments& wanted, PlanJob& job, const CutTarget& target,
                               std::optional<OutputFolder>& folder,
                               nlohmann::ordered_json& sheets) {
  for (;;) {
    const auto cut = cut_all(options, globals, job, target, folder, sheets);
    if (!cut) return tl::unexpected(cut.error());
    if (!*cut) return {};
    const auto at = wanted.options.find("at");
    const PagePoint from =
        (at == wanted.options.end() ? std::nullopt : place_in(at->second)).value_or(PagePoint{});
    PlanArguments moved = wanted;
    moved.options["at"] =
        fmt::format("{},{}", from.x + (*cut)->across_mm, from.y + (*cut)->along_mm);
    auto again = plan_input(moved, !globals.quiet);
    if (!again) {
      fmt::print(stderr, "{}; it stays at {:g},{:g}\n", message(again.error()), from.x, from.y);
      continue;
    }
    wanted = std::move(moved);
    job = std::move(*again);
  }
}

/// Options that do not go together.
Result<void> check_words(const Options& options) {
  const auto wrong = [](const char* option, const char* why) {
    return fail(ErrorKind::Usage, option, why);
  };
  if (options.direct &&
      (options.wait || options.copies != 1 || options.priority != 0 || !options.site.empty()))
    return wrong("--direct",
                 "cuts at once, without popcutd; --wait, --copies, --priority and --site are for "
                 "popcutd's queue");
  if (options.direct) return {};
  if (options.test &&
      (options.copies != 1 || options.priority != 0 || !options.plan.options.empty() ||
       !options.name.empty() || !options.site.empty()))
    return wrong("--test",
                 "accepts only --device, --material and --wait, because popcutd plans the shape; "
                 "add --direct for other options");
  if (options.yes)
    return wrong("--yes",
                 "works only with --direct; a job waits for 'popcut arm' and 'popcut start'");
  if (options.frame)
    return wrong("--frame",
                 "works only with --direct; popcutd moves no tool before 'popcut start'");
  if (!options.faults.empty())
    return wrong("--faults",
                 "works only with --direct; for popcutd, set faults in its configuration");
  if (!options.folder.empty())
    return wrong("--output",
                 "works only with --direct; popcutd keeps the plan's files, see 'popcut jobs "
                 "JOB'");
  if (!options.plan.machine.empty() || !options.treat_as.empty())
    return wrong(options.treat_as.empty() ? "--machine" : "--treat-as",
                 "works only with --direct; for popcutd, choose a --device");
  return {};
}

Result<void> run_cut(const Options& options, const Globals& globals) {
  if (options.test != options.plan.input.empty())
    return fail(ErrorKind::Usage, "command line",
                options.test ? "INPUT and --test contradict each other; --test cuts its own shape"
                             : "INPUT is missing; give a design or a drawing, or --test");
  if (const auto valid = check_words(options); !valid) return valid;
  if (!options.direct) {
    const QueueRequest request{options.plan.input, options.device,       options.plan.material,
                               options.name,       options.plan.options, options.copies,
                               options.priority,   options.wait,         options.site};
    return options.test ? queue_test_cut(request, globals) : queue_cut(request, globals);
  }
  const bool simulated = options.device.empty() || options.device.rfind("sim:", 0) == 0;
  if (options.yes && !simulated)
    return fail(
        ErrorKind::Usage, "--yes",
        fmt::format("works only with simulated devices, and {} is real; leave --yes out, so "
                    "that you are asked before each sheet",
                    options.device));
  auto target = choose_target({options.device, options.plan.machine, options.treat_as});
  if (!target) return tl::unexpected(target.error());
  if (options.frame && target->device.kind == DeviceKind::File)
    return fail(ErrorKind::Usage, "--frame", "moves a cutter's tool, and --device is a file");
  if (options.frame && target->real() && (isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1))
    return fail(ErrorKind::Refused, "--frame",
                "moves the tool while you watch; run it in a terminal");
  if (!options.faults.empty()) {
    if (!target->simulated())
      return fail(ErrorKind::Usage, "--faults",
                  fmt::format("works only with simulated devices, and {} is real; leave it out",
                              target->device.text));
    auto faults = read_faults(options.faults);
    if (!faults) return tl::unexpected(faults.error());
    target->faults = std::move(*faults);
  }
  PlanArguments wanted = options.plan;
  wanted.machine = target->machine.name;
  wanted.test_shape = options.test;
  auto job = plan_input(wanted, !globals.quiet);
  if (!job) return tl::unexpected(job.error());
  std::optional<OutputFolder> folder;
  if (!options.folder.empty()) {
    auto opened = OutputFolder::open(options.folder);
    if (!opened) return tl::unexpected(opened.error());
    folder = std::move(*opened);
  }
  if (!globals.quiet)
    for (const Warning& warning : job->plan.warnings)
      fmt::print(stderr, "warning: {}\n", shown_text(warning.message));
  nlohmann::ordered_json sheets = nlohmann::ordered_json::array();
  // What happened is kept, whatever happened.
  const Result<void> cut =
      cut_where_it_fits(options, globals, wanted, *job, *target, folder, sheets);
  if (folder) {
    if (auto done = folder->add("plan.json", plan_json(job->plan)); !done) return done;
    if (auto done = folder->commit("popcut cut " POPCUT_VERSION); !done) return done;
    if (!globals.quiet)
      fmt::print(stderr, "wrote programs, drawings and traces to {}\n", options.folder);
  }
  if (globals.json) {
    const nlohmann::ordered_json json{
        {"device", target->device.text}, {"machine", target->machine.name}, {"sheets", sheets}};
    print_json(json);
  }
  return cut;
}

constexpr const char* kHelp =
    "Cut a design or a drawing: as a job of the service popcutd, or at once with --direct.\n\n"
    "  popcut cut sphere.json --wait                       # queue a job; prints what to do next\n"
    "  popcut arm                                          # the sheet is loaded, it may be cut\n"
    "  popcut start                                        # cut it now\n\n"
    "  popcut cut --test --device usb:51053P               # first a small shape on scrap\n\n"
    "  popcut cut sphere.json --direct                     # without popcutd; asks before each "
    "sheet\n"
    "  popcut cut sphere.json --direct --yes -o cut        # simulated, without questions\n"
    "  popcut cut sphere.json --direct --device usb:51053P # on the cutter with this serial "
    "number\n\n"
    "--direct plans like 'popcut plan', then sends each sheet to the cutter. Ctrl-C stops at the\n"
    "end of the current stroke, with the tool up and parked. The key p pauses the cut; press it\n"
    "again to continue. With -o DIR, popcut keeps for each sheet the program, its drawing, and "
    "what\n"
    "a simulated knife did (sheet-NN.cut.svg, sheet-NN.trace.json).\n\n"
    "Devices:\n\n"
    "  sim:NAME, usb:ID, lp:/dev/usb/lp0\n"
    "  serial:/dev/ttyUSB0[,baud=9600][,flow=none|rtscts|xonxoff]\n"
    "  file:NAME                          # writes the program to a file, cuts nothing";

}  // namespace
}  // namespace cut_command

void register_cut(const Command& app, const Globals& globals, Run& run) {
  using namespace cut_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("cut", kHelp);
  add_plan_arguments(command, options->plan);
  command.option("INPUT").required(false);
  command.add_flag("--test", options->test,
                   "Cut a small shape to try the material: a square, a triangle and a fold");
  command.add_option("--device", options->device, "Where to cut; 'popcut devices' lists them")
      .value_text("ID [sim:cameo3]");
  command
      .add_option("--treat-as", options->treat_as,
                  "Drive an unknown cutter as if it were this machine, such as cameo4")
      .value_text("NAME");
  command
      .add_option("--faults", options->faults,
                  "Faults of a simulated device; docs/simulator.md describes the file")
      .value_text("FILE");
  command.add_flag("--direct", options->direct, "Cut at once, without popcutd");
  command.add_flag("--frame", options->frame,
                   "With --direct: first move the lifted tool around the area to cut on each "
                   "sheet; then you can still move the drawing");
  command.add_flag("--yes", options->yes,
                   "Do not ask before each sheet; only with simulated devices");
  command.add_option("-o,--output", options->folder, "Folder for programs, drawings and traces")
      .value_text("DIR");
  whole_number(command.add_option("--copies", options->copies,
                                  "How many copies popcutd cuts, each on new sheets"),
               1, 1000)
      .value_text("N [1]");
  whole_number(command.add_option("--priority", options->priority,
                                  "Priority in popcutd's queue; higher goes first"),
               -10, 10)
      .value_text("-10..10 [0]");
  command
      .add_option("--site", options->site,
                  "Let only popcutd's cutters of this site cut it; 'popcut devices' shows sites")
      .value_text("TEXT");
  command.add_option("--name", options->name, "Name of the job; default: the name of the input")
      .value_text("TEXT");
  command.add_flag("--wait", options->wait,
                   "Wait until the job ends, and print each thing you have to do");
  when_chosen(command, run, [options, &globals] { return run_cut(*options, globals); });
}

}  // namespace popcut::cli
