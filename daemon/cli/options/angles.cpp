// SPDX-License-Identifier: MIT
#include "daemon/cli/options/angles.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/text/words.hpp"

namespace popcut::cli {
namespace {

/// All of `text` as a finite number.
std::optional<double> number(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// `[number[*]]pi[/number]`.
std::optional<double> multiple_of_pi(std::string_view text) {
  const std::size_t pi = text.find("pi");
  if (pi == std::string_view::npos) return std::nullopt;
  std::string_view factor = text.substr(0, pi), divisor = text.substr(pi + 2);
  if (!factor.empty() && factor.back() == '*') {
    factor.remove_suffix(1);
    if (factor.empty()) return std::nullopt;
  }
  std::optional<double> times = 1.0, over = 1.0;
  if (!factor.empty()) times = number(factor);
  if (!divisor.empty()) over = divisor.front() == '/' ? number(divisor.substr(1)) : std::nullopt;
  if (!times || !over || *over == 0) return std::nullopt;
  return *times * std::numbers::pi / *over;
}

using Parse = Result<double> (*)(std::string_view);

Result<double> parse_number(std::string_view text) {
  if (const auto value = number(text)) return *value;
  return fail(ErrorKind::Usage, "", fmt::format("'{}' is not a number", text));
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
    if (!value) return wrong(option, text, "is not a number or range", kForm);
    return Samples{*value, *value, 1};
  }
  const std::size_t second = text.find(':', first + 1);
  if (second == std::string_view::npos || text.find(':', second + 1) != std::string_view::npos)
    return wrong(option, text, "is not of the form A:B:N", kForm);
  const auto from = number(text.substr(0, first));
  const auto to = number(text.substr(first + 1, second - first - 1));
  if (!from || !to) return wrong(option, text, "does not begin with two values", kForm);
  const std::string_view digits = text.substr(second + 1);
  std::size_t count = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  const bool whole = stop == digits.data() + digits.size() && !digits.empty();
  if (whole && error == std::errc::result_out_of_range) count = kMostSamples + 1;
  if (!whole || (error != std::errc() && count <= kMostSamples))
    return wrong(option, text, "does not end with a whole number", kForm);
  if (count < 2 || count > kMostSamples)
    return wrong(option, text, fmt::format("asks for {} values", digits),
                 fmt::format("N is from 2 to {}", kMostSamples));
  return Samples{*from, *to, count};
}

}  // namespace

Result<double> parse_angle(std::string_view text) {
  constexpr std::string_view kUnit = "deg";
  text = trimmed(text, " ");
  std::optional<double> angle = number(text);
  if (!angle && text.size() > kUnit.size() && text.ends_with(kUnit)) {
    angle = number(text.substr(0, text.size() - kUnit.size()));
    if (angle) angle = psi_rad_of(*angle);
  }
  if (!angle) angle = multiple_of_pi(text);
  if (angle) return *angle;
  return fail(ErrorKind::Usage, "command line",
              "'" + std::string(text) + "' is not an angle; give radians (1.1, pi/2) or 90deg");
}

std::string degrees_hint(std::string_view text) {
  text = trimmed(text, " ");
  const auto value = number(text);
  if (!value || !(*value > std::numbers::pi && *value <= 180)) return {};
  return fmt::format("; for {0} degrees, give {0}deg", text);
}

Result<std::vector<double>> parse_opening_angles(std::string_view text) {
  std::vector<double> angles;
  while (!trimmed(text, " ").empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    const auto angle = parse_angle(item);
    if (!angle) return tl::unexpected(angle.error());
    if (!(*angle >= 0 && *angle <= std::numbers::pi)) {
      return fail(ErrorKind::Usage, "command line",
                  "'" + std::string(item) +
                      "' is not an opening angle; give 0 (closed) to pi (flat)" +
                      degrees_hint(item));
    }
    angles.push_back(*angle);
    text.remove_prefix(std::min(text.size(), item.size() + 1));
  }
  return angles;
}

Result<Samples> parse_samples(std::string_view option, std::string_view text) {
  return parse(option, text, parse_number);
}

Result<Samples> parse_opening_samples(std::string_view option, std::string_view text) {
  auto samples = parse(option, text, parse_angle);
  if (!samples) return samples;
  for (const double angle : {samples->from, samples->to}) {
    if (!(angle >= 0 && angle <= std::numbers::pi))
      return wrong(option, text, "is outside the opening angles",
                   "give 0 (closed) to pi (flat)" + degrees_hint(text.substr(0, text.find(':'))));
  }
  return samples;
}

}  // namespace popcut::cli
