// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut::daemon {

/// popcutd.toml: every key with its default, commented out, and what it means.
extern const std::string_view kConfigText;

}  // namespace popcut::daemon
