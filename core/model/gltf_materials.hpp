// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/model_readers.hpp"

namespace tinygltf {
struct Image;
struct Material;
struct TextureInfo;
class Model;
class Value;
}  // namespace tinygltf

namespace popcut::model_readers {

/// Where the texture of a material finds its places: a set of them, and how they are moved.
struct GltfPlaces {
  int set{};  ///< TEXCOORD_n
  /// KHR_texture_transform: a place is scaled, turned, then moved.
  std::array<double, 2> scale{1, 1}, offset{0, 0};
  double rotation_rad{};

  [[nodiscard]] std::array<float, 2> moved(double u, double v) const;
};

/// Light from 0 to 1 as sRGB from 0 to 1 (IEC 61966-2-1).
[[nodiscard]] float srgb_of_light(double light);

/// Reads the materials of a glTF file: base colours and their textures, or the diffuse ones of
/// KHR_materials_pbrSpecularGlossiness, and what materials give off themselves.
class GltfMaterials {
 public:
  /// @param model  gets materials and pictures; the first material is that of triangles without one
  GltfMaterials(const std::string& name, const tinygltf::Model& file, const ModelOptions& options,
                Model& model)
      : name_(name), file_(file), options_(options), model_(model) {}

  /// @retval Malformed  a texture or a picture that does not exist, or reaches beyond its buffer
  [[nodiscard]] Result<void> read();

  /// Where the texture of a material of the file finds its places.
  [[nodiscard]] const GltfPlaces& places(std::size_t material) const { return places_[material]; }

 private:
  struct Texture {
    int index{-1};
    GltfPlaces places;
  };
  [[nodiscard]] static Texture texture_of(const tinygltf::TextureInfo& base);
  static void add_emission(const tinygltf::Material& material, std::array<double, 4>& light,
                           Texture& texture);
  [[nodiscard]] Result<void> add(const tinygltf::Material& material);
  [[nodiscard]] Result<std::int32_t> picture_of(int texture);
  [[nodiscard]] std::optional<std::string_view> bytes_of(const tinygltf::Image& image) const;
  [[nodiscard]] tl::unexpected<Error> broken(const char* list, int index, const char* what) const;

  const std::string& name_;
  const tinygltf::Model& file_;
  const ModelOptions& options_;
  Model& model_;
  std::vector<GltfPlaces> places_;
  std::map<std::pair<int, PictureWraps>, std::int32_t> pictures_;  ///< by image
};

}  // namespace popcut::model_readers
