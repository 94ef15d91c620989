// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace popcut::cli {

// The only way to CLI11, whose header is compiled in few places because it takes long.

/// An option or an argument of a command. A handle: its copies mean the same option.
class Option {
 public:
  Option() = default;
  explicit Option(CLI::Option* option) : option_(option) {}

  // Each changes the option and gives it back for the next. NOLINTBEGIN(modernize-use-nodiscard)
  /// What the help shows in place of the value: "MM [0.05]".
  Option value_text(const std::string& text) const;
  Option required(bool is_required = true) const;
  Option help(const std::string& text) const;
  /// It may stand without its value.
  Option value_optional() const;
  /// Several values in one word, with commas between them.
  Option value_list() const;
  /// Takes exactly one value, also where its target could hold more.
  Option one_value() const;
  /// The help does not show it.
  Option hidden() const;
  /// Refuses, while the command line is read, each value with which `fault_of` finds a fault: it
  /// returns "" or "is "x"; give ...".
  Option checked(std::function<std::string(const std::string&)> fault_of) const;
  // NOLINTEND(modernize-use-nodiscard)

  /// Whether it stands on the command line.
  [[nodiscard]] bool is_given() const;

 private:
  CLI::Option* option_{};
};

/// A command with its options, or the whole program. A handle, as `Option`.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  [[nodiscard]] Command add_command(const std::string& name, const std::string& help) const;
  /// From `least` to `most` of the commands below it must be named; a `most` of 0 is any number.
  void needs_command(std::size_t least, std::size_t most) const;
  /// Whether one of the commands below it is named.
  [[nodiscard]] bool has_chosen_command() const;
  /// The help of the program does not list it.
  void hide() const;

  /// An option ("-o,--output") or an argument ("FILE") for `target`: a text, a number, an
  /// `optional` or a `vector` of these. `command_line.cpp` lists the types.
  template <typename Target>
  Option add_option(const std::string& names, Target& target, const std::string& help) const;
  /// An option whose values are given to `keep`.
  Option add_values(const std::string& names,
                    std::function<void(const std::vector<std::string>&)> keep,
                    const std::string& help) const;
  Option add_flag(const std::string& names, bool& target, const std::string& help) const;
  /// Counts how often it is given.
  Option add_flag(const std::string& names, int& target, const std::string& help) const;
  Option add_flag(const std::string& names, std::function<void(bool)> keep,
                  const std::string& help) const;
  /// The option or argument that was added as `name`.
  [[nodiscard]] Option option(const std::string& name) const;

  /// Calls `work` once the command line is read, if the user chose this command.
  void on_choice(std::function<void()> work) const;
  /// Calls `work` as soon as the words of this command are read, before `on_choice`.
  void on_read(std::function<void()> work) const;

  [[nodiscard]] CLI::App& app() const { return *app_; }

 private:
  CLI::App* app_;
};

/// Reads all of `text` as a number in the way of an option whose target is a double.
[[nodiscard]] bool read_option_number(const std::string& text, double& value);

}  // namespace popcut::cli
