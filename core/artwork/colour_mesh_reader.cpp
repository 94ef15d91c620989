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

/// Nothing of a clear triangle is seen. A model that is clear throughout only says it wrongly.
void leave_out_clear(Model& model) {
  const auto is_clear = [&](std::size_t t) {
    return model.materials[model.material_of[t]].is_clear;
  };
  const std::size_t all = model.material_of.size();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < all; ++t) kept += is_clear(t) ? 0 : 1;
  if (kept == 0 || kept == all) return;
  const auto keep = [&](auto& list, std::size_t each) {
    if (list.size() < each * all) return;
    std::size_t to = 0;
    for (std::size_t t = 0; t < all; ++t) {
      if (is_clear(t)) continue;
      for (std::size_t k = 0; k < each; ++k) list[each * to + k] = list[each * t + k];
      ++to;
    }
    list.resize(each * kept);
  };
  keep(model.corners, 9);
  keep(model.picture_places, 3);
  keep(model.corner_colours, 3);
  std::erase_if(model.material_of,
                [&](std::uint32_t material) { return model.materials[material].is_clear; });
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
    mesh.textures[k].wraps = model->pictures[k].wraps;
  leave_out_clear(*model);
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
