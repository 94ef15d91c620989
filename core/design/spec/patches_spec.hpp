// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/design/spec/spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// Reads one design of a spec; what `parse_patches` is given for each patch.
using ParseDesign = Result<DesignSpec> (*)(const nlohmann::json& design);

/// Reads a spec with `"patches"`: a list of designs without `popcut`, `material` and `patches`. The
/// whole has `name`, `material`, `join` (one word, or one a border) and `join_tolerance_mm`; its
/// `card`, `fit`, `lattice`, `solver`, `min_panel_mm` and `max_step_over_mean` are the patches' own
/// where they have none. Errors as `parse_design_spec`, in a patch after `/patches/K`.
[[nodiscard]] Result<DesignSpec> parse_patches(const nlohmann::json& root, ParseDesign parse_one);

/// Adds the fields of a spec with patches to the properties of its JSON Schema.
void add_patches_schema(nlohmann::json& properties);

}  // namespace popcut
