// SPDX-License-Identifier: MIT
#pragma once

namespace popcut::planning {

/// Makes this process keep memory that it frees, up to some hundred MB. A search designs and looks
/// at hundreds of cards, one after the other, in arrays of the same few sizes; given back and asked
/// for again, their pages took half of its time. For the rest of the process; where the C library
/// is not glibc it does nothing.
void keep_freed_memory();

}  // namespace popcut::planning
