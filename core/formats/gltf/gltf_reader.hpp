// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <tiny_gltf.h>

#include "core/geometry/vec.hpp"
#include "core/result.hpp"

namespace popcut {

/// Contents of a file by the name that a model gives it, beside the model.
using OpenBeside = std::function<Result<std::string>(const std::string& name)>;

/// Reads a glTF 2.0 file (.glb or .gltf, by its bytes). Pictures stay as they are in the file.
///
/// @param name  of the file, for errors
/// @param open  called for each file that the model names and that is not in it
/// @retval Malformed   no glTF, broken, or a buffer that it names cannot be opened
/// @retval OutOfRange  larger than 2 GB
[[nodiscard]] Result<tinygltf::Model> read_gltf(const std::string& name, std::string_view bytes,
                                                const OpenBeside& open);

/// Numbers of an accessor, checked against the bytes that are there.
class GltfNumbers {
 public:
  /// @param least_parts  numbers that each value has at least
  /// @retval Malformed  it is not there, compressed, or holds less than it announces
  [[nodiscard]] static Result<GltfNumbers> of(const tinygltf::Model& model, int accessor,
                                              std::size_t least_parts, const std::string& name);
  [[nodiscard]] std::size_t size() const { return count_; }
  /// Whole numbers that stand for 0 to 1 are given as that.
  [[nodiscard]] double get(std::size_t i, std::size_t part) const;

 private:
  const unsigned char* at_{};
  std::size_t count_{}, step_{};
  int type_{};
  bool normalized_{};
};

/// Triangles of a scene that have one material.
class GltfPart {
 public:
  const tinygltf::Primitive& primitive;

  /// Of three for each triangle.
  [[nodiscard]] std::size_t corners() const { return count_; }
  /// The vertex of a corner, for its other attributes.
  ///
  /// @retval Malformed  the vertices have no such one
  [[nodiscard]] Result<std::size_t> vertex(std::size_t corner) const;
  /// Where a vertex stands in the scene.
  ///
  /// @retval OutOfRange  it is not finite
  [[nodiscard]] Result<Vec3> place(std::size_t vertex) const;

 private:
  friend class GltfScene;
  GltfPart(const tinygltf::Primitive& of, const std::string& name, GltfNumbers places)
      : primitive(of), name_(name), places_(places) {}
  const std::string& name_;
  GltfNumbers places_;
  std::optional<GltfNumbers> indices_;
  Eigen::Matrix4d placed_;
  std::size_t count_{};
};

/// Visits all triangles of the model's usual scene, its nodes put together; points and lines have
/// no surface and are left out.
///
/// @param most  triangles
/// @retval Malformed   something that a node names is not there, or a node lies in itself
/// @retval OutOfRange  more triangles than `most`
/// Errors of `visit` end it.
[[nodiscard]] Result<void> for_each_part(const tinygltf::Model& model, const std::string& name,
                                         std::size_t most,
                                         const std::function<Result<void>(const GltfPart&)>& visit);

}  // namespace popcut
