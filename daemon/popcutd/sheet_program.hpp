// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace popcut::daemon {

/// The program of a sheet (from 1) as it was stored with the plan in `folder`: its bytes and the
/// index over them.
///
/// @retval Malformed, OutOfRange, CheckFailed  a file is absent, or not what was written
[[nodiscard]] Result<EncodedProgram> stored_program(const std::string& folder, int sheet);

}  // namespace popcut::daemon
