// SPDX-License-Identifier: MIT
#include "daemon/cli/options/option_value.hpp"

#include <algorithm>
#include <charconv>
#include <functional>

#include <fmt/format.h>

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

Option demand(Option option, std::function<bool(const std::string&)> fits,
              const std::string& right) {
  return option.checked([fits = std::move(fits), right](const std::string& text) {
    return fits(text) ? std::string() : fmt::format("is \"{}\"; {}", text, right);
  });
}

}  // namespace

Option whole_number(Option option, std::int64_t least, std::int64_t most) {
  return demand(
      option, [=](const std::string& text) { return is_within(text, least, most); },
      fmt::format("give a whole number from {} to {}", least, most));
}

Option whole_number_if_given(Option option, std::int64_t least, std::int64_t most) {
  return demand(
             option,
             [=](const std::string& text) { return text.empty() || is_within(text, least, most); },
             fmt::format("give a whole number from {} to {}", least, most))
      .value_optional();
}

Option real_number(Option option, double least, double most, const char* unit) {
  const std::string of = *unit == '\0' ? "" : fmt::format(" ({})", unit);
  return demand(
      option, [=](const std::string& text) { return is_within(text, least, most); },
      fmt::format("give a number from {:g} to {:g}{}", least, most, of));
}

Option one_word(Option option, const std::vector<std::string>& words, const std::string& usual) {
  option.value_text(
      fmt::format("{}{}", fmt::join(words, "|"), usual.empty() ? "" : " [" + usual + "]"));
  return option.checked([words](const std::string& text) {
    const bool known = std::find(words.begin(), words.end(), text) != words.end();
    return known ? std::string() : fmt::format("is \"{}\"; {}", text, suggestion(text, words));
  });
}

}  // namespace popcut::cli
