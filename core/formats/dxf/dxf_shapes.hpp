// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/formats/dxf/dxf_entity.hpp"

namespace popcut {

/// How an INSERT lays its block, for one place of its array: into the drawing that it stands in.
/// Spacings are turned with the insert but not scaled.
[[nodiscard]] DxfFrame insert_frame(const DxfEntity& insert, const DxfVec& base, double across,
                                    double up);

enum class DxfShape {
  Flat,
  Tilted,  ///< its extrusion is neither up nor down
  Mesh,    ///< a POLYLINE that is none: nothing is drawn
};

/// The line of an entity in page mm; `frame` has the drawing's units in mm. `wrong` says what is
/// not lawful in it.
[[nodiscard]] DxfShape outline_of(const DxfEntity& entity, const DxfFrame& frame, double tolerance,
                                  std::size_t most, std::vector<PagePoint>& line,
                                  std::string& wrong);

}  // namespace popcut
