// SPDX-License-Identifier: MIT
#include "core/model/gltf_materials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <tiny_gltf.h>

namespace popcut::model_readers {
namespace {

std::string_view text_of(const std::vector<unsigned char>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Reads numbers of an extension; those that it does not have stay as they are.
template <std::size_t N>
void numbers_of(const tinygltf::Value& of, const char* name, std::array<double, N>& out) {
  if (!of.Has(name)) return;
  const tinygltf::Value& list = of.Get(name);
  for (std::size_t k = 0; k < N && k < list.ArrayLen(); ++k)
    if (const tinygltf::Value& number = list.Get(static_cast<int>(k)); number.IsNumber())
      out[k] = number.GetNumberAsDouble();
}

void move_by(const tinygltf::Value& transform, GltfPlaces& places) {
  if (!transform.IsObject()) return;
  numbers_of(transform, "offset", places.offset);
  numbers_of(transform, "scale", places.scale);
  if (transform.Has("rotation"))
    places.rotation_rad = transform.Get("rotation").GetNumberAsDouble();
  if (transform.Has("texCoord")) places.set = transform.Get("texCoord").GetNumberAsInt();
}

ModelColour colour_of(const std::array<double, 4>& light) {
  return {srgb_of_light(light[0]), srgb_of_light(light[1]), srgb_of_light(light[2])};
}

/// @return none for a number that glTF does not define
std::optional<PictureWrap> wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return PictureWrap::Clamp;
  if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return PictureWrap::Mirror;
  return mode == TINYGLTF_TEXTURE_WRAP_REPEAT ? std::optional(PictureWrap::Repeat) : std::nullopt;
}

}  // namespace

float srgb_of_light(double light) {
  light = light > 0 ? std::min(light, 1.0) : 0;  // what is no number is dark
  return static_cast<float>(light <= 0.0031308 ? 12.92 * light
                                               : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

std::array<float, 2> GltfPlaces::moved(double u, double v) const {
  const double c = std::cos(rotation_rad), s = std::sin(rotation_rad);
  const double x = scale[0] * u, y = scale[1] * v;
  return {static_cast<float>(c * x + s * y + offset[0]),
          static_cast<float>(c * y - s * x + offset[1])};
}

tl::unexpected<Error> GltfMaterials::broken(const char* list, int index, const char* what) const {
  return fail(ErrorKind::Malformed, fmt::format("{}: /{}/{}", name_, list, index), what);
}

Result<void> GltfMaterials::read() {
  model_.materials.push_back({ModelColour{1, 1, 1}});
  for (const tinygltf::Material& material : file_.materials)
    if (auto done = add(material); !done) return done;
  return {};
}

GltfMaterials::Texture GltfMaterials::texture_of(const tinygltf::TextureInfo& base) {
  Texture out{base.index, {}};
  out.places.set = base.texCoord;
  if (const auto moved = base.extensions.find("KHR_texture_transform");
      moved != base.extensions.end())
    move_by(moved->second, out.places);
  return out;
}

// What a material gives off itself adds to what it reflects (glTF 2.0, 3.9.3 and appendix B); what
// reflects nothing shows that alone.
void GltfMaterials::add_emission(const tinygltf::Material& material, std::array<double, 4>& light,
                                 Texture& texture) {
  std::array<double, 3> emitted{};
  double strength = 1.0;
  const auto strong = material.extensions.find("KHR_materials_emissive_strength");
  if (strong != material.extensions.end() && strong->second.Has("emissiveStrength"))
    strength = strong->second.Get("emissiveStrength").GetNumberAsDouble();
  for (std::size_t k = 0; k < 3 && k < material.emissiveFactor.size(); ++k)
    emitted[k] = strength * material.emissiveFactor[k];
  const auto lit = [](double value) { return value > 0.0; };
  if (std::none_of(emitted.begin(), emitted.end(), lit)) return;
  const Texture emitted_by = texture_of(material.emissiveTexture);
  const bool black = std::none_of(light.begin(), light.begin() + 3, lit);
  if (black) texture = emitted_by;
  // Two pictures are not added up.
  if (!black && (texture.index >= 0 || emitted_by.index >= 0)) return;
  for (std::size_t k = 0; k < 3; ++k) light[k] += emitted[k];
}

Result<void> GltfMaterials::add(const tinygltf::Material& material) {
  const auto& base = material.pbrMetallicRoughness;
  std::array<double, 4> light{1, 1, 1, 1};
  for (std::size_t k = 0; k < 4 && k < base.baseColorFactor.size(); ++k)
    light[k] = base.baseColorFactor[k];
  Texture texture = texture_of(base.baseColorTexture);
  const auto glossy = material.extensions.find("KHR_materials_pbrSpecularGlossiness");
  if (glossy != material.extensions.end() && glossy->second.IsObject()) {
    light = {1, 1, 1, 1};
    numbers_of(glossy->second, "diffuseFactor", light);
    texture = {};
    if (glossy->second.Has("diffuseTexture")) {
      const tinygltf::Value& diffuse = glossy->second.Get("diffuseTexture");
      if (diffuse.Has("index")) texture.index = diffuse.Get("index").GetNumberAsInt();
      if (diffuse.Has("texCoord")) texture.places.set = diffuse.Get("texCoord").GetNumberAsInt();
      if (diffuse.Has("extensions") && diffuse.Get("extensions").Has("KHR_texture_transform"))
        move_by(diffuse.Get("extensions").Get("KHR_texture_transform"), texture.places);
    }
  }
  add_emission(material, light, texture);
  ModelMaterial made;
  made.colour = colour_of(light);
  // Opaque materials have no alpha (glTF 2.0, 3.9.6).
  made.is_clear = light[3] <= 0.0 && (material.alphaMode == "BLEND" ||
                                      (material.alphaMode == "MASK" && material.alphaCutoff > 0.0));
  if (texture.index >= 0) {
    const auto picture = picture_of(texture.index);
    if (!picture) return tl::unexpected(picture.error());
    made.picture = *picture;
  }
  model_.materials.push_back(made);
  places_.push_back(texture.places);
  return {};
}

Result<std::int32_t> GltfMaterials::picture_of(int index) {
  if (static_cast<std::size_t>(index) >= file_.textures.size())
    return broken("textures", index, "does not exist; repair the model");
  const tinygltf::Texture& texture = file_.textures[static_cast<std::size_t>(index)];
  if (texture.source < 0 || static_cast<std::size_t>(texture.source) >= file_.images.size())
    return broken("textures", index,
                  "has no PNG or JPEG picture; save the model with such pictures");
  ModelPicture picture;
  if (texture.sampler >= 0) {
    const auto sampler = static_cast<std::size_t>(texture.sampler);
    if (sampler >= file_.samplers.size())
      return broken("samplers", texture.sampler, "does not exist; repair the model");
    const auto across = wrap_of(file_.samplers[sampler].wrapS);
    const auto down = wrap_of(file_.samplers[sampler].wrapT);
    if (!across || !down)
      return broken("samplers", texture.sampler,
                    "has a wrapS or wrapT that glTF does not define; use 10497, 33071 or 33648");
    picture.wraps = {*across, *down};
  }
  // Many textures may share an image, which is decoded once.
  const auto known = pictures_.find({texture.source, picture.wraps});
  if (known != pictures_.end()) return known->second;
  const tinygltf::Image& image = file_.images[static_cast<std::size_t>(texture.source)];
  const auto bytes = bytes_of(image);
  if (!bytes)
    return broken("images", texture.source, "reaches beyond its buffer; is the file whole?");
  picture.name = image.uri.empty() ? fmt::format("/images/{}", texture.source) : image.uri;
  const PictureWraps wraps = picture.wraps;
  const auto added = add_picture(model_, options_, name_, std::move(picture), *bytes);
  if (added) pictures_[{texture.source, wraps}] = *added;
  return added;
}

/// The bytes of a picture; none if they do not lie in its buffer. The library has checked that its
/// view and its buffer exist.
std::optional<std::string_view> GltfMaterials::bytes_of(const tinygltf::Image& image) const {
  if (image.bufferView < 0) return text_of(image.image);
  const auto& view = file_.bufferViews[static_cast<std::size_t>(image.bufferView)];
  const auto whole = text_of(file_.buffers[static_cast<std::size_t>(view.buffer)].data);
  if (view.byteOffset > whole.size() || view.byteLength > whole.size() - view.byteOffset)
    return std::nullopt;
  return whole.substr(view.byteOffset, view.byteLength);
}

}  // namespace popcut::model_readers
