// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut {

/// Whether bytes begin as a gzip file does.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// The content of a gzip file (RFC 1952), of one or several members.
///
/// @retval Malformed   broken or not whole
/// @retval OutOfRange  larger than `most_bytes`
[[nodiscard]] Result<std::string> unpacked(std::string_view bytes, std::size_t most_bytes);

}  // namespace popcut
