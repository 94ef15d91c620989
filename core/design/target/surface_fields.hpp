// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

class FieldReader;

/// Reads the `surface` of a design spec; `pointer` is where it stands ("/surface").
///
/// @retval Malformed   an unknown kind or field, a wrong type
/// @retval OutOfRange  a kind that is not known, an empty file name
[[nodiscard]] Result<SurfaceSpec> parse_surface(const nlohmann::json& value,
                                                const std::string& pointer);

/// Reads `scale_mm`, `rotate_deg`, `translate_mm` of a spec; errors are kept by `fields`.
[[nodiscard]] TargetPlacement parse_placement(FieldReader& fields);

/// The JSON Schema of a `surface`.
[[nodiscard]] nlohmann::json surface_schema();

/// Adds the JSON Schema of the fields of `parse_placement` and `fit` to the properties of a spec.
void add_placement_schema(nlohmann::json& properties);

}  // namespace popcut
