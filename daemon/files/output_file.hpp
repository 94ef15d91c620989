// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

#include "core/result.hpp"

namespace popcut::cli {

/// Writes one file: aside, then renamed, so that it appears whole or not at all. What is there and
/// is no plain file (a pipe, /dev/null) is written to directly.
///
/// @retval Unwritable  it cannot be written; `place` is the file
[[nodiscard]] Result<void> write_whole_file(const std::filesystem::path& path,
                                            const std::function<void(std::ostream&)>& write);

}  // namespace popcut::cli
