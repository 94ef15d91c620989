// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/triangle_mesh.hpp"
#include "core/result.hpp"

namespace popcut {

/// Red, green and blue as sRGB, each from 0 to 1.
using ModelColour = std::array<float, 3>;

/// How triangles are coloured.
struct ModelMaterial {
  std::optional<ModelColour> colour;  ///< none: the file does not say
  std::int32_t picture{-1};  ///< multiplies the colour: an index of `Model::pictures`, or none
  bool is_clear{false};      ///< nothing of it is seen
};

/// How a picture goes on beyond its borders.
enum class PictureWrap : std::uint8_t { Repeat, Mirror, Clamp };
using PictureWraps = std::array<PictureWrap, 2>;

/// A picture that materials use; `ModelOptions::take_picture` gets its bytes.
struct ModelPicture {
  std::string name;      ///< as the model names it
  PictureWraps wraps{};  ///< beyond its borders, across and down
};

/// A 3D model: the triangles of all its parts, in units and axes of the file. All coordinates are
/// finite. Lists of colours are empty where the file has none, or where none were asked for.
struct Model {
  std::vector<double> corners;                       ///< nine a triangle: x y z of three corners
  std::vector<std::array<float, 2>> picture_places;  ///< three a triangle, from the top left, down
  std::vector<ModelColour> corner_colours;           ///< three a triangle; multiply the material's
  std::vector<std::uint32_t> material_of;            ///< one a triangle
  std::vector<ModelMaterial> materials;  ///< the first is that of triangles without a material
  std::vector<ModelPicture> pictures;
  bool uses_materials{false};       ///< a triangle has a material of the file
  std::array<double, 3> moved{};    ///< what was added to x y z of a model far from its origin
  std::size_t corners_left_over{};  ///< of lists of corners, what makes no whole triangle

  [[nodiscard]] std::size_t size() const { return corners.size() / 9; }
};

/// What to read of a model, and from where.
struct ModelOptions {
  bool colours{false};  ///< materials, pictures and colours too
  /// Contents of a file by the name that the model gives it, beside the model. Empty: the model
  /// must be one file.
  std::function<Result<std::string>(const std::string& name)> open{};
  /// Takes the bytes of a picture, a PNG or JPEG. Called once for each of `Model::pictures`, in
  /// their order; its error ends the reading. Empty: nobody wants them.
  std::function<Result<void>(const std::string& name, std::string_view bytes)> take_picture{};
  /// For errors: what helps where one of those files cannot be read.
  std::string advice{"put it beside the model"};
};

/// Reads an STL (text or binary), OBJ or glTF 2.0 file (.glb, .gltf); polygons are cut into
/// triangles, and the nodes of a glTF scene are put together. Points and lines are left out. A
/// model that lies more than 100 times its size from the origin is moved there.
///
/// Colours: of an OBJ the materials of its MTL files (Kd, map_Kd), or colours after the vertices;
/// of a glTF base colours, their textures and COLOR_0. An STL has none.
///
/// Counts are checked against the bytes that are there before memory is taken.
///
/// @param name  file name, for its extension (without one the bytes tell) and for errors
/// @retval Malformed   none of these formats (the text says what else it is, if that can be told);
///                     broken, cut off or without faces; or a file that it names cannot be
///                     read
/// @retval OutOfRange  more than `kMaxTriangles`, or a coordinate that is not a finite number
[[nodiscard]] Result<Model> read_model(const std::string& name, std::string_view bytes,
                                       const ModelOptions& options = {});

/// The triangles of a model that is one file; see `read_model`.
///
/// @param notes  gets what was done to it
[[nodiscard]] Result<TriangleMesh> read_mesh(const std::string& name, std::string_view bytes,
                                             std::vector<std::string>* notes = nullptr);

}  // namespace popcut
