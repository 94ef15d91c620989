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
  /// Pixels of a PNG or JPEG; OutOfRange if it has more than `most_pixels`.
  std::function<Result<ColourImage>(const std::string& name, std::string_view bytes,
                                    std::size_t most_pixels)>
      decode;
  /// For errors: what helps where one of them cannot be opened.
  std::string advice{"put it where the line says, or print without colours (--clay)"};
};

/// Reads a model with its colours (`read_model`) and decodes its pictures. A mesh without colours
/// is clay (`ColourMesh::coloured` is false).
///
/// @param name       file name, for its extension and for errors
/// @param with_colours  false: nothing beside `bytes` is opened but the buffers of a .gltf, and all
///                      of it is clay
/// @retval Malformed, OutOfRange  as `read_model`; or a picture cannot be decoded, or all of them
///                                have more than `kMaxPixels`
[[nodiscard]] Result<ColourMesh> read_colour_mesh(const std::string& name, std::string_view bytes,
                                                  const ModelFiles& files,
                                                  bool with_colours = true);

}  // namespace popcut
