// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut::daemon {

/// A label's value as OpenMetrics wants it: backslash and quote escaped, a newline as a blank.
[[nodiscard]] inline std::string metric_label(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

}  // namespace popcut::daemon
