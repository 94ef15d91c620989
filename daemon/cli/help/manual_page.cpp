// SPDX-License-Identifier: MIT
// Part of daemon/cli/help/help_words.hpp.
#include <fmt/format.h>

#include "daemon/cli/help/help_words.hpp"

namespace popcut::cli {
namespace {

/// Text for roff: nothing in it is a request or an escape.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool line_begin = out.empty() || out.back() == '\n';
    if (line_begin && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out.push_back(c);
  }
  return out;
}

/// The help as paragraphs; indented lines are examples and stay as they are.
std::string paragraphs(const std::string& text) {
  std::string out;
  bool example = false, begun = false;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    const bool indented = line.rfind("  ", 0) == 0;
    if (indented != example && !(line.empty() && example)) {
      out += indented ? ".PP\n.RS 4\n.nf\n" : ".fi\n.RE\n.PP\n";
      example = indented;
    } else if (line.empty() && begun && !example) {
      out += ".PP\n";
    }
    if (!line.empty()) out += plain(line) + "\n";
    begun = true;
  }
  return example ? out + ".fi\n.RE\n" : out;
}

std::string option_text(const OptionWords& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", plain(name));
  if (!option.value.empty() && option.value != option.names.front())
    names += fmt::format(" \\fI{}\\fR", plain(option.value));
  return fmt::format(".TP\n{}\n{}\n", names, plain(option.help));
}

std::string synopsis(const CommandWords& command) {
  std::string line = fmt::format("\\fB{}\\fR", plain(command.path));
  if (!command.options.empty()) line += " [\\fIoptions\\fR]";
  for (const OptionWords& one : command.positionals)
    line += fmt::format(" [\\fI{}\\fR]", plain(one.names.front()));
  if (!command.commands.empty()) line += " \\fIcommand\\fR";
  return line;
}

void add_options(const CommandWords& command, std::string& out) {
  for (const OptionWords& one : command.positionals) out += option_text(one);
  for (const OptionWords& one : command.options)
    if (one.names.back() != "--help") out += option_text(one);
}

void add_commands(const CommandWords& command, std::string& out) {
  for (const CommandWords& one : command.commands) {
    out += fmt::format(".SS {}\n", synopsis(one));
    out += paragraphs(one.text);
    add_options(one, out);
    add_commands(one, out);
  }
}

}  // namespace

std::string manual_page(const CommandWords& program, int section) {
  std::string upper = program.path;
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  std::string what = program.summary;
  if (what.rfind(program.path + " ", 0) == 0) what = what.substr(program.path.size() + 1);
  if (!what.empty() && what.back() == '.') what.pop_back();
  std::string out =
      fmt::format(".TH {} {} \"\" \"popcut {}\" \"popcut\"\n", upper, section, POPCUT_VERSION);
  out += fmt::format(".SH NAME\n{} \\- {}\n", program.path, plain(what));
  out += fmt::format(".SH SYNOPSIS\n{}\n", synopsis(program));
  out += ".SH DESCRIPTION\n" + paragraphs(program.text);
  out += ".SH OPTIONS\n";
  add_options(program, out);
  if (!program.commands.empty()) out += ".SH COMMANDS\n";
  add_commands(program, out);
  out += ".SH EXIT STATUS\n" + paragraphs(program.footer);
  out += fmt::format(".SH SEE ALSO\n\\fB{}\\fR\n",
                     program.path == "popcut" ? "popcutd\\fR(8)" : "popcut\\fR(1)");
  return out;
}

}  // namespace popcut::cli
