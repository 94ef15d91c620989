// SPDX-License-Identifier: MIT
#include "core/artwork/colour_mesh_reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/artwork/colour_image.hpp"
#include "core/model/model.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

bool ends_with(const std::string& name, std::string_view ending) {
  return name.size() >= ending.size() &&
         same_word(std::string_view(name).substr(name.size() - ending.size()), ending);
}

/// Whether a model of this name can have colours, and files beside it.
bool can_have_colours(const std::string& name) {
  constexpr std::array<std::string_view, 3> kEndings{".obj", ".glb", ".gltf"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](std::string_view ending) { return ends_with(name, ending); });
}

/// @param otherwise  the colour where the file gives none
Surfacing surfacing_of(const ModelMaterial& material, const Colour& otherwise) {
  if (!material.colour) return {otherwise, material.picture};
  const auto& [r, g, b] = *material.colour;
  return {{255 * r, 255 * g, 255 * b, 255}, material.picture};
}

}  // namespace

Result<ColourMesh> read_colour_mesh(const std::string& name, std::string_view bytes,
                                    const ModelFiles& files, bool with_colours) {
  ColourMesh mesh;
  std::size_t left = kMaxPixels;
  const auto decode = [&](const std::string& picture, std::string_view its_bytes) -> Result<void> {
    auto image = files.decode(picture, its_bytes, left);
    if (!image && image.error().kind == ErrorKind::OutOfRange && left < kMaxPixels)
      image.error().detail += "; all pictures of a model count together";
    if (!image) return tl::unexpected(image.error());
    left -= std::min(left, image->width * image->height);
    mesh.textures.emplace_back(std::move(*image));
    return {};
  };
  ModelOptions options;
  if (can_have_colours(name)) options = {with_colours, files.open, decode, files.advice};
  auto model = read_model(name, bytes, options);
  if (!model) return tl::unexpected(model.error());
  for (std::size_t k = 0; k < mesh.textures.size(); ++k)
    mesh.textures[k].repeats = model->pictures[k].repeats;
  mesh.soup.corners = std::move(model->corners);
  mesh.coloured = model->uses_materials || !model->corner_colours.empty();
  if (!mesh.coloured) {
    make_clay(mesh);
    return mesh;
  }
  mesh.st = std::move(model->picture_places);
  mesh.tint = std::move(model->corner_colours);
  mesh.surfacing_of = std::move(model->material_of);
  // Clay beside painted parts; where vertices have colours, those alone.
  const Colour without = model->uses_materials ? kClay : Colour{};
  for (const ModelMaterial& material : model->materials)
    mesh.surfacings.push_back(surfacing_of(material, without));
  return mesh;
}

}  // namespace popcut
