// SPDX-License-Identifier: MIT
#include "daemon/cli/help/usage_error.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/text/near_names.hpp"

namespace popcut::cli {
namespace {

/// The subcommand that was named last, or the program.
const CLI::App& chosen_of(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : chosen_of(*chosen.front());
}

std::string path_of(const CLI::App& command) {
  const std::string above = command.get_parent() == nullptr ? "" : path_of(*command.get_parent());
  return (above.empty() ? "" : above + " ") + command.get_name();
}

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({}))
    if (!command->get_group().empty()) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  if (app.get_parent() != nullptr)
    for (std::string& name : options_of(*app.get_parent())) names.push_back(std::move(name));
  return names;
}

bool is_option(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

Error no_command(const std::string& word, const std::vector<std::string>& commands) {
  return {ErrorKind::Usage, "command line",
          "'" + word + "' is not a command; " + suggestion(word, commands)};
}

/// Of a word that is no option, no command and no argument.
Error unknown_word(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App& command = chosen_of(app);
  const std::string help = "; see '" + path_of(command) + " --help'";
  const auto option = std::find_if(words.begin(), words.end(), is_option);
  if (option == words.end() && !commands_of(command).empty())
    return no_command(words.front(), commands_of(command));
  if (option == words.end())
    return {ErrorKind::Usage, "command line",
            "'" + words.back() + "' is one argument too many" + help};
  const std::string near = suggestion(option->substr(0, option->find('=')), options_of(command));
  const bool is_near = near.rfind("did you mean", 0) == 0;
  return {ErrorKind::Usage, "command line",
          "'" + *option + "' is not an option; " + (is_near ? near : help.substr(2))};
}

/// "--copies: is "0"; give a whole number from 1 to 1000", and what CLI11 says in words of its own.
Error wrong_value(const CLI::App& app, const std::string& what) {
  constexpr std::string_view kConvert = "Could not convert: ";
  if (what.rfind(kConvert, 0) == 0) {
    const std::size_t is = what.find(" = ", kConvert.size());
    if (is != std::string::npos)
      return {ErrorKind::Usage, what.substr(kConvert.size(), is - kConvert.size()),
              "is \"" + what.substr(is + 3) + "\"; give a number"};
  }
  const std::string help = "; see '" + path_of(chosen_of(app)) + " --help'";
  const std::size_t colon = what.find(": ");
  if (colon != std::string::npos &&
      what.ends_with(" missing"))  // "--output: 1 required TEXT missing"
    return {ErrorKind::Usage, what.substr(0, colon), "needs a value" + help};
  if (colon != std::string::npos && what.find(' ') == colon + 1)
    return {ErrorKind::Usage, what.substr(0, colon), what.substr(colon + 2)};
  std::string text = what;
  // The first word of a sentence, not a name in capitals.
  const bool is_word = text.size() > 1 && (text[1] == ' ' || (text[1] >= 'a' && text[1] <= 'z'));
  if (is_word) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return {ErrorKind::Usage, "command line", text + help};
}

}  // namespace

std::optional<Error> help_error(const CLI::App& app) {
  const auto commands = commands_of(chosen_of(app));
  const auto words = app.remaining(true);
  // After an option that does not exist a word may be its value.
  if (commands.empty() || words.empty() || is_option(words.front())) return std::nullopt;
  return no_command(words.front(), commands);
}

Error usage_error(const CLI::App& app, const CLI::ParseError& refused) {
  if (const auto words = app.remaining(true); !words.empty()) return unknown_word(app, words);
  const CLI::App& command = chosen_of(app);
  const auto commands = commands_of(command);
  const bool needs_command =
      refused.get_name() == "RequiredError" && !commands.empty() && command.get_parent() != nullptr;
  if (needs_command)
    return {ErrorKind::Usage, "command line",
            "'" + path_of(command) + "' needs a command; " + suggestion("", commands)};
  std::string what = refused.what();
  if (const auto end = what.find('\n'); end != std::string::npos) what.resize(end);
  return wrong_value(app, what);
}

}  // namespace popcut::cli
