// SPDX-License-Identifier: MIT
#include "daemon/cli/options/angles.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

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

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

}  // namespace

Result<double> parse_angle(std::string_view text) {
  constexpr std::string_view kDegrees = "deg";
  text = trimmed(text);
  std::optional<double> angle = number(text);
  if (!angle && text.size() > kDegrees.size() && text.ends_with(kDegrees)) {
    angle = number(text.substr(0, text.size() - kDegrees.size()));
    if (angle) angle = *angle / 180.0 * std::numbers::pi;
  }
  if (!angle) angle = multiple_of_pi(text);
  if (angle) return *angle;
  return fail(ErrorKind::Usage, "command line",
              "'" + std::string(text) + "' is not an angle; give radians (1.1, pi/2) or 90deg");
}

Result<std::vector<double>> parse_opening_angles(std::string_view text) {
  std::vector<double> angles;
  while (!trimmed(text).empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    const auto angle = parse_angle(item);
    if (!angle) return tl::unexpected(angle.error());
    if (!(*angle >= 0 && *angle <= std::numbers::pi)) {
      return fail(
          ErrorKind::Usage, "command line",
          "'" + std::string(item) + "' is not an opening angle; give 0 (shut) to pi (flat)");
    }
    angles.push_back(*angle);
    text.remove_prefix(std::min(text.size(), item.size() + 1));
  }
  return angles;
}

}  // namespace popcut::cli
