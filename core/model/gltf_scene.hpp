// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/model/model_readers.hpp"

namespace tinygltf {
class Model;
}

namespace popcut::model_readers {

/// Puts the nodes of the scene of a glTF file together (Khronos, glTF 2.0 Specification, 3.5
/// to 3.7): triangles, strips and fans; skins, and the default weights of morph targets; instances
/// (EXT_mesh_gpu_instancing); nodes that are not to be seen are left out (KHR_node_visibility).
/// Points and lines are left out.
///
/// @param name  of the file, for errors
/// @retval Malformed   see `read_model`
/// @retval OutOfRange  more than `kMaxTriangles`, more than 250,000 parts, or a corner that is
/// not a finite number
[[nodiscard]] Result<Model> read_gltf_scene(const std::string& name, const tinygltf::Model& file,
                                            const ModelOptions& options);

}  // namespace popcut::model_readers
