// SPDX-License-Identifier: MIT
#include "daemon/cli/options/samples_option.hpp"

#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "daemon/cli/options/angles.hpp"

namespace popcut::cli {
namespace {

using Parse = Result<double> (*)(std::string_view);

Result<double> parse_number(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) {
    return fail(ErrorKind::Usage, "", fmt::format("'{}' is not a number", text));
  }
  return value;
}

tl::unexpected<Error> wrong(std::string_view option, std::string_view text, std::string_view why,
                            std::string_view right) {
  return fail(ErrorKind::Usage, std::string(option), fmt::format("'{}' {}; {}", text, why, right));
}

Result<Samples> parse(std::string_view option, std::string_view text, Parse number) {
  constexpr std::string_view kForm = "give A:B:N, N values from A to B";
  const std::size_t first = text.find(':');
  if (first == std::string_view::npos) {
    const auto value = number(text);
    if (!value) return wrong(option, text, "is not a value", kForm);
    return Samples{*value, *value, 1};
  }
  const std::size_t second = text.find(':', first + 1);
  if (second == std::string_view::npos || text.find(':', second + 1) != std::string_view::npos) {
    return wrong(option, text, "is not of the form A:B:N", kForm);
  }
  const auto from = number(text.substr(0, first));
  const auto to = number(text.substr(first + 1, second - first - 1));
  if (!from || !to) return wrong(option, text, "does not begin with two values", kForm);
  const std::string_view digits = text.substr(second + 1);
  std::size_t count = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  const bool whole = stop == digits.data() + digits.size() && !digits.empty();
  if (whole && error == std::errc::result_out_of_range) count = kMostSamples + 1;
  if (!whole || (error != std::errc() && count <= kMostSamples)) {
    return wrong(option, text, "does not end with a whole number", kForm);
  }
  if (count < 2 || count > kMostSamples) {
    return wrong(option, text, fmt::format("asks for {} values", digits),
                 fmt::format("N is from 2 to {}", kMostSamples));
  }
  return Samples{*from, *to, count};
}

}  // namespace

Result<Samples> parse_samples(std::string_view option, std::string_view text) {
  return parse(option, text, parse_number);
}

Result<Samples> parse_opening_samples(std::string_view option, std::string_view text) {
  auto samples = parse(option, text, parse_angle);
  if (!samples) return samples;
  for (const double angle : {samples->from, samples->to}) {
    if (!(angle >= 0 && angle <= std::numbers::pi)) {
      return wrong(option, text, "leaves the opening angles", "they go from 0 (shut) to pi (flat)");
    }
  }
  return samples;
}

}  // namespace popcut::cli
