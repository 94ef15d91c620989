// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/formats/fold/fold_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto file = popcut::read_fold(text);
  if (file) {
    for (const popcut::FoldFrame& frame : file->frames) {
      const std::size_t count = frame.vertices.size();
      for (const auto& edge : frame.edges)
        if (std::max(edge[0], edge[1]) >= count) std::abort();
      for (const auto& face : frame.faces)
        for (const std::uint32_t v : face)
          if (v >= count) std::abort();
      if (frame.assignments.size() != frame.edges.size()) std::abort();
      if (frame.fold_angles_deg.size() != frame.edges.size()) std::abort();
    }
  } else if (file.error().detail.empty()) {
    std::abort();
  }
  const auto work = popcut::linework_from_fold(text);
  if (!work) return 0;
  for (const popcut::PagePoint& p : work->points)
    if (!(std::abs(p.x) <= popcut::kMaxCoordinate && std::abs(p.y) <= popcut::kMaxCoordinate))
      std::abort();
  return 0;
}
