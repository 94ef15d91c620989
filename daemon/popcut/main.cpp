// SPDX-License-Identifier: MIT
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

#include "core/text/shown_text.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/help/help_pages.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/help/terminal_text.hpp"
#include "daemon/cli/help/usage_error.hpp"

namespace popcut::cli {
namespace {

// Every subcommand of this build; the order is the order of the help.
constexpr std::initializer_list<Register> kCommands = {
    register_design, register_deploy,    register_verify,      register_plan,   register_simulate,
    register_cut,    register_jobs,      register_job_actions, register_daemon, register_machines,
    register_doctor, register_curvature, register_figures};

constexpr const char* kPurpose =
    "popcut turns a target surface into a pop-up pattern, a cut sheet, and a finished cut.\n\n"
    "  popcut design sphere.json -o sphere         # pattern, drawings and report in ./sphere\n"
    "  popcut deploy sphere/pattern.fold -o poses  # meshes of the poses as it opens\n"
    "  popcut verify sphere/pattern.fold           # is it sound? one freedom? no crossing?\n"
    "  popcut plan sphere.json -o sheets           # the sheets and the programs that cut them\n"
    "  popcut cut sphere.json --wait               # cut it: a job for popcutd, with you at each "
    "sheet\n"
    "  popcut cut sphere.json --direct             # cut it from here, simulated by default\n\n"
    "'popcut COMMAND --help' explains a command. Lengths are in mm, angles in rad unless the name\n"
    "of an option or field says otherwise.";
constexpr const char* kFooter =
    "Every command takes --json, -q and -v, before or after its name.\n"
    "Exit codes: 0 done; 1 a fault in popcut; 2 wrong command line; 3 malformed input or a value\n"
    "out of range; 4 no valid pattern or layout; 5 device absent, refused or failed; 6 a check "
    "did\n"
    "not hold; 7 output not written.";

/// The commands one line each; each explains itself. What options mean keeps to the terminal.
class ShortHelp : public CLI::Formatter {
  std::string make_usage(const CLI::App* app, std::string name) const override {
    return "\n" + CLI::Formatter::make_usage(app, name);
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    constexpr std::size_t kMost = 100, kLeast = 60;
    const std::size_t width = std::clamp(terminal_columns(STDOUT_FILENO, kMost), kLeast, kMost);
    std::string what = option->get_description(), text;
    std::replace(what.begin(), what.end(), '\n', ' ');
    for (const std::string& line : wrapped(what, width - get_column_width(), 0))
      text += (text.empty() ? "" : "\n") + line;
    return text;
  }
  std::string make_subcommand(const CLI::App* command) const override {
    const std::string what = command->get_description();
    const std::string line = "  " + command->get_name();
    return line + std::string(line.size() < 14 ? 14 - line.size() : 1, ' ') +
           what.substr(0, what.find('\n')) + "\n";
  }
};

int report(const Error& error) {
  std::cout.flush();
  std::fprintf(stderr, "popcut: %s\n", shown_text(message(error)).c_str());
  return exit_code(error.kind);
}

/// 'popcut help-page bash|zsh|fish|man', for the build and for packages.
void add_help_pages(CLI::App& app, Run& run) {
  auto kind = std::make_shared<std::string>();
  CLI::App* const command = app.add_subcommand("help-page", "Completions, and the manual page");
  command->group("");  // hidden
  command->add_option("KIND", *kind, "bash, zsh, fish or man")->required();
  command->callback([&app, &run, kind] {
    run = [&app, kind]() -> Result<void> {
      const auto page = help_page(app, *kind, 1);
      if (!page) return tl::unexpected(page.error());
      std::cout << *page;
      return {};
    };
  });
}

int unwritable() {
  return report({ErrorKind::Unwritable, "standard output",
                 "cannot be written; free some space or send it elsewhere"});
}

/// Nothing that went to standard output may be lost in silence (a full disk behind a `>`).
int finish() {
  std::cout.flush();
  return std::cout && std::fflush(stdout) == 0 ? 0 : unwritable();
}

int run(int argc, char** argv) {
  CLI::App app{kPurpose, "popcut"};
  Globals globals;
  Run work;
  app.formatter(std::make_shared<ShortHelp>());
  app.fallthrough();             // the options below may stand after the subcommand too
  app.require_subcommand(0, 1);  // none is refused below, after words that are no option
  app.set_version_flag("--version", "popcut " POPCUT_VERSION);
  app.add_flag("--json", globals.json, "Standard output is one JSON document");
  app.add_flag("-q,--quiet", globals.quiet, "Say nothing but errors");
  app.add_flag("-v,--verbose", globals.verbose, "Say more; twice for everything");
  app.footer(kFooter);
  for (const Register add : kCommands) add(app, globals, work);
  add_help_pages(app, work);
  refuse_empty(app, "change");  // there an empty text takes away what was said before
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& refused) {
    if (refused.get_exit_code() != 0) return report(usage_error(app, refused));
    app.exit(refused);  // --help, --version
    return finish();
  }
  if (!work) return report(usage_error(app, CLI::RequiredError("a command")));
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
  // Talk that nobody can read (a closed or full standard error) is no fault of the work.
  if (isatty(STDERR_FILENO) == 0) (void)std::setvbuf(stderr, nullptr, _IOFBF, 1u << 16);
  std::signal(SIGXFSZ, SIG_IGN);  // a write past the file size limit fails like a full disk
  try {
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
