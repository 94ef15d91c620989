// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace popcut::testing {

/// What a process held at a moment.
struct Held {
  double s{};  ///< since the first look
  double rss_mib{};
  double files{};
};

/// The memory and the open descriptors of a process now; zero where they cannot be read.
[[nodiscard]] Held held_by(int process, double s);

/// The slope of values over time by least squares, per hour.
[[nodiscard]] double slope_per_h(const std::vector<Held>& looks, double Held::*value);

/// Why a process is not steady; empty: it is. The first quarter, in which it warms up, does not
/// count. What the slopes make of the rest must be small: of memory at most `most_mib`, and of
/// descriptors at most `most_files`.
[[nodiscard]] std::string why_not_steady(const std::vector<Held>& looks, double most_mib,
                                         double most_files);

/// "s,rss_mib,files" and a line for each look.
[[nodiscard]] std::string looks_csv(const std::vector<Held>& looks);
/// A picture of both over the minutes, with the fitted lines.
[[nodiscard]] std::string looks_svg(const std::vector<Held>& looks);

}  // namespace popcut::testing
