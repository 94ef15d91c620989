// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/artwork/colour_image.hpp"
#include "core/artwork/colour_mesh.hpp"
#include "core/result.hpp"

namespace popcut {

/// What reading a model needs from outside: the files that it names, and who knows their formats.
struct ModelFiles {
  /// Contents of a file by the name that the model gives it, beside the model.
  std::function<Result<std::string>(const std::string& name)> open;
  /// Pixels of a PNG or JPEG.
  std::function<Result<ColourImage>(const std::string& name, std::string_view bytes)> decode;
  /// For errors: what helps where one of them cannot be opened.
  std::string advice{"put it where the line says, or print without colours (--clay)"};
};

/// Reads a model with its colours, in units and axes of the file: OBJ with the materials of its MTL
/// (Kd, map_Kd) or colours after the vertices; glTF 2.0 (.glb, .gltf) with base colours, their
/// textures and COLOR_0, its nodes put together; STL, which has none. A mesh without colours is
/// clay (`ColourMesh::coloured` is false).
///
/// @param name       file name, for its extension and for errors
/// @param with_colours  false: nothing beside `bytes` is opened, and all of it is clay
/// @retval Malformed   not such a file, broken, or one that it names cannot be read; what it uses
///                     of glTF is not supported (compressed meshes)
/// @retval OutOfRange  too many triangles, or a coordinate that is not a finite number
[[nodiscard]] Result<ColourMesh> read_colour_mesh(const std::string& name, std::string_view bytes,
                                                  const ModelFiles& files,
                                                  bool with_colours = true);

/// The two formats with colours; see `read_colour_mesh`.
[[nodiscard]] Result<ColourMesh> read_colour_obj(const std::string& name, std::string_view bytes,
                                                 const ModelFiles& files);
[[nodiscard]] Result<ColourMesh> read_colour_gltf(const std::string& name, std::string_view bytes,
                                                  const ModelFiles& files, bool with_colours);

}  // namespace popcut
