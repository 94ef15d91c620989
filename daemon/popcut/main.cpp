// SPDX-License-Identifier: MIT
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>

#include "core/text/utf8.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/help/help_pages.hpp"
#include "daemon/cli/help/program.hpp"
#include "daemon/planning/worker/worker.hpp"

namespace popcut::cli {
namespace {

// Every subcommand of this build; the order is the order of the help.
constexpr std::initializer_list<Register> kCommands = {
    register_design,      register_deploy, register_verify, register_compare,
    register_auto,        register_plan,   register_print,  register_fold_guide,
    register_simulate,    register_cut,    register_send,   register_jobs,
    register_job_actions, register_open,   register_daemon, register_machines,
    register_calibrate,   register_doctor, register_fleet,  register_curvature,
#ifdef POPCUT_FIGURES
    register_figures
#endif
};

constexpr const char* kPurpose =
    "popcut turns a shape into a pop-up card: it designs the pattern, plans the sheets and cuts "
    "them.\n\n"
    "  popcut design --example sphere > sphere.json  # a design to start from\n"
    "  popcut design sphere.json -o sphere           # pattern, drawings and report in ./sphere\n"
    "  popcut auto model.obj -o cards                # the best cards for a 3D model\n"
    "  popcut verify sphere/pattern.fold             # check that the card opens and closes\n"
    "  popcut deploy sphere/pattern.fold -o poses    # 3D models of the card as it opens\n"
    "  popcut plan sphere.json -o sheets             # sheets, and programs for your cutter\n"
    "  popcut cut sphere.json --direct               # cut now (simulated unless you add "
    "--device)\n"
    "  popcut cut sphere.json --wait                 # cut as a job of the service popcutd\n\n"
    "'popcut COMMAND --help' explains a command; docs/words.md explains the terms. Lengths are in\n"
    "mm and angles in radians unless the name of an option says otherwise.";
constexpr const char* kFooter =
    "Every command accepts --json, -q and -v, before or after its name.\n"
    "Exit codes: 0 done; 1 a bug in popcut; 2 wrong command line; 3 unreadable input or a value\n"
    "out of range; 4 no valid pattern or layout; 5 device or service absent, refused or failed;\n"
    "6 a check failed; 7 the output could not be written.";

int report(const Error& error) {
  std::cout.flush();
  std::fprintf(stderr, "popcut: %s\n", shown_text(message(error)).c_str());
  return exit_code(error.kind);
}

/// 'popcut help-page bash|zsh|fish|man', for the build and for packages.
void add_help_pages(const Command& app, Run& run) {
  auto kind = std::make_shared<std::string>();
  const Command command =
      app.add_command("help-page", "Print shell completions or the manual page");
  command.hide();
  command.add_option("KIND", *kind, "bash, zsh, fish or man").required();
  when_chosen(command, run, [app, kind]() -> Result<void> {
    const auto page = help_page(app, *kind, 1);
    if (!page) return tl::unexpected(page.error());
    std::cout << *page;
    return {};
  });
}

int unwritable() {
  return report({ErrorKind::Unwritable, "standard output",
                 "cannot be written; free some space or redirect it elsewhere"});
}

/// Nothing that went to standard output may be lost in silence (a full disk behind a `>`).
int finish() {
  std::cout.flush();
  return std::cout && std::fflush(stdout) == 0 ? 0 : unwritable();
}

int run(int argc, char** argv) {
  Program program("popcut", kPurpose, kFooter, "popcut " POPCUT_VERSION);
  program.has_commands();
  const Command app = program.command();
  Globals globals;
  Run work;
  app.add_flag("--json", globals.json, "Print one JSON document on standard output");
  app.add_flag("-q,--quiet", globals.quiet, "Print nothing but errors");
  app.add_flag("-v,--verbose", globals.verbose, "Print more; give it twice for everything");
  for (const Register add : kCommands) add(app, globals, work);
  add_help_pages(app, work);
  program.refuse_empty_values("change");  // there an empty text takes away what was said before
  const auto shown = program.read(argc, argv);
  if (!shown) return report(shown.error());
  if (*shown) {
    std::cout << **shown;
    return finish();
  }
  if (!work) return report(program.no_command());
  if (const auto done = work(); !done) return report(done.error());
  return finish();
}

}  // namespace
}  // namespace popcut::cli

int main(int argc, char** argv) {
#ifdef M_MMAP_THRESHOLD
  // Large arrays go back at once; else the heap of a large drawing keeps holes where they were.
  mallopt(M_MMAP_THRESHOLD, 256 * 1024);
#endif
  // A closed or full standard error must not fail the work.
  if (isatty(STDERR_FILENO) == 0) (void)std::setvbuf(stderr, nullptr, _IOFBF, 1u << 16);
  std::signal(SIGXFSZ, SIG_IGN);  // a write past the file size limit fails like a full disk
  try {
    // What is done in a process that may do nothing else, such as reading a PDF.
    if (argc >= 2 && argc <= 3 && std::strcmp(argv[1], "--worker") == 0)
      return popcut::planning::run_worker(0, 1, argc == 3 ? argv[2] : "");
    return popcut::cli::run(argc, argv);
  } catch (const std::system_error& fault) {
    if (std::ferror(stdout) != 0) return popcut::cli::unwritable();
    std::fprintf(stderr, "popcut: internal fault: %s\n", fault.what());
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "popcut: internal fault: %s\n", fault.what());
  } catch (...) {
    std::fputs("popcut: internal fault: unknown exception\n", stderr);
  }
  return 1;
}
