// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/spec/spec.hpp"
#include "core/design/strips/strips.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// Puts V-folds on the valley creases of the connectors (docs/geometry.md, section 7; main text,
/// "Multi-state structures"). `alpha[i - 1][k]` is the splay of level i of connector k, 0 for none.
///
/// Each V-fold lies in the middle of its connector, its apex toward the first slice: the crease
/// before and after it stays a valley, the centre fold is a mountain, the side folds are valleys,
/// and a slit from side to side parts the triangles from the rest. Folds, slit and their length
/// keep `ligament_mm` of paper to the connector's edges and to the panels' other folds.
///
/// @retval OutOfRange  the list is not (units - 1) x connectors
/// @retval Infeasible  a V-fold does not fit its panels or its connector; place is its JSON pointer
[[nodiscard]] Result<void> add_v_folds(const Strips& strips, const SplaySpec& splay,
                                       Pattern& pattern);

}  // namespace popcut
