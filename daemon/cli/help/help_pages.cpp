// SPDX-License-Identifier: MIT
#include "daemon/cli/help/help_pages.hpp"

#include <fmt/format.h>

#include "core/text/near_names.hpp"
#include "daemon/cli/help/help_words.hpp"

namespace popcut::cli {
namespace {

/// `text` in single quotes for a shell.
std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string names_of(const std::vector<CommandWords>& commands) {
  std::string names;
  for (const CommandWords& one : commands)
    names += (names.empty() ? "" : " ") + one.path.substr(one.path.rfind(' ') + 1);
  return names;
}

std::string function_of(const std::string& path) {
  std::string name = "_" + path;
  for (char& c : name)
    if (c == ' ' || c == '-') c = '_';
  return name;
}

// bash

std::string bash_value(const OptionWords& option) {
  switch (option.kind) {
    case WordKind::File:
      return "COMPREPLY=($(compgen -f -- \"$cur\")); compopt -o filenames 2>/dev/null";
    case WordKind::Words:
      return fmt::format("COMPREPLY=($(compgen -W {} -- \"$cur\"))",
                         shell_quoted(joined(option.words)));
    case WordKind::Command:
      return fmt::format("COMPREPLY=($(compgen -W \"$({})\" -- \"$cur\"))", option.words.front());
    default:
      return "COMPREPLY=()";
  }
}

/// Which argument is under way: words that are neither options nor their values are counted.
std::string bash_positionals(const CommandWords& command) {
  std::string out, valued;
  for (const OptionWords& option : command.options)
    if (option.kind != WordKind::None)
      valued += (valued.empty() ? "" : "|") + fmt::format("{}", fmt::join(option.names, "|"));
  out +=
      "  local k n=0\n  for ((k = depth; k < cword; k++)); do\n"
      "    [[ ${words[k]} == -* ]] && continue\n";
  if (!valued.empty())
    out += fmt::format("    [[ ${{words[k-1]}} == @({}) ]] && continue\n", valued);
  out += "    n=$((n+1))\n  done\n  case $n in\n";
  for (std::size_t k = 0; k < command.positionals.size(); ++k)
    out += fmt::format("    {}) {} ;;\n", k, bash_value(command.positionals[k]));
  return out + "    *) COMPREPLY=() ;;\n  esac\n";
}

void bash_command(const CommandWords& command, std::string& out) {
  for (const CommandWords& one : command.commands) bash_command(one, out);
  std::string flags;
  out += fmt::format("{}() {{\n  case $prev in\n", function_of(command.path));
  for (const OptionWords& option : command.options) {
    flags += (flags.empty() ? "" : " ") + joined(option.names);
    if (option.kind != WordKind::None)
      out += fmt::format("    {}) {}; return ;;\n", fmt::format("{}", fmt::join(option.names, "|")),
                         bash_value(option));
  }
  out += "  esac\n";
  for (const CommandWords& one : command.commands) {
    const std::string name = one.path.substr(one.path.rfind(' ') + 1);
    out += fmt::format(
        "  [[ ${{words[$depth]}} == {} && $cword -gt $depth ]] && {{ depth=$((depth+1)); "
        "{}; return; }}\n",
        name, function_of(one.path));
  }
  out += fmt::format(
      "  if [[ $cur == -* ]]; then COMPREPLY=($(compgen -W {} -- \"$cur\")); return; fi\n",
      shell_quoted(flags));
  if (!command.commands.empty())
    out += fmt::format("  COMPREPLY=($(compgen -W {} -- \"$cur\"))\n",
                       shell_quoted(names_of(command.commands)));
  else if (!command.positionals.empty())
    out += bash_positionals(command);
  else
    out += "  COMPREPLY=()\n";
  out += "}\n";
}

std::string bash_page(const CommandWords& program) {
  std::string out = fmt::format("# bash completion for {}; made from its help.\n", program.path);
  bash_command(program, out);
  out += fmt::format(
      "{0}_start() {{\n"
      "  # bash divides words at ':' and '='; here sim:cameo3 is one, and the common options "
      "none.\n"
      "  local words=() word glue= k\n"
      "  for ((k = 0; k <= COMP_CWORD; k++)); do\n"
      "    word=${{COMP_WORDS[k]}}\n"
      "    if ((k < COMP_CWORD)); then\n"
      "      case $word in -q|-v|--quiet|--verbose|--json|=) continue ;; esac\n"
      "    fi\n"
      "    [[ $word == = ]] && word=\n"
      "    if [[ ${{#words[@]}} -gt 1 && ( $glue || $word == :* ) ]]; then\n"
      "      words[${{#words[@]}}-1]+=$word\n"
      "    else\n      words+=(\"$word\")\n    fi\n"
      "    [[ $word == *: ]] && glue=1 || glue=\n"
      "  done\n"
      "  local cword=$((${{#words[@]}}-1)) depth=1\n"
      "  local cur=${{words[cword]}} prev=${{words[cword-1]}}\n"
      "  {0}\n"
      "  if [[ $cur == *:* && $COMP_WORDBREAKS == *:* ]]; then\n"
      "    COMPREPLY=(\"${{COMPREPLY[@]#\"${{cur%\"${{cur##*:}}\"}}\"}}\")\n"
      "  fi\n}}\n"
      "complete -F {0}_start {1}\n",
      function_of(program.path), program.path);
  return out;
}

// fish

std::string fish_value(const OptionWords& option) {
  switch (option.kind) {
    case WordKind::None:
      return "";
    case WordKind::File:
      return " -rF";
    case WordKind::Words:
      return " -xa " + shell_quoted(joined(option.words));
    case WordKind::Command:
      return " -xa " + shell_quoted("(" + option.words.front() + ")");
    default:
      return " -x";
  }
}

/// In which command a line holds.
std::string fish_where(const CommandWords& command, const CommandWords& program) {
  if (&command == &program) return program.commands.empty() ? "" : " -n __fish_use_subcommand";
  std::string seen;
  const std::string below = command.path.substr(program.path.size() + 1);
  for (std::size_t at = 0; at <= below.size();) {
    const std::size_t end = std::min(below.find(' ', at), below.size());
    seen += (seen.empty() ? "" : "; and ") + std::string("__fish_seen_subcommand_from ") +
            below.substr(at, end - at);
    at = end + 1;
  }
  return " -n " + shell_quoted(seen);
}

void fish_command(const CommandWords& command, const CommandWords& program, std::string& out) {
  const std::string begin = "complete -c " + program.path + fish_where(command, program);
  for (const CommandWords& one : command.commands)
    out += fmt::format("{} -f -a {} -d {}\n", begin, one.path.substr(one.path.rfind(' ') + 1),
                       shell_quoted(one.summary));
  for (const OptionWords& option : command.options) {
    out += begin;
    for (const std::string& name : option.names)
      out += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
    out += fish_value(option) + " -d " + shell_quoted(option.help) + "\n";
  }
  for (const OptionWords& one : command.positionals)
    if (one.kind == WordKind::Command || one.kind == WordKind::Words)
      out += begin + " -f" + fish_value(one).replace(1, 2, "-") + "\n";
  for (const CommandWords& one : command.commands) fish_command(one, program, out);
}

// zsh

std::string zsh_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out.push_back('\\');
    out.push_back(c == '\n' ? ' ' : c);
  }
  return out;
}

std::string zsh_action(const OptionWords& option) {
  switch (option.kind) {
    case WordKind::File:
      return "_files";
    case WordKind::Words:
      return "(" + joined(option.words) + ")";
    case WordKind::Command:
      return "{compadd -- ${(f)\"$(" + option.words.front() + ")\"}}";
    default:
      return " ";
  }
}

void zsh_command(const CommandWords& command, std::string& out) {
  for (const CommandWords& one : command.commands) zsh_command(one, out);
  const bool has_commands = !command.commands.empty();
  out += fmt::format("{}() {{\n  local state\n  _arguments -C -s \\\n", function_of(command.path));
  for (const OptionWords& option : command.options)
    for (const std::string& name : option.names) {
      std::string spec = name + "[" + zsh_escaped(option.help) + "]";
      if (option.kind != WordKind::None)
        spec += ":" + zsh_escaped(option.value) + ":" + zsh_action(option);
      out += "    " + shell_quoted(spec) + " \\\n";
    }
  for (const OptionWords& one : command.positionals)
    out += "    " + shell_quoted(":" + zsh_escaped(one.names.front()) + ":" + zsh_action(one)) +
           " \\\n";
  out += has_commands
             ? fmt::format("    '1:command:({})' '*::word:->word'\n", names_of(command.commands))
             : "    && return\n";
  if (has_commands) out += "  [[ $state == word ]] || return\n  case $words[1] in\n";
  for (const CommandWords& one : command.commands)
    out += fmt::format("    {}) {} ;;\n", one.path.substr(one.path.rfind(' ') + 1),
                       function_of(one.path));
  out += has_commands ? "  esac\n}\n" : "}\n";
}

std::string zsh_page(const CommandWords& program) {
  std::string out =
      fmt::format("#compdef {}\n# Made from the help of {}.\n", program.path, program.path);
  zsh_command(program, out);
  return out + function_of(program.path) + " \"$@\"\n";
}

}  // namespace

const std::vector<std::string>& help_page_kinds() {
  static const std::vector<std::string> kKinds{"bash", "zsh", "fish", "man"};
  return kKinds;
}

Result<std::string> help_page(const Command& command, const std::string& kind, int section) {
  const CommandWords program = words_of(command);
  if (kind == "man") return manual_page(program, section);
  if (kind == "bash") return bash_page(program);
  if (kind == "zsh") return zsh_page(program);
  if (kind == "fish") {
    std::string out = fmt::format("# fish completion for {}; made from its help.\n", program.path);
    fish_command(program, program, out);
    return out;
  }
  return fail(ErrorKind::Usage, "help page", suggestion(kind, help_page_kinds()));
}

}  // namespace popcut::cli
