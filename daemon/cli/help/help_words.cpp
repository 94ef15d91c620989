// SPDX-License-Identifier: MIT
#include "daemon/cli/help/help_words.hpp"

#include <map>

#include <CLI/CLI.hpp>

namespace popcut::cli {
namespace {

// Lines of devices alone begin with a word and a colon.
constexpr const char* kDevices =
    "popcut devices 2>/dev/null | grep '^[a-z]*:' | cut -d' ' -f1 | sort -u";

/// What prints the words for a value of this name.
const std::map<std::string, std::string>& printers() {
  static const std::map<std::string, std::string> kPrinters{
      {"--machine", "popcut machines 2>/dev/null | cut -d' ' -f1"},
      {"--treat-as", "popcut machines 2>/dev/null | cut -d' ' -f1"},
      {"--sim", "popcut machines 2>/dev/null | cut -d' ' -f1"},
      {"--material", "popcut materials 2>/dev/null | cut -d' ' -f1"},
      {"--device", kDevices},
      {"DEVICE", kDevices},
      {"--example", "popcut design --list | cut -d' ' -f1"},
      {"JOB", "popcut jobs -q 2>/dev/null | grep -v '^ ' | cut -d' ' -f1"},
      {"--job", "popcut jobs -q 2>/dev/null | grep -v '^ ' | cut -d' ' -f1"},
      {"--before", "popcut jobs -q 2>/dev/null | grep -v '^ ' | cut -d' ' -f1"}};
  return kPrinters;
}

/// "a|b|c [a]" as words; none if it is no such list.
std::vector<std::string> listed(const std::string& value) {
  const std::string list = value.substr(0, value.find(' '));
  std::vector<std::string> words;
  std::string word;
  for (const char c : list + "|") {
    if (c == '|') {
      words.push_back(word);
      word.clear();
    } else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-') {
      word.push_back(c);
    } else {
      return {};
    }
  }
  return words.size() > 1 ? words : std::vector<std::string>{};
}

void add_kind(OptionWords& option) {
  if (option.value.empty()) return;
  option.kind = WordKind::Free;
  for (const std::string& name : option.names)
    if (const auto found = printers().find(name); found != printers().end()) {
      option.kind = WordKind::Command;
      option.words = {found->second};
      return;
    }
  option.words = listed(option.value);
  if (!option.words.empty()) option.kind = WordKind::Words;
  for (const char* name : {"FILE", "DIR", "PATH", "INPUT", "SPEC", "PATTERN", "PROGRAM", "FOLDER"})
    if (option.value.rfind(name, 0) == 0 || option.names.front() == name)
      option.kind = WordKind::File;
}

OptionWords words_of_option(const CLI::Option& option) {
  OptionWords words;
  for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  if (words.names.empty()) words.names.push_back(option.get_name());
  words.help = option.get_description();
  const bool positional = option.get_positional();
  if (positional || option.get_expected_max() != 0) {
    words.value = option.get_option_text();
    if (words.value.empty())
      words.value = positional ? words.names.front() : option.get_type_name();
    if (words.value.empty()) words.value = "VALUE";
  }
  add_kind(words);
  return words;
}

CommandWords words_of_app(const CLI::App& app, const std::string& path) {
  CommandWords words;
  words.path = path;
  words.text = app.get_description();
  words.footer = app.get_footer();
  words.summary = words.text.substr(0, words.text.find('\n'));
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->get_positional() ? words.positionals : words.options)
        .push_back(words_of_option(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty())
      words.commands.push_back(words_of_app(*command, path + " " + command->get_name()));
  return words;
}

}  // namespace

CommandWords words_of(const Command& program) {
  return words_of_app(program.app(), program.app().get_name());
}

}  // namespace popcut::cli
