// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "core/design/target/mesh_reader.hpp"
#include "core/formats/gltf/gltf_reader.hpp"

namespace popcut {

Result<TriangleMesh> read_gltf_mesh(const std::string& name, std::string_view bytes) {
  std::string beside;
  const auto model = read_gltf(name, bytes, [&](const std::string& file) -> Result<std::string> {
    if (beside.empty()) beside = file;
    return fail(ErrorKind::Malformed, file, "is another file");
  });
  if (!model && !beside.empty())
    return fail(
        ErrorKind::Malformed, name,
        fmt::format("keeps its mesh in {} beside it; save the model as one file (.glb)", beside));
  if (!model) return tl::unexpected(model.error());
  TriangleMesh mesh;
  const auto add = [&](const GltfPart& part) -> Result<void> {
    mesh.corners.reserve(mesh.corners.size() + 3 * part.corners());
    for (std::size_t k = 0; k < part.corners(); ++k) {
      const auto vertex = part.vertex(k);
      if (!vertex) return tl::unexpected(vertex.error());
      const auto at = part.place(*vertex);
      if (!at) return tl::unexpected(at.error());
      for (const double value : *at) mesh.corners.push_back(static_cast<float>(value));
    }
    return {};
  };
  if (auto done = for_each_part(*model, name, kMaxTriangles, add); !done)
    return tl::unexpected(done.error());
  if (mesh.size() == 0)
    return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
  return mesh;
}

}  // namespace popcut
