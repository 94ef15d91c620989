// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/design/target/triangle_mesh.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {
namespace {

/// Light from 0 to 1 as sRGB from 0 to 1 (IEC 61966-2-1).
float srgb(double light) {
  light = light > 0 ? std::min(light, 1.0) : 0;  // what is no number is dark
  return static_cast<float>(light <= 0.0031308 ? 12.92 * light
                                               : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

// The library hands over pictures as they are in the file; they are decoded when one is used.
bool keep_picture(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

// What the library asks of a disk goes to the files beside the model.
bool is_there(const std::string&, void*) { return true; }
std::string as_named(const std::string& name, void*) { return name; }
bool read_beside(std::vector<unsigned char>* out, std::string* error, const std::string& name,
                 void* user) {
  // The library puts "./" or a folder of its own before a name; the model's folder has none.
  std::string plain = name;
  while (plain.rfind("./", 0) == 0) plain.erase(0, 2);
  const auto bytes = static_cast<const ModelFiles*>(user)->open(plain);
  if (!bytes) {
    *error += plain + " cannot be read; ";
    return false;
  }
  out->assign(bytes->begin(), bytes->end());
  return true;
}
bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

/// Numbers of an accessor, checked against the bytes that are there.
class Numbers {
 public:
  static Result<Numbers> of(const tinygltf::Model& model, int index, const std::string& name) {
    const std::string place = fmt::format("{}: /accessors/{}", name, index);
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
      return fail(ErrorKind::Malformed, place, "is not there; repair the model");
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (accessor.sparse.isSparse || accessor.bufferView < 0)
      return fail(ErrorKind::Malformed, place,
                  "is sparse or compressed; save the model without compression");
    if (static_cast<std::size_t>(accessor.bufferView) >= model.bufferViews.size())
      return fail(ErrorKind::Malformed, place, "has no view that is there; repair the model");
    const tinygltf::BufferView& view =
        model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
      return fail(ErrorKind::Malformed, place, "has no buffer that is there; repair the model");
    const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    const int stride = accessor.ByteStride(view);
    const int parts = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    const int bytes =
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    if (stride <= 0 || parts <= 0 || bytes <= 0)
      return fail(ErrorKind::Malformed, place, "has a type that glTF has not; repair the model");
    const std::size_t each = static_cast<std::size_t>(parts) * static_cast<std::size_t>(bytes);
    const std::size_t step = static_cast<std::size_t>(stride);
    const bool begins =
        view.byteOffset <= data.size() && accessor.byteOffset <= data.size() - view.byteOffset;
    const std::size_t room =
        begins ? data.size() - view.byteOffset - accessor.byteOffset : std::size_t{0};
    if (accessor.count > 0 && (room < each || (accessor.count - 1) > (room - each) / step))
      return fail(ErrorKind::Malformed, place,
                  fmt::format("announces {} values, more than its buffer holds; is the file whole?",
                              accessor.count));
    Numbers out;
    out.at_ = data.data() + view.byteOffset + accessor.byteOffset;
    out.count_ = accessor.count, out.step_ = step;
    out.parts_ = static_cast<std::size_t>(parts), out.type_ = accessor.componentType;
    out.normalized_ = accessor.normalized;
    return out;
  }

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::size_t parts() const { return parts_; }
  [[nodiscard]] double get(std::size_t i, std::size_t part) const {
    const unsigned char* p = at_ + i * step_;
    switch (type_) {
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return static_cast<double>(value<float>(p, part));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return static_cast<double>(value<std::uint32_t>(p, part));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return static_cast<double>(value<std::uint16_t>(p, part)) / (normalized_ ? 65535.0 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return static_cast<double>(value<std::uint8_t>(p, part)) / (normalized_ ? 255.0 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return static_cast<double>(value<std::int16_t>(p, part)) / (normalized_ ? 32767.0 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return static_cast<double>(value<std::int8_t>(p, part)) / (normalized_ ? 127.0 : 1.0);
      default:
        return 0;
    }
  }

 private:
  template <typename T>
  static T value(const unsigned char* p, std::size_t part) {
    T out;
    std::memcpy(&out, p + part * sizeof(T), sizeof(T));
    return out;
  }
  const unsigned char* at_{};
  std::size_t count_{}, step_{}, parts_{};
  int type_{};
  bool normalized_{};
};

using Matrix = Eigen::Matrix4d;

Matrix matrix_of(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Map<const Matrix>(node.matrix.data());
  Matrix turn = Matrix::Identity(), scale = Matrix::Identity(), move = Matrix::Identity();
  if (node.rotation.size() == 4)
    turn.topLeftCorner<3, 3>() =
        Eigen::Quaterniond(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])
            .normalized()
            .toRotationMatrix();
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (node.scale.size() == 3) scale(k, k) = node.scale[i];
    if (node.translation.size() == 3) move(k, 3) = node.translation[i];
  }
  return move * turn * scale;
}

class GltfColours {
 public:
  GltfColours(const std::string& name, const ModelFiles& files, const tinygltf::Model& model,
              bool with_colours)
      : name_(name), files_(files), model_(model), with_colours_(with_colours) {}

  Result<ColourMesh> read() {
    if (auto done = add_materials(); !done) return tl::unexpected(done.error());
    std::vector<int> roots;
    const int scene = model_.defaultScene >= 0 ? model_.defaultScene : 0;
    if (static_cast<std::size_t>(scene) < model_.scenes.size())
      roots = model_.scenes[static_cast<std::size_t>(scene)].nodes;
    for (const int root : roots)
      if (auto done = add_node(root, Matrix::Identity(), 0); !done)
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

  Result<void> add_node(int index, const Matrix& above, int depth) {
    constexpr int kDeepest = 256;  // a tree this deep goes round in a circle
    if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size() || depth > kDeepest)
      return fail(ErrorKind::Malformed, fmt::format("{}: /nodes/{}", name_, index),
                  "is not there, or lies in itself; repair the model");
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const Matrix here = above * matrix_of(node);
    if (node.mesh >= 0 && static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
      return not_there("meshes", node.mesh);
    if (node.mesh >= 0)
      for (const tinygltf::Primitive& part :
           model_.meshes[static_cast<std::size_t>(node.mesh)].primitives)
        if (auto done = add_part(part, here); !done) return done;
    for (const int child : node.children)
      if (auto done = add_node(child, here, depth + 1); !done) return done;
    return {};
  }

  [[nodiscard]] tl::unexpected<Error> not_there(const char* list, int index) const {
    return fail(ErrorKind::Malformed, fmt::format("{}: /{}/{}", name_, list, index),
                "is not there; repair the model");
  }

  Result<void> add_part(const tinygltf::Primitive& part, const Matrix& here) {
    const int mode = part.mode < 0 ? TINYGLTF_MODE_TRIANGLES : part.mode;
    if (mode != TINYGLTF_MODE_TRIANGLES) return {};  // points and lines have no surface
    const auto position = part.attributes.find("POSITION");
    if (position == part.attributes.end()) return {};
    auto places = Numbers::of(model_, position->second, name_);
    if (!places) return tl::unexpected(places.error());
    if (places->parts() != 3)
      return fail(ErrorKind::Malformed, fmt::format("{}: /accessors/{}", name_, position->second),
                  "has places without three coordinates; repair the model");
    std::optional<Numbers> indices, st, tint;
    if (part.indices >= 0)
      if (auto done = take(part.indices, 1, indices); !done) return done;
    const bool has_material = with_colours_ && part.material >= 0;
    if (has_material && static_cast<std::size_t>(part.material) >= model_.materials.size())
      return not_there("materials", part.material);
    const std::size_t material = has_material ? static_cast<std::size_t>(part.material) : 0;
    if (has_material) {
      const auto found = part.attributes.find(fmt::format("TEXCOORD_{}", sets_[material]));
      if (found != part.attributes.end())
        if (auto done = take(found->second, 2, st); !done) return done;
      any_material_ = true;
    }
    if (const auto found = part.attributes.find("COLOR_0");
        with_colours_ && found != part.attributes.end()) {
      if (auto done = take(found->second, 3, tint); !done) return done;
      any_tint_ = true;
    }
    const std::size_t corners = indices ? indices->size() : places->size();
    if (corners / 3 + mesh_.size() > kMaxTriangles)
      return fail(ErrorKind::OutOfRange, name_,
                  fmt::format("has more than {} triangles; reduce the mesh", kMaxTriangles));
    for (std::size_t k = 0; k < corners / 3 * 3; ++k) {
      const auto i = indices ? static_cast<std::size_t>(indices->get(k, 0)) : k;
      if (i >= places->size())
        return fail(
            ErrorKind::Malformed, name_,
            fmt::format("a triangle names vertex {} of {}; repair the model", i, places->size()));
      const Eigen::Vector4d at =
          here * Eigen::Vector4d(places->get(i, 0), places->get(i, 1), places->get(i, 2), 1);
      if (!at.allFinite())
        return fail(ErrorKind::OutOfRange, name_,
                    "has a corner that is not a finite number; repair the mesh");
      mesh_.soup.corners.insert(mesh_.soup.corners.end(), at.data(), at.data() + 3);
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

  Result<void> take(int accessor, std::size_t least_parts, std::optional<Numbers>& out) const {
    auto numbers = Numbers::of(model_, accessor, name_);
    if (!numbers) return tl::unexpected(numbers.error());
    if (numbers->parts() < least_parts)
      return fail(ErrorKind::Malformed, fmt::format("{}: /accessors/{}", name_, accessor),
                  fmt::format("has values of {} numbers, where {} are needed; repair the model",
                              numbers->parts(), least_parts));
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
  if (bytes.size() > std::numeric_limits<unsigned>::max() / 2)
    return fail(ErrorKind::OutOfRange, name, "is larger than 2 GB; reduce the model");
  tinygltf::TinyGLTF reader;
  reader.SetImageLoader(keep_picture, nullptr);
  reader.SetFsCallbacks({is_there, as_named, read_beside, write_nothing,
                         const_cast<ModelFiles*>(&files)});  // it is only read
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  const bool binary = bytes.substr(0, 4) == "glTF";
  const bool read =
      binary
          ? reader.LoadBinaryFromMemory(&model, &error, &warning,
                                        reinterpret_cast<const unsigned char*>(bytes.data()), size)
          : reader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, "");
  if (!read) {
    for (char& c : error)
      if (c == '\n') c = ' ';
    while (!error.empty() && std::string_view(" .;").find(error.back()) != std::string_view::npos)
      error.pop_back();
    return fail(ErrorKind::Malformed, name,
                fmt::format("is no glTF that can be read{}{}; save the model again",
                            error.empty() ? "" : ": ", error.substr(0, 200)));
  }
  return GltfColours(name, files, model, with_colours).read();
}

}  // namespace popcut
