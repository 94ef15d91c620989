// SPDX-License-Identifier: MIT
#include "daemon/cli/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

namespace popcut::cli {

using std::chrono::steady_clock;

ProgressBar::ProgressBar(bool wanted)
    : wanted_(wanted && isatty(STDERR_FILENO) == 1), begun_(steady_clock::now()) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::clear() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
  drawn_ = false;
}

void ProgressBar::show(std::string_view what, double done, double seconds_left) {
  const auto now = steady_clock::now();
  const bool too_early = now - begun_ < std::chrono::seconds(2);
  if (!wanted_ || too_early || (drawn_ && now - last_ < std::chrono::milliseconds(100))) return;
  drawn_ = true;
  last_ = now;
  fmt::print(stderr, "\r{}\x1b[K", progress_line(what, done, seconds_left));
  std::fflush(stderr);
}

std::string progress_line(std::string_view what, double done, double seconds_left) {
  constexpr int kWidth = 24;
  const double part = std::isfinite(done) ? std::clamp(done, 0.0, 1.0) : 0.0;
  const auto filled = static_cast<std::size_t>(part * kWidth);
  const double left = std::isfinite(seconds_left) ? std::clamp(seconds_left, 0.0, 359999.0) : 0.0;
  const auto whole = static_cast<long>(std::ceil(left));
  return fmt::format("[{}{}] {}, {}:{:02} left", std::string(filled, '#'),
                     std::string(kWidth - filled, '.'), what, whole / 60, whole % 60);
}

}  // namespace popcut::cli
