// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/utf8.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/cutter/simulate_pty.hpp"
#include "daemon/cli/input/expectation.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "device/sim/simulate.hpp"
#include "protocol/decode.hpp"

namespace popcut::cli {
namespace simulate_command {
namespace {

struct Options {
  std::string program, folder, machine, expect, plan, faults;
  bool pty{false};
  double speedup{1};
  std::size_t sheet{1};
};

Result<Machine> choose_machine(const Options& options, const std::optional<PlanFacts>& plan,
                               std::span<const std::byte> program, const UserTables& tables) {
  std::string name = options.machine;
  if (name.empty() && plan) name = plan->machine;
  if (name.empty()) name = guess_dialect(program) == Dialect::Hpgl ? "hpgl-generic" : "cameo3";
  auto machine = find_driven_machine(name, tables.texts);
  if (machine) return machine;
  if (options.machine.empty() && plan && name.rfind("ideal", 0) == 0) {
    const bool hpgl = guess_dialect(program) == Dialect::Hpgl;
    return hpgl ? find_machine("hpgl-generic") : ideal_plotter(plan->area_mm[0], plan->area_mm[1]);
  }
  return tl::unexpected(
      tables.with_file(machine.error(), options.machine.empty() ? "--plan" : "--machine"));
}

/// The sheet: as the plan or the expected drawing has it. A machine that counts the feed from
/// the end of the sheet needs its length; without it, the highest point drawn counts as its edge.
SimOptions sheet_of(const std::optional<PlanFacts>& plan,
                    const std::optional<Expectation>& expected, const Machine& machine,
                    std::span<const std::byte> program) {
  SimOptions sheet;
  std::optional<std::array<double, 2>> page;
  if (expected) page = expected->page_mm;
  if (!page && plan) page = plan->area_mm;
  if (page) {
    sheet.page_width_mm = (*page)[0];
    sheet.page_length_mm = (*page)[1];
  } else if (machine.feed_up()) {
    double highest = 1;
    if (const auto decoded = decode(Dialect::Hpgl, program))
      for (const MachinePoint& p : decoded->points)
        highest = std::max(highest, machine.axes == Axes::FeedCarriage ? p.a : p.b);
    sheet.page_length_mm = std::ceil(std::min(highest, 1e9) * machine.unit_mm);
  }
  return sheet;
}

void say(const Trace& trace, const Options& options) {
  fmt::print(stderr, "{} on {}\n", options.program, trace.machine);
  fmt::print(stderr, "  cut {:.1f} mm in {} strokes, travel {:.1f} mm, {:.0f} s\n", trace.cut_mm,
             trace.lifts, trace.travel_mm, trace.seconds);
  if (trace.clipped_mm > 0)
    fmt::print(stderr, "  warning  {:.1f} mm lie outside the cutter's area and were not cut\n",
               trace.clipped_mm);
  for (std::size_t i = 0; i < trace.unknown.size() && i < 3; ++i)
    fmt::print(stderr, "  warning  unknown command: {}\n", shown_text(trace.unknown[i]));
  if (trace.unknown_count > 3)
    fmt::print(stderr, "  warning  {} unknown commands in all; trace.json lists them\n",
               trace.unknown_count);
  for (std::size_t i = 0; i < trace.remarks.size() && i < 3; ++i)
    fmt::print(stderr, "  warning  {}\n", trace.remarks[i]);
  fmt::print(stderr, "  wrote    cut.svg trace.json in {}\n", options.folder);
}

Result<void> check(const Trace& trace, const Expectation& expectation, const std::string& file) {
  if (trace.unknown_count > 0)
    return fail(ErrorKind::CheckFailed, file,
                fmt::format("{} commands of the program are unknown, the first is \"{}\"; popcut "
                            "cannot say what a cutter does with them",
                            trace.unknown_count, trace.unknown.front()));
  const auto held = expect(trace, expectation.expected);
  if (!held) return tl::unexpected(within(file, held.error()));
  return {};
}

Result<void> run_simulate(const Options& options, const Globals& globals) {
  if (options.pty)
    return serve_pty({options.machine, options.folder, options.faults, options.speedup}, globals);
  if (options.program.empty())
    return fail(ErrorKind::Usage, "command line",
                "PROGRAM is missing; give a GPGL or HPGL program, or --pty");
  if (options.folder.empty())
    return fail(ErrorKind::Usage, "command line",
                "-o DIR is missing; give the folder for cut.svg and trace.json");
  constexpr std::uintmax_t kLimitBytes = 1u << 28;
  std::optional<LongWork> work(std::in_place, !globals.quiet, "simulating the cut");
  const auto text = read_file(options.program, kLimitBytes);
  if (!text) return tl::unexpected(text.error());
  if (const std::string foreign = foreign_program(std::as_bytes(std::span(*text)));
      !foreign.empty())
    return fail(ErrorKind::Malformed, options.program, foreign);
  const auto program = std::as_bytes(std::span(*text));
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  std::optional<PlanFacts> plan;
  if (!options.plan.empty()) {
    auto facts = read_plan_facts(options.plan, options.sheet);
    if (!facts) return tl::unexpected(facts.error());
    plan = std::move(*facts);
  }
  const auto machine = choose_machine(options, plan, program, *tables);
  if (!machine) return tl::unexpected(machine.error());
  std::optional<Expectation> expected;
  if (!options.expect.empty()) {
    auto read = read_expectation(options.expect, plan, *tables);
    if (!read) return tl::unexpected(read.error());
    expected = std::move(*read);
  }
  auto faults = read_faults(options.faults);
  if (!faults) return tl::unexpected(faults.error());
  const SimOptions sheet = sheet_of(plan, expected, *machine, program);
  const auto trace = faults->empty()
                         ? simulate(program, *machine, sheet)
                         : simulate_faults(program, *machine, sheet, std::move(*faults));
  if (!trace) return tl::unexpected(within(options.program, trace.error()));

  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  if (auto done = folder->add("cut.svg", trace_svg(*trace)); !done) return done;
  if (auto done = folder->add("trace.json", trace_json(*trace)); !done) return done;
  if (auto done = folder->commit("popcut simulate " POPCUT_VERSION); !done) return done;
  if (expected) work->now("comparing it with what was expected");
  const Result<void> held = expected ? check(*trace, *expected, options.expect) : Result<void>{};
  work.reset();
  if (globals.json) {
    auto json = trace_summary(*trace);
    if (expected) json["as_expected"] = held.has_value();
    print_json(json);
  }
  if (!globals.quiet) say(*trace, options);
  if (expected && held && !globals.quiet) fmt::print(stderr, "  matches {}\n", options.expect);
  return held;
}

constexpr const char* kHelp =
    "Run a cutter program on a simulated cutter, and compare what it cuts.\n\n"
    "  popcut simulate sheets/sheet-01.gpgl -o simulated --expect sheets/sheet-01.svg\n\n"
    "popcut writes cut.svg (what the knife did) and trace.json (strokes, settings, lengths in\n"
    "mm, seconds) into DIR. In cut.svg, each force has a colour, moves with the tool up are thin\n"
    "lines, and what lies outside the cutter's area is grey.\n\n"
    "--expect checks that each line is cut as often as planned, that folds are dashed, that\n"
    "nothing else is drawn, and that each point is at most half a machine step from its place in\n"
    "the plan (0.05 mm more if popcut turns the blade). Exit code 6 if a check fails.";

}  // namespace
}  // namespace simulate_command

void register_simulate(const Command& app, const Globals& globals, Run& run) {
  using namespace simulate_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("simulate", kHelp);
  const auto text = [&](const char* name, std::string& value, const char* help, const char* shown) {
    command.add_option(name, value, help).value_text(shown);
  };
  command.add_option("PROGRAM", options->program,
                     "A GPGL or HPGL program; leave it out with --pty");
  text("--faults", options->faults,
       "Faults of the simulated cutter; docs/simulator.md describes the file", "FILE");
  command.add_flag("--pty", options->pty,
                   "Act as a cutter on a pseudo terminal for other programs, until Ctrl-C");
  real_number(command.add_option("--speedup", options->speedup,
                                 "With --pty: run N times as fast as the real cutter"),
              1e-3, 1e6)
      .value_text("N [1]");
  text("-o,--output", options->folder, "Folder for the files; created if it does not exist", "DIR");
  text("--machine", options->machine, "The cutter; 'popcut machines' lists them",
       "NAME [the plan's, else cameo3 or hpgl-generic]");
  text("--expect", options->expect,
       "What should be cut: a sheet-NN.svg, or a pattern (.fold, .svg, .json) with --plan", "FILE");
  text("--plan", options->plan, "The plan.json that places the pattern on the sheet", "FILE");
  whole_number(command.add_option("--sheet", options->sheet, "Sheet of the plan, from 1"), 1,
               10'000)
      .value_text("N [1]");
  when_chosen(command, run, [options, &globals] { return run_simulate(*options, globals); });
}

}  // namespace popcut::cli
