// SPDX-License-Identifier: MIT
#pragma once

#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Parts a sheet along its cuts: where the faces around a vertex do not hang together there, each
/// group of them gets a vertex of its own, and a cut drawn as one edge becomes two borders. The
/// faces and the first copies keep their numbers, copies come after them; a slit that both its ends
/// hold together stays one edge. Poses of the file are given the copies too.
/// @return how many vertices were added
std::size_t part_at_cuts(FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify
