// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/design/target/triangle_mesh.hpp"
#include "core/formats/gltf/gltf_reader.hpp"

namespace popcut {
namespace {

/// Light from 0 to 1 as sRGB from 0 to 1 (IEC 61966-2-1).
float srgb(double light) {
  light = light > 0 ? std::min(light, 1.0) : 0;  // what is no number is dark
  return static_cast<float>(light <= 0.0031308 ? 12.92 * light
                                               : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

class GltfColours {
 public:
  GltfColours(const std::string& name, const ModelFiles& files, const tinygltf::Model& model,
              bool with_colours)
      : name_(name), files_(files), model_(model), with_colours_(with_colours) {}

  Result<ColourMesh> read() {
    if (auto done = add_materials(); !done) return tl::unexpected(done.error());
    if (auto done = for_each_part(model_, name_, kMaxTriangles,
                                  [&](const GltfPart& part) { return add_part(part); });
        !done)
      return tl::unexpected(done.error());
    if (mesh_.size() == 0)
      return fail(ErrorKind::Malformed, name_, "has no triangles; a model needs some");
    if (!any_tint_) mesh_.tint.clear();
    mesh_.coloured = any_tint_ || any_material_;
    if (!mesh_.coloured) make_clay(mesh_);
    return std::move(mesh_);
  }

 private:
  Result<void> add_materials() {
    mesh_.surfacings.emplace_back();  // of primitives without a material
    if (!with_colours_) return {};
    for (const tinygltf::Material& material : model_.materials) {
      Surfacing how;
      const auto& base = material.pbrMetallicRoughness;
      if (base.baseColorFactor.size() >= 3)
        how.colour = {255 * srgb(base.baseColorFactor[0]), 255 * srgb(base.baseColorFactor[1]),
                      255 * srgb(base.baseColorFactor[2]), 255};
      if (base.baseColorTexture.index >= 0) {
        const auto texture = texture_of(base.baseColorTexture.index);
        if (!texture) return tl::unexpected(texture.error());
        how.texture = *texture;
      }
      mesh_.surfacings.push_back(how);
      sets_.push_back(base.baseColorTexture.texCoord);
    }
    return {};
  }

  Result<std::int32_t> texture_of(int index) {
    const std::string place = fmt::format("{}: /textures/{}", name_, index);
    if (const auto known = textures_.find(index); known != textures_.end()) return known->second;
    if (static_cast<std::size_t>(index) >= model_.textures.size())
      return fail(ErrorKind::Malformed, place, "is not there; repair the model");
    const tinygltf::Texture& texture = model_.textures[static_cast<std::size_t>(index)];
    if (texture.source < 0 || static_cast<std::size_t>(texture.source) >= model_.images.size())
      return fail(ErrorKind::Malformed, place,
                  "has no PNG or JPEG picture; save the model with such pictures");
    const tinygltf::Image& image = model_.images[static_cast<std::size_t>(texture.source)];
    const std::string_view bytes(reinterpret_cast<const char*>(image.image.data()),
                                 image.image.size());
    auto pixels = files_.decode(
        image.uri.empty() ? fmt::format("/images/{}", texture.source) : image.uri, bytes);
    if (!pixels) return tl::unexpected(within(name_, pixels.error()));
    const auto at = static_cast<std::int32_t>(mesh_.textures.size());
    mesh_.textures.emplace_back(std::move(*pixels));
    if (texture.sampler >= 0 && static_cast<std::size_t>(texture.sampler) < model_.samplers.size())
      mesh_.textures.back().repeats =
          model_.samplers[static_cast<std::size_t>(texture.sampler)].wrapS !=
          TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    textures_[index] = at;
    return at;
  }

  [[nodiscard]] tl::unexpected<Error> not_there(const char* list, int index) const {
    return fail(ErrorKind::Malformed, fmt::format("{}: /{}/{}", name_, list, index),
                "is not there; repair the model");
  }

  Result<void> add_part(const GltfPart& part) {
    const tinygltf::Primitive& of = part.primitive;
    std::optional<GltfNumbers> st, tint;
    const bool has_material = with_colours_ && of.material >= 0;
    if (has_material && static_cast<std::size_t>(of.material) >= model_.materials.size())
      return not_there("materials", of.material);
    const std::size_t material = has_material ? static_cast<std::size_t>(of.material) : 0;
    if (has_material) {
      const auto found = of.attributes.find(fmt::format("TEXCOORD_{}", sets_[material]));
      if (found != of.attributes.end())
        if (auto done = take(found->second, 2, st); !done) return done;
      any_material_ = true;
    }
    if (const auto found = of.attributes.find("COLOR_0");
        with_colours_ && found != of.attributes.end()) {
      if (auto done = take(found->second, 3, tint); !done) return done;
      any_tint_ = true;
    }
    for (std::size_t k = 0; k < part.corners(); ++k) {
      const auto vertex = part.vertex(k);
      if (!vertex) return tl::unexpected(vertex.error());
      const auto at = part.place(*vertex);
      if (!at) return tl::unexpected(at.error());
      const std::size_t i = *vertex;
      mesh_.soup.corners.insert(mesh_.soup.corners.end(), at->data(), at->data() + 3);
      std::array<float, 2> where{};
      if (st && i < st->size())
        where = {static_cast<float>(st->get(i, 0)), static_cast<float>(st->get(i, 1))};
      mesh_.st.push_back(where);
      std::array<float, 3> tinted{1, 1, 1};
      if (tint && i < tint->size())
        tinted = {srgb(tint->get(i, 0)), srgb(tint->get(i, 1)), srgb(tint->get(i, 2))};
      mesh_.tint.push_back(tinted);
      if (k % 3 == 2)
        mesh_.surfacing_of.push_back(has_material ? static_cast<std::uint32_t>(material + 1) : 0);
    }
    return {};
  }

  Result<void> take(int accessor, std::size_t least_parts, std::optional<GltfNumbers>& out) const {
    const auto numbers = GltfNumbers::of(model_, accessor, least_parts, name_);
    if (!numbers) return tl::unexpected(numbers.error());
    out = *numbers;
    return {};
  }

  const std::string& name_;
  const ModelFiles& files_;
  const tinygltf::Model& model_;
  bool with_colours_;
  ColourMesh mesh_;
  std::vector<int> sets_;  ///< of each material: which TEXCOORD its texture takes
  std::map<int, std::int32_t> textures_;
  bool any_tint_{false}, any_material_{false};
};

}  // namespace

Result<ColourMesh> read_colour_gltf(const std::string& name, std::string_view bytes,
                                    const ModelFiles& files, bool with_colours) {
  const auto model = read_gltf(name, bytes, files.open);
  if (!model) return tl::unexpected(model.error());
  return GltfColours(name, files, *model, with_colours).read();
}

}  // namespace popcut
