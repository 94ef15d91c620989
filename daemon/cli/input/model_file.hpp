// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// Is it a 3D model, by its name (.stl, .obj, .glb, .gltf)?
[[nodiscard]] bool is_model_file(const std::filesystem::path& file);

/// Reads a file that a design names. A .gltf gets the buffers that lie beside it put into it, so
/// that whoever reads it needs no other file; its pictures stay where they are.
///
/// @retval Malformed   it cannot be read, or one of its buffers
/// @retval OutOfRange  larger than files may be
[[nodiscard]] Result<std::string> read_model_file(const std::filesystem::path& file);

/// A model in its colours; clay where they cannot be read. None: it is no model.
[[nodiscard]] std::optional<ColourMesh> model_in_colours(const std::filesystem::path& file,
                                                         const std::string& bytes);

/// The pictures and materials that lie beside a model.
[[nodiscard]] ModelFiles files_beside(const std::filesystem::path& model);

}  // namespace popcut::cli
