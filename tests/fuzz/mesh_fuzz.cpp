// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/model/height_grid.hpp"
#include "core/model/model.hpp"

using namespace popcut;

namespace {

void check(const Result<TriangleMesh>& mesh) {
  if (!mesh) {
    if (mesh.error().detail.empty()) std::abort();
    return;
  }
  if (mesh->size() == 0 || mesh->size() > kMaxTriangles || mesh->corners.size() % 9 != 0)
    std::abort();
  for (const float one : mesh->corners)
    if (!std::isfinite(one)) std::abort();
}

}  // namespace

// The first byte chooses what the rest is called; triangles that come out are finite numbers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      check(read_mesh("model.stl", rest));
      break;
    case 1:
      check(read_mesh("model.obj", rest));
      break;
    case 2:
      check(read_mesh("model", rest));
      break;
    default:
      check(read_height_grid("heights.csv", rest));
  }
  return 0;
}
