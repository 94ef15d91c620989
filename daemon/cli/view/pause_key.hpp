// SPDX-License-Identifier: MIT
#pragma once

#include <termios.h>

#include <atomic>
#include <optional>

namespace popcut::cli {

/// The key p at the terminal, which pauses a cut and lets it go on. Without a terminal it does
/// nothing. While it exists, keys are read at once and not echoed.
class PauseKey {
 public:
  PauseKey();
  ~PauseKey();
  PauseKey(const PauseKey&) = delete;
  PauseKey& operator=(const PauseKey&) = delete;

  /// Reads the keys that were pressed since.
  void look();
  /// Whether there is a terminal with keys.
  [[nodiscard]] bool works() const { return before_.has_value(); }
  /// Pauses as if the key had been pressed.
  void press() { asked_ = true; }
  [[nodiscard]] const std::atomic<bool>& asked() const { return asked_; }

 private:
  std::atomic<bool> asked_{false};
  std::optional<termios> before_;
};

}  // namespace popcut::cli
