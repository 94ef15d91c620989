// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/artwork/colour_mesh_reader.hpp"
#include "daemon/pictures/image_reader.hpp"

using namespace popcut;

namespace {

void check(const Result<ColourMesh>& mesh) {
  if (!mesh) {
    if (mesh.error().detail.empty()) std::abort();
    return;
  }
  if (mesh->size() == 0 || mesh->surfacing_of.size() != mesh->size()) std::abort();
  for (std::size_t t = 0; t < mesh->size(); ++t) {
    const Colour colour = colour_of(*mesh, t, {0.25, 0.5, 0.25}, texels_across(*mesh, t, 10));
    if (!(colour.r >= 0 && colour.r <= 256)) std::abort();
  }
}

}  // namespace

// The first byte chooses what the rest is; an OBJ's materials are the rest too.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  const ModelFiles files{
      [rest](const std::string&) -> Result<std::string> { return std::string(rest); },
      [](const std::string&, std::string_view) -> Result<ColourImage> {
        return ColourImage(2, 2);
      }};
  switch (data[0] % 4) {
    case 0:
      check(read_colour_mesh("model.obj", rest, files));
      break;
    case 1:
      check(read_colour_mesh("model.glb", rest, files));
      break;
    case 2:
      check(read_colour_mesh("model.gltf", rest, files));
      break;
    default:
      if (const auto image = read_image("picture", rest); !image && image.error().detail.empty())
        std::abort();
  }
  return 0;
}
