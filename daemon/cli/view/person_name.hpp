// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut::cli {

/// A user of popcutd with a readable name: "anna (uid:1000)" for "uid:1000" if this computer has a
/// user with that number, else `principal` unchanged.
[[nodiscard]] std::string person_name(const std::string& principal);

}  // namespace popcut::cli
