// SPDX-License-Identifier: MIT
#include "daemon/planning/search/freed_memory.hpp"

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace popcut::planning {

void keep_freed_memory() {
#ifdef M_MMAP_THRESHOLD
  constexpr int kMiB = 1024 * 1024;
  mallopt(M_MMAP_THRESHOLD, 16 * kMiB);
  mallopt(M_TRIM_THRESHOLD, 256 * kMiB);
  mallopt(M_TOP_PAD, 16 * kMiB);
#endif
}

}  // namespace popcut::planning
