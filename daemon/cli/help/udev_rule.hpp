// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut::cli {

/// `systemd/60-popcut.rules`, embedded when popcut is built.
[[nodiscard]] std::string_view udev_rule();

}  // namespace popcut::cli
