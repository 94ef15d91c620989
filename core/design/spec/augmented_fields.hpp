// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/design/spec/augmented_spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// Reads the `curvature` of a design spec, of which `value` is the content.
///
/// @retval Malformed   an unknown field, a wrong type, nothing asked for, a weight without targets
/// @retval OutOfRange  a negative weight, a value that is not lawful, a first form that has no area
[[nodiscard]] Result<AugmentedSpec> parse_augmented(const nlohmann::json& value);

/// The JSON Schema of `curvature`.
[[nodiscard]] nlohmann::json augmented_schema();

}  // namespace popcut
