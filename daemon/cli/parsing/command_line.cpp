// SPDX-License-Identifier: MIT
#include "daemon/cli/parsing/command_line.hpp"

#include <cstdint>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

namespace popcut::cli {

Option Option::value_text(const std::string& text) const {
  return Option(option_->option_text(text));
}

Option Option::required(bool is_required) const { return Option(option_->required(is_required)); }

Option Option::help(const std::string& text) const { return Option(option_->description(text)); }

Option Option::value_optional() const { return Option(option_->expected(0, 1)); }

Option Option::value_list() const { return Option(option_->delimiter(',')); }

Option Option::one_value() const { return Option(option_->expected(1)); }

Option Option::hidden() const { return Option(option_->group("")); }

Option Option::checked(std::function<std::string(const std::string&)> fault_of) const {
  return Option(option_->check(CLI::Validator(
      [fault_of = std::move(fault_of)](std::string& text) { return fault_of(text); }, "")));
}

bool Option::is_given() const { return option_->count() > 0; }

Command Command::add_command(const std::string& name, const std::string& help) const {
  return Command(*app_->add_subcommand(name, help));
}

void Command::needs_command(std::size_t least, std::size_t most) const {
  app_->require_subcommand(least, most);
}

bool Command::has_chosen_command() const { return !app_->get_subcommands().empty(); }

void Command::hide() const { app_->group(""); }

template <typename Target>
Option Command::add_option(const std::string& names, Target& target,
                           const std::string& help) const {
  return Option(app_->add_option(names, target, help));
}

template Option Command::add_option(const std::string&, std::string&, const std::string&) const;
template Option Command::add_option(const std::string&, int&, const std::string&) const;
template Option Command::add_option(const std::string&, unsigned&, const std::string&) const;
template Option Command::add_option(const std::string&, std::int64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, double&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<std::string>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<int>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<std::int64_t>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<std::uint64_t>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<double>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<std::string>&,
                                    const std::string&) const;

Option Command::add_values(const std::string& names,
                           std::function<void(const std::vector<std::string>&)> keep,
                           const std::string& help) const {
  return Option(app_->add_option_function<std::vector<std::string>>(names, std::move(keep), help));
}

Option Command::add_flag(const std::string& names, bool& target, const std::string& help) const {
  return Option(app_->add_flag(names, target, help));
}

Option Command::add_flag(const std::string& names, int& target, const std::string& help) const {
  return Option(app_->add_flag(names, target, help));
}

Option Command::add_flag(const std::string& names, std::function<void(bool)> keep,
                         const std::string& help) const {
  return Option(app_->add_flag_function(
      names, [keep = std::move(keep)](std::int64_t count) { keep(count > 0); }, help));
}

Option Command::option(const std::string& name) const { return Option(app_->get_option(name)); }

void Command::on_choice(std::function<void()> work) const { app_->callback(std::move(work)); }

void Command::on_read(std::function<void()> work) const {
  app_->parse_complete_callback(std::move(work));
}

bool read_option_number(const std::string& text, double& value) {
  return CLI::detail::lexical_cast(text, value);
}

}  // namespace popcut::cli
