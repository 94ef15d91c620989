// SPDX-License-Identifier: MIT
#include "daemon/cli/view/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "daemon/cli/help/terminal_text.hpp"

namespace popcut::cli {

using std::chrono::steady_clock;

ProgressBar::ProgressBar(bool wanted)
    : wanted_(wanted && isatty(STDERR_FILENO) == 1), begun_(steady_clock::now()) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::clear() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);  // never throws: the terminal may be gone
  drawn_ = false;
}

bool ProgressBar::turn() {
  const auto now = steady_clock::now();
  const bool too_early = now - begun_ < std::chrono::seconds(2);
  if (!wanted_ || too_early || (drawn_ && now - last_ < std::chrono::milliseconds(100)))
    return false;
  drawn_ = true;
  last_ = now;
  return true;
}

void ProgressBar::draw(const std::string& line) {
  fmt::print(stderr, "\r{}\x1b[K", line);
  std::fflush(stderr);
}

// One column is left free: a full line would break on some terminals.
void ProgressBar::show(std::string_view what, double done, double seconds_left) {
  if (turn())
    draw(progress_line(what, done, seconds_left, terminal_columns(STDERR_FILENO, 80) - 1));
}

void ProgressBar::show_time(std::string_view what, double seconds) {
  if (turn()) draw(time_line(what, seconds, terminal_columns(STDERR_FILENO, 80) - 1));
}

std::string time_line(std::string_view what, double seconds, std::size_t width) {
  const auto whole = static_cast<long>(std::clamp(seconds, 0.0, 359999.0));
  const std::string time = fmt::format("{}:{:02} so far", whole / 60, whole % 60);
  if (time.size() + 3 > width) return fitted(time, width);
  std::string begin = fitted(std::string(what), width - time.size() - 2);
  begin.resize(begin.find_last_not_of(" ,") + 1);
  return begin + ", " + time;
}

std::string progress_line(std::string_view what, double done, double seconds_left,
                          std::size_t width) {
  constexpr std::size_t kMostCells = 24, kLeastCells = 6, kFrame = 3;
  const double part = std::isfinite(done) ? std::clamp(done, 0.0, 1.0) : 0.0;
  const double left = std::isfinite(seconds_left) ? std::clamp(seconds_left, 0.0, 359999.0) : 0.0;
  const auto whole = static_cast<long>(std::ceil(left));
  const std::string time = fmt::format("{}:{:02} left", whole / 60, whole % 60);
  const std::string words = fmt::format("{}, {}", what, time);
  // Where there is little room the bar gives way first, then the words, and the time last.
  const std::size_t need = columns_of(words) + kFrame;
  if (need + kLeastCells > width) {
    if (need <= width + kFrame) return words;
    if (time.size() + kFrame > width) return fitted(time, width);
    std::string begin = fitted(std::string(what), width - time.size() - 2);
    begin.resize(begin.find_last_not_of(" ,") + 1);
    return begin + (begin.empty() ? "" : ", ") + time;
  }
  const std::size_t cells = std::min(kMostCells, width - need);
  const auto filled = static_cast<std::size_t>(part * static_cast<double>(cells));
  return fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(cells - filled, '.'),
                     words);
}

}  // namespace popcut::cli
