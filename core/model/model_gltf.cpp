// SPDX-License-Identifier: MIT
// Meshes of glTF 2.0 files (Khronos, glTF 2.0 Specification, 2021). tinygltf parses the JSON.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/geometry/vec.hpp"
#include "core/model/model_readers.hpp"

namespace popcut::model_readers {
namespace {

using Matrix = Eigen::Matrix4d;

// ---- parsing

// The library hands over pictures as they are in the file. It does not check that those in a buffer
// lie within it, so `SceneReader` reads these.
bool keep_picture(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

/// Opens the files beside a model, where it may have some.
struct Beside {
  const ModelOptions& options;
  std::string missing;  ///< the first file that was asked for where none may be
};

// What the library asks of a disk goes to the files beside the model.
bool is_there(const std::string&, void*) { return true; }
std::string as_named(const std::string& name, void*) { return name; }
bool read_beside(std::vector<unsigned char>* out, std::string* error, const std::string& name,
                 void* user) {
  auto& beside = *static_cast<Beside*>(user);
  // The library puts "./" or a folder of its own before a name; the model's folder has none.
  std::string plain = name;
  while (plain.starts_with("./")) plain.erase(0, 2);
  if (!beside.options.open) {
    if (beside.missing.empty()) beside.missing = plain;
    return false;
  }
  const auto bytes = beside.options.open(plain);
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

Result<tinygltf::Model> parsed(const std::string& name, std::string_view bytes,
                               const ModelOptions& options) {
  if (bytes.size() > std::numeric_limits<unsigned>::max() / 2)
    return fail(ErrorKind::OutOfRange, name, "is larger than 2 GB; reduce the model");
  Beside beside{options, {}};
  tinygltf::TinyGLTF reader;
  reader.SetImageLoader(keep_picture, nullptr);
  reader.SetFsCallbacks({is_there, as_named, read_beside, write_nothing, &beside});
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  const bool read =
      bytes.starts_with("glTF")
          ? reader.LoadBinaryFromMemory(&model, &error, &warning,
                                        reinterpret_cast<const unsigned char*>(bytes.data()), size)
          : reader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, "");
  if (read) return model;
  if (!beside.missing.empty())
    return fail(ErrorKind::Malformed, name,
                fmt::format("keeps its mesh in {} beside it; save the model as one file (.glb)",
                            beside.missing));
  std::replace(error.begin(), error.end(), '\n', ' ');
  while (!error.empty() && std::string_view(" .;").find(error.back()) != std::string_view::npos)
    error.pop_back();
  return fail(ErrorKind::Malformed, name,
              fmt::format("cannot be read as glTF{}{}; save the model again",
                          error.empty() ? "" : ": ", error.substr(0, 200)));
}

// ---- numbers

template <typename T>
double value_at(const unsigned char* p, std::size_t part) {
  T out;
  std::memcpy(&out, p + part * sizeof(T), sizeof(T));
  return static_cast<double>(out);
}

/// The numbers of an accessor, checked against the bytes that are there.
class Numbers {
 public:
  /// @param least_parts  numbers that each value has at least
  /// @retval Malformed  it does not exist, is compressed, or holds less than it announces
  static Result<Numbers> of(const tinygltf::Model& model, int index, std::size_t least_parts,
                            const std::string& name) {
    const std::string place = fmt::format("{}: /accessors/{}", name, index);
    const auto broken = [&](std::string what) {
      return fail(ErrorKind::Malformed, place, what + "; repair the model");
    };
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
      return broken("does not exist");
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (accessor.sparse.isSparse || accessor.bufferView < 0)
      return fail(ErrorKind::Malformed, place,
                  "is sparse or compressed; save the model without compression");
    if (static_cast<std::size_t>(accessor.bufferView) >= model.bufferViews.size())
      return broken("refers to a buffer view that does not exist");
    const auto& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
      return broken("refers to a buffer that does not exist");
    const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    const int stride = accessor.ByteStride(view);
    const int parts = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    const int bytes =
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    if (stride <= 0 || parts <= 0 || bytes <= 0)
      return broken("has a component type that glTF does not define");
    if (static_cast<std::size_t>(parts) < least_parts)
      return broken(
          fmt::format("has values of {} numbers, where {} are needed", parts, least_parts));
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
    if (begins) out.at_ = data.data() + view.byteOffset + accessor.byteOffset;
    out.count_ = accessor.count, out.step_ = step;
    out.type_ = accessor.componentType, out.normalized_ = accessor.normalized;
    return out;
  }

  [[nodiscard]] std::size_t size() const { return count_; }

  /// Whole numbers that stand for -1 to 1 are given as that.
  [[nodiscard]] double get(std::size_t i, std::size_t part) const {
    const unsigned char* const p = at_ + i * step_;
    const auto share = [this](double value, double most) {
      return normalized_ ? value / most : value;
    };
    switch (type_) {
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return value_at<float>(p, part);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return value_at<std::uint32_t>(p, part);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return share(value_at<std::uint16_t>(p, part), 65535.0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return share(value_at<std::uint8_t>(p, part), 255.0);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return share(value_at<std::int16_t>(p, part), 32767.0);
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return share(value_at<std::int8_t>(p, part), 127.0);
      default:
        return 0;
    }
  }

 private:
  const unsigned char* at_{};
  std::size_t count_{}, step_{};
  int type_{};
  bool normalized_{};
};

// ---- the scene

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

/// Light from 0 to 1 as sRGB from 0 to 1 (IEC 61966-2-1).
float srgb(double light) {
  light = light > 0 ? std::min(light, 1.0) : 0;  // what is no number is dark
  return static_cast<float>(light <= 0.0031308 ? 12.92 * light
                                               : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

/// Puts the nodes of a scene together: first its materials, if colours are asked for, then its
/// triangles.
class SceneReader {
 public:
  SceneReader(const std::string& name, const tinygltf::Model& file, const ModelOptions& options)
      : name_(name), file_(file), options_(options) {}

  Result<Model> read() {
    if (options_.colours)
      if (auto done = add_materials(); !done) return tl::unexpected(done.error());
    const std::size_t scene = static_cast<std::size_t>(std::max(file_.defaultScene, 0));
    if (scene < file_.scenes.size())
      for (const int root : file_.scenes[scene].nodes)
        if (auto done = add_node(root, Matrix::Identity(), 0); !done)
          return tl::unexpected(done.error());
    if (model_.size() == 0)
      return fail(ErrorKind::Malformed, name_, "has no triangles; a mesh needs faces");
    if (!has_corner_colours_) model_.corner_colours.clear();
    return std::move(model_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> broken(const char* list, int index, const char* what) const {
    return fail(ErrorKind::Malformed, fmt::format("{}: /{}/{}", name_, list, index), what);
  }

  Result<void> add_materials() {
    model_.materials.push_back({ModelColour{1, 1, 1}});
    for (const tinygltf::Material& material : file_.materials) {
      const auto& base = material.pbrMetallicRoughness;
      ModelMaterial& made = model_.materials.emplace_back();
      made.colour = {1, 1, 1};
      if (base.baseColorFactor.size() >= 3)
        for (std::size_t k = 0; k < 3; ++k) (*made.colour)[k] = srgb(base.baseColorFactor[k]);
      if (base.baseColorTexture.index >= 0) {
        const auto picture = picture_of(base.baseColorTexture.index);
        if (!picture) return tl::unexpected(picture.error());
        made.picture = *picture;
      }
      place_sets_.push_back(base.baseColorTexture.texCoord);
    }
    return {};
  }

  /// The picture of a texture.
  Result<std::int32_t> picture_of(int index) {
    if (const auto known = pictures_.find(index); known != pictures_.end()) return known->second;
    if (static_cast<std::size_t>(index) >= file_.textures.size())
      return broken("textures", index, "does not exist; repair the model");
    const tinygltf::Texture& texture = file_.textures[static_cast<std::size_t>(index)];
    if (texture.source < 0 || static_cast<std::size_t>(texture.source) >= file_.images.size())
      return broken("textures", index,
                    "has no PNG or JPEG picture; save the model with such pictures");
    const tinygltf::Image& image = file_.images[static_cast<std::size_t>(texture.source)];
    const auto bytes = bytes_of(image);
    if (!bytes)
      return broken("images", texture.source, "reaches beyond its buffer; is the file whole?");
    ModelPicture picture;
    picture.name = image.uri.empty() ? fmt::format("/images/{}", texture.source) : image.uri;
    if (texture.sampler >= 0 && static_cast<std::size_t>(texture.sampler) < file_.samplers.size())
      picture.repeats = file_.samplers[static_cast<std::size_t>(texture.sampler)].wrapS !=
                        TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    const auto added = add_picture(model_, options_, name_, std::move(picture), *bytes);
    if (added) pictures_[index] = *added;
    return added;
  }

  /// The bytes of a picture; none if they do not lie in its buffer. The library has checked that
  /// its view and its buffer exist.
  [[nodiscard]] std::optional<std::string_view> bytes_of(const tinygltf::Image& image) const {
    if (image.bufferView < 0) return text_of(image.image);
    const auto& view = file_.bufferViews[static_cast<std::size_t>(image.bufferView)];
    const auto whole = text_of(file_.buffers[static_cast<std::size_t>(view.buffer)].data);
    if (view.byteOffset > whole.size() || view.byteLength > whole.size() - view.byteOffset)
      return std::nullopt;
    return whole.substr(view.byteOffset, view.byteLength);
  }
  [[nodiscard]] static std::string_view text_of(const std::vector<unsigned char>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  Result<void> add_node(int index, const Matrix& above, int depth) {
    constexpr int kDeepest = 256;  // a tree this deep goes round in a circle
    if (index < 0 || static_cast<std::size_t>(index) >= file_.nodes.size() || depth > kDeepest)
      return broken("nodes", index, "does not exist, or lies in itself; repair the model");
    // Each has one place, or some nodes that lie in two would be visited for ever.
    if (++visited_ > file_.nodes.size())
      return broken("nodes", index, "lies in two nodes; repair the model");
    const tinygltf::Node& node = file_.nodes[static_cast<std::size_t>(index)];
    const Matrix here = above * matrix_of(node);
    if (node.mesh >= 0 && static_cast<std::size_t>(node.mesh) >= file_.meshes.size())
      return broken("meshes", node.mesh, "does not exist; repair the model");
    if (node.mesh >= 0)
      for (const auto& primitive : file_.meshes[static_cast<std::size_t>(node.mesh)].primitives)
        if (auto done = add_primitive(primitive, here); !done) return done;
    for (const int child : node.children)
      if (auto done = add_node(child, here, depth + 1); !done) return done;
    return {};
  }

  /// The numbers that a primitive has for each of its vertices; none if it does not have them.
  Result<std::optional<Numbers>> attribute(const tinygltf::Primitive& of, const std::string& word,
                                           std::size_t least_parts) const {
    const auto found = of.attributes.find(word);
    if (found == of.attributes.end()) return std::optional<Numbers>{};
    const auto numbers = Numbers::of(file_, found->second, least_parts, name_);
    if (!numbers) return tl::unexpected(numbers.error());
    return std::optional(*numbers);
  }

  /// The triangles of a primitive; points and lines have no surface.
  Result<void> add_primitive(const tinygltf::Primitive& of, const Matrix& here) {
    if (of.mode >= 0 && of.mode != TINYGLTF_MODE_TRIANGLES) return {};
    const auto places = attribute(of, "POSITION", 3);
    if (!places) return tl::unexpected(places.error());
    if (!*places) return {};
    std::optional<Numbers> indices;
    if (of.indices >= 0) {
      const auto numbers = Numbers::of(file_, of.indices, 1, name_);
      if (!numbers) return tl::unexpected(numbers.error());
      indices = *numbers;
    }
    const std::size_t triangles = (indices ? indices->size() : (*places)->size()) / 3;
    if (triangles > kMaxTriangles - model_.size())
      return fail(ErrorKind::OutOfRange, name_,
                  fmt::format("has more than {} triangles; reduce the mesh", kMaxTriangles));
    Colours colours;
    if (options_.colours)
      if (auto done = find_colours(of, colours); !done) return done;
    for (std::size_t k = 0; k < 3 * triangles; ++k) {
      const auto i = indices ? static_cast<std::size_t>(indices->get(k, 0)) : k;
      if (auto done = add_corner(i, **places, here); !done) return done;
      if (options_.colours) add_colour(i, colours);
    }
    if (options_.colours)
      model_.material_of.insert(model_.material_of.end(), triangles, colours.material);
    return {};
  }

  Result<void> add_corner(std::size_t vertex, const Numbers& places, const Matrix& here) {
    if (vertex >= places.size())
      return fail(
          ErrorKind::Malformed, name_,
          fmt::format("a triangle names vertex {} of {}; repair the model", vertex, places.size()));
    const Eigen::Vector4d at = here * Eigen::Vector4d(places.get(vertex, 0), places.get(vertex, 1),
                                                      places.get(vertex, 2), 1);
    if (!at.allFinite())
      return fail(ErrorKind::OutOfRange, name_,
                  "has a corner that is not a finite number; repair the mesh");
    model_.corners.insert(model_.corners.end(), at.data(), at.data() + 3);
    return {};
  }

  /// What colours the corners of a primitive.
  struct Colours {
    std::uint32_t material{};
    std::optional<Numbers> picture_places, corner_colours;
  };

  Result<void> find_colours(const tinygltf::Primitive& of, Colours& out) {
    if (of.material >= 0) {
      const auto material = static_cast<std::size_t>(of.material);
      if (material >= file_.materials.size())
        return broken("materials", of.material, "does not exist; repair the model");
      const auto places = attribute(of, fmt::format("TEXCOORD_{}", place_sets_[material]), 2);
      if (!places) return tl::unexpected(places.error());
      out.picture_places = *places;
      out.material = static_cast<std::uint32_t>(material + 1);
      model_.uses_materials = true;
    }
    const auto colours = attribute(of, "COLOR_0", 3);
    if (!colours) return tl::unexpected(colours.error());
    out.corner_colours = *colours;
    has_corner_colours_ = has_corner_colours_ || out.corner_colours.has_value();
    return {};
  }

  void add_colour(std::size_t vertex, const Colours& of) {
    std::array<float, 2> place{};
    if (of.picture_places && vertex < of.picture_places->size())
      place = {static_cast<float>(of.picture_places->get(vertex, 0)),
               static_cast<float>(of.picture_places->get(vertex, 1))};
    model_.picture_places.push_back(place);
    ModelColour colour{1, 1, 1};
    if (of.corner_colours && vertex < of.corner_colours->size())
      for (std::size_t k = 0; k < 3; ++k) colour[k] = srgb(of.corner_colours->get(vertex, k));
    model_.corner_colours.push_back(colour);
  }

  const std::string& name_;
  const tinygltf::Model& file_;
  const ModelOptions& options_;
  Model model_;
  std::vector<int> place_sets_;  ///< of each material: which TEXCOORD its texture takes
  std::map<int, std::int32_t> pictures_;
  std::size_t visited_{};
  bool has_corner_colours_{false};
};

}  // namespace

Result<Model> read_gltf(const std::string& name, std::string_view bytes,
                        const ModelOptions& options) {
  const auto file = parsed(name, bytes, options);
  if (!file) return tl::unexpected(file.error());
  return SceneReader(name, *file, options).read();
}

}  // namespace popcut::model_readers
