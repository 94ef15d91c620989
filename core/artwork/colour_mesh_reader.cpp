// SPDX-License-Identifier: MIT
#include "core/artwork/colour_mesh_reader.hpp"

#include <fmt/format.h>

#include "core/design/target/mesh_reader.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

bool ends_with(const std::string& name, std::string_view ending) {
  return name.size() >= ending.size() &&
         same_word(std::string_view(name).substr(name.size() - ending.size()), ending);
}

}  // namespace

Result<ColourMesh> read_colour_mesh(const std::string& name, std::string_view bytes,
                                    const ModelFiles& files, bool with_colours) {
  if (const auto foreign = foreign_kind(bytes);
      !foreign.empty() && (ends_with(name, ".glb") || ends_with(name, ".gltf")))
    return fail(ErrorKind::Malformed, name,
                fmt::format("is {}; give a 3D model as a GLB, glTF, OBJ or STL file", foreign));
  if (ends_with(name, ".glb") || ends_with(name, ".gltf"))
    return read_colour_gltf(name, bytes, files, with_colours);
  // Says what is wrong with a file, and that its counts are sane, before its colours are read.
  const auto plain = read_mesh(name, bytes);
  if (!plain) return tl::unexpected(plain.error());
  if (with_colours && ends_with(name, ".obj")) return read_colour_obj(name, bytes, files);
  ColourMesh mesh;
  mesh.soup.corners.assign(plain->corners.begin(), plain->corners.end());
  make_clay(mesh);
  return mesh;
}

}  // namespace popcut
