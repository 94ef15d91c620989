// SPDX-License-Identifier: MIT
#include "daemon/cli/view/pause_key.hpp"

#include <poll.h>
#include <unistd.h>

namespace popcut::cli {

PauseKey::PauseKey() {
  termios now{};
  // In the background a change of the terminal would stop the cut.
  if (isatty(STDIN_FILENO) != 1 || tcgetpgrp(STDIN_FILENO) != getpgrp() ||
      tcgetattr(STDIN_FILENO, &now) != 0)
    return;
  before_ = now;
  now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C stays a signal
  tcsetattr(STDIN_FILENO, TCSANOW, &now);
}

PauseKey::~PauseKey() {
  if (before_) tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

void PauseKey::look() {
  if (!before_) return;
  for (pollfd keys{STDIN_FILENO, POLLIN, 0}; poll(&keys, 1, 0) == 1;) {
    char key = 0;
    if (read(STDIN_FILENO, &key, 1) != 1) return;
    if (key == 'p' || key == 'P') asked_ = !asked_;
  }
}

}  // namespace popcut::cli
