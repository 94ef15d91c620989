// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/formats/dxf/dxf_entity.hpp"

namespace popcut {

/// How an INSERT places its block in the drawing around it, for one cell of its array. The insert's
/// rotation applies to the spacings, its scale does not.
[[nodiscard]] DxfFrame insert_frame(const DxfEntity& insert, const DxfVec& base, double across,
                                    double up);

/// What became of an entity that was outlined.
enum class DxfShape {
  Flat,
  Tilted,  ///< the extrusion is neither up nor down
  Mesh,    ///< a POLYLINE that is a mesh: nothing is drawn
};

/// Appends the outline of an entity in page mm; `frame` maps drawing units to mm. `wrong` gets a
/// sentence on what is not valid in the entity.
[[nodiscard]] DxfShape outline_of(const DxfEntity& entity, const DxfFrame& frame, double tolerance,
                                  std::size_t most, std::vector<PagePoint>& line,
                                  std::string& wrong);

}  // namespace popcut
