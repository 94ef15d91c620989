// SPDX-License-Identifier: MIT
#pragma once

namespace popcut::daemon {

/// Gives back memory that only the start needed: free blocks of the heap, and pages of programs and
/// libraries that can be read from their files again (the tables by which they were linked, and all
/// of those that only the workers use). What is used after all comes back page by page.
void give_back_start();

}  // namespace popcut::daemon
