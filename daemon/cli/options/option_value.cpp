// SPDX-License-Identifier: MIT
#include "daemon/cli/options/option_value.hpp"

#include <algorithm>
#include <charconv>
#include <functional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/text/near_names.hpp"

namespace popcut::cli {
namespace {

template <typename T>
bool is_within(const std::string& text, T least, T most) {
  T value{};
  const char* const begin = text.data() + (text.rfind('+', 0) == 0 ? 1 : 0);
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(begin, end, value);
  return read.ec == std::errc() && read.ptr == end && value >= least && value <= most;
}

CLI::Option* demand(CLI::Option* option, std::function<bool(const std::string&)> fits,
                    const std::string& right) {
  return checked(option, [fits = std::move(fits), right](const std::string& text) {
    return fits(text) ? std::string() : fmt::format("is \"{}\"; {}", text, right);
  });
}

}  // namespace

CLI::Option* checked(CLI::Option* option, std::function<std::string(const std::string&)> fault_of) {
  return option->check(CLI::Validator(
      [fault_of = std::move(fault_of)](std::string& text) { return fault_of(text); }, ""));
}

void refuse_empty(CLI::App& command, const std::string& but) {
  const auto fault_of = [](const std::string& text) {
    return text.empty() ? std::string("is empty; give a value or leave it out") : std::string();
  };
  for (CLI::Option* option : command.get_options({}))
    if (option->get_expected_min() > 0 && option->get_items_expected_max() > 0)
      checked(option, fault_of);
  for (CLI::App* below : command.get_subcommands({}))
    if (below->get_name() != but) refuse_empty(*below, but);
}

CLI::Option* whole_number(CLI::Option* option, std::int64_t least, std::int64_t most) {
  return demand(
      option, [=](const std::string& text) { return is_within(text, least, most); },
      fmt::format("give a whole number from {} to {}", least, most));
}

CLI::Option* whole_number_if_given(CLI::Option* option, std::int64_t least, std::int64_t most) {
  return demand(
             option,
             [=](const std::string& text) { return text.empty() || is_within(text, least, most); },
             fmt::format("give a whole number from {} to {}", least, most))
      ->expected(0, 1);
}

CLI::Option* real_number(CLI::Option* option, double least, double most, const char* unit) {
  const std::string of = *unit == '\0' ? "" : fmt::format(" ({})", unit);
  return demand(
      option, [=](const std::string& text) { return is_within(text, least, most); },
      fmt::format("give a number from {:g} to {:g}{}", least, most, of));
}

CLI::Option* one_word(CLI::Option* option, const std::vector<std::string>& words,
                      const std::string& usual) {
  option->option_text(
      fmt::format("{}{}", fmt::join(words, "|"), usual.empty() ? "" : " [" + usual + "]"));
  return checked(option, [words](const std::string& text) {
    const bool known = std::find(words.begin(), words.end(), text) != words.end();
    return known ? std::string() : fmt::format("is \"{}\"; {}", text, suggestion(text, words));
  });
}

}  // namespace popcut::cli
