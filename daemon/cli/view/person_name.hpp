// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut::cli {

/// A person as popcutd calls them, for reading: "anna (uid:1000)" for "uid:1000" where this
/// computer knows a user of that number, else `principal` as it is.
[[nodiscard]] std::string person_name(const std::string& principal);

}  // namespace popcut::cli
