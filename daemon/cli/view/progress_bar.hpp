// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace popcut::cli {

/// One line of progress on standard error, redrawn in place; only on a terminal, and only after two
/// seconds.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar();  ///< clears the line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param what  "cutting, stroke 12 of 480"
  /// @param done  0 to 1
  void show(std::string_view what, double done, double seconds_left);
  /// Where nobody knows what is left: what is being done, and for how long.
  void show_time(std::string_view what, double seconds);
  /// Clears the line before other output; the next `show` draws it again.
  void clear();

 private:
  /// Whether it is time to draw; then what is drawn counts as shown now.
  bool turn();
  void draw(const std::string& line);
  bool wanted_;
  bool drawn_{false};
  std::chrono::steady_clock::time_point begun_, last_;
};

/// "designing, 0:34 so far" in at most `width` columns, without a line end.
[[nodiscard]] std::string time_line(std::string_view what, double seconds,
                                    std::size_t width = 1000);

/// "[#####.....] cutting, stroke 12 of 480, 1:20 left" in at most `width` columns, without a
/// line end. What does not fit is left out, the time last.
[[nodiscard]] std::string progress_line(std::string_view what, double done, double seconds_left,
                                        std::size_t width = 1000);

}  // namespace popcut::cli
