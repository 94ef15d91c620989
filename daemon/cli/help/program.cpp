// SPDX-License-Identifier: MIT
#include "daemon/cli/help/program.hpp"

#include <unistd.h>

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "daemon/cli/help/terminal_text.hpp"
#include "daemon/cli/help/usage_error.hpp"

namespace popcut::cli {
namespace {

/// Lists the commands, one line each, and wraps the text of options to the terminal.
class ShortHelp : public CLI::Formatter {
  [[nodiscard]] std::string make_usage(const CLI::App* app, std::string name) const override {
    return "\n" + CLI::Formatter::make_usage(app, name);
  }
  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override {
    constexpr std::size_t kMost = 100, kLeast = 60;
    const std::size_t width = std::clamp(terminal_columns(STDOUT_FILENO, kMost), kLeast, kMost);
    std::string what = option->get_description(), text;
    std::replace(what.begin(), what.end(), '\n', ' ');
    for (const std::string& line : wrapped(what, width - get_column_width(), 0))
      text += (text.empty() ? "" : "\n") + line;
    return text;
  }
  [[nodiscard]] std::string make_subcommand(const CLI::App* command) const override {
    const std::string what = command->get_description();
    const std::string line = "  " + command->get_name();
    return line + std::string(line.size() < 14 ? 14 - line.size() : 1, ' ') +
           what.substr(0, what.find('\n')) + "\n";
  }
};

void refuse_empty(CLI::App& command, const std::string& but) {
  const auto fault_of = [](const std::string& text) {
    return text.empty() ? std::string("is empty; give a value or leave it out") : std::string();
  };
  for (CLI::Option* option : command.get_options({}))
    if (option->get_expected_min() > 0 && option->get_items_expected_max() > 0)
      Option(option).checked(fault_of);
  for (CLI::App* below : command.get_subcommands({}))
    if (below->get_name() != but) refuse_empty(*below, but);
}

}  // namespace

Program::Program(const std::string& name, const std::string& purpose, const std::string& footer,
                 const std::string& version)
    : app_(std::make_unique<CLI::App>(purpose, name)) {
  app_->set_version_flag("--version", version);
  app_->footer(footer);
}

Program::~Program() = default;

void Program::has_commands() {
  app_->formatter(std::make_shared<ShortHelp>());
  app_->fallthrough();
  app_->require_subcommand(0,
                           1);  // that none is named is refused later, after words that are wrong
}

void Program::refuse_empty_values(const std::string& but) { refuse_empty(*app_, but); }

Result<std::optional<std::string>> Program::read(int argc, const char* const* argv) {
  try {
    app_->parse(argc, const_cast<char**>(argv));
  } catch (const CLI::ParseError& refused) {
    const bool is_wrong = refused.get_exit_code() != 0;
    if (is_wrong && app_->get_subcommands({}).empty())
      return fail(ErrorKind::Usage, "command line",
                  fmt::format("{}; see '{} --help'", refused.what(), app_->get_name()));
    if (is_wrong) return tl::unexpected(usage_error(*app_, refused));
    if (refused.get_name() == "CallForHelp")
      if (const auto no_help = help_error(*app_)) return tl::unexpected(*no_help);
    std::ostringstream shown;
    app_->exit(refused, shown, shown);
    return shown.str();
  }
  return std::nullopt;
}

Error Program::no_command() const { return usage_error(*app_, CLI::RequiredError("a command")); }

}  // namespace popcut::cli
