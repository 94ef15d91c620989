// SPDX-License-Identifier: MIT
#pragma once

#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Separates a sheet along its cuts. Each group of connected faces around a vertex gets its own
/// vertex, and a cut drawn as one edge becomes two borders. Faces and the first group at each
/// vertex keep their numbers; copies come after them. A slit that is connected at both ends stays
/// one edge. The file's poses get the copies too.
/// @return number of added vertices
std::size_t part_at_cuts(FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify
