// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/verify/sheet/fold_model.hpp"

using namespace popcut;

// What the verifier takes for a pattern: arrays that agree and indices that are there.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = verify::read_fold_model({reinterpret_cast<const char*>(data), size});
  if (!file) {
    if (file.error().detail.empty()) std::abort();
    return 0;
  }
  for (const Vec2& p : file->flat)
    if (!(std::abs(p.x()) <= verify::kMaxCoordinate_mm &&
          std::abs(p.y()) <= verify::kMaxCoordinate_mm))
      std::abort();
  for (const auto& edge : file->edges)
    for (const std::uint32_t v : edge)
      if (v >= file->flat.size()) std::abort();
  if (file->assignment.size() != file->edges.size()) std::abort();
  for (const std::uint32_t v : file->face_vertices)
    if (v >= file->flat.size()) std::abort();
  for (std::size_t face = 0; face < file->faces(); ++face)
    if (file->face_first[face] > file->face_first[face + 1]) std::abort();
  return 0;
}
