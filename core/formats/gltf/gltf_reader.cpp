// SPDX-License-Identifier: MIT
#include "core/formats/gltf/gltf_reader.hpp"

#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace popcut {
namespace {

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
  const auto bytes = (*static_cast<const OpenBeside*>(user))(plain);
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

tl::unexpected<Error> not_there(const std::string& name, const char* list, int index) {
  return fail(ErrorKind::Malformed, fmt::format("{}: /{}/{}", name, list, index),
              "is not there; repair the model");
}

template <typename T>
T value_at(const unsigned char* p, std::size_t part) {
  T out;
  std::memcpy(&out, p + part * sizeof(T), sizeof(T));
  return out;
}

}  // namespace

Result<GltfNumbers> GltfNumbers::of(const tinygltf::Model& model, int index,
                                    std::size_t least_parts, const std::string& name) {
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
  if (static_cast<std::size_t>(parts) < least_parts)
    return fail(ErrorKind::Malformed, place,
                fmt::format("has values of {} numbers, where {} are needed; repair the model",
                            parts, least_parts));
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
  GltfNumbers out;
  out.at_ = data.data() + view.byteOffset + accessor.byteOffset;
  out.count_ = accessor.count, out.step_ = step;
  out.type_ = accessor.componentType, out.normalized_ = accessor.normalized;
  return out;
}

double GltfNumbers::get(std::size_t i, std::size_t part) const {
  const unsigned char* p = at_ + i * step_;
  switch (type_) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return static_cast<double>(value_at<float>(p, part));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<double>(value_at<std::uint32_t>(p, part));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return static_cast<double>(value_at<std::uint16_t>(p, part)) / (normalized_ ? 65535.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return static_cast<double>(value_at<std::uint8_t>(p, part)) / (normalized_ ? 255.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return static_cast<double>(value_at<std::int16_t>(p, part)) / (normalized_ ? 32767.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return static_cast<double>(value_at<std::int8_t>(p, part)) / (normalized_ ? 127.0 : 1.0);
    default:
      return 0;
  }
}

Result<std::size_t> GltfPart::vertex(std::size_t corner) const {
  const auto i = indices_ ? static_cast<std::size_t>(indices_->get(corner, 0)) : corner;
  if (i < places_.size()) return i;
  return fail(ErrorKind::Malformed, name_,
              fmt::format("a triangle names vertex {} of {}; repair the model", i, places_.size()));
}

Result<Vec3> GltfPart::place(std::size_t vertex) const {
  const Eigen::Vector4d at =
      placed_ *
      Eigen::Vector4d(places_.get(vertex, 0), places_.get(vertex, 1), places_.get(vertex, 2), 1);
  if (at.allFinite()) return Vec3(at.x(), at.y(), at.z());
  return fail(ErrorKind::OutOfRange, name_,
              "has a corner that is not a finite number; repair the mesh");
}

/// Walks the nodes of a scene.
class GltfScene {
 public:
  using Visit = std::function<Result<void>(const GltfPart&)>;
  GltfScene(const tinygltf::Model& model, const std::string& name, std::size_t most,
            const Visit& visit)
      : model_(model), name_(name), left_(most), most_(most), visit_(visit) {}

  Result<void> walk() {
    std::vector<int> roots;
    const int scene = model_.defaultScene >= 0 ? model_.defaultScene : 0;
    if (static_cast<std::size_t>(scene) < model_.scenes.size())
      roots = model_.scenes[static_cast<std::size_t>(scene)].nodes;
    for (const int root : roots)
      if (auto done = visit_node(root, Matrix::Identity(), 0); !done) return done;
    return {};
  }

 private:
  Result<void> visit_node(int index, const Matrix& above, int depth) {
    constexpr int kDeepest = 256;  // a tree this deep goes round in a circle
    if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size() || depth > kDeepest)
      return fail(ErrorKind::Malformed, fmt::format("{}: /nodes/{}", name_, index),
                  "is not there, or lies in itself; repair the model");
    // Each has one place, or some nodes that lie in two would be visited for ever.
    if (++visited_ > model_.nodes.size())
      return fail(ErrorKind::Malformed, fmt::format("{}: /nodes/{}", name_, index),
                  "lies in two nodes; repair the model");
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const Matrix here = above * matrix_of(node);
    if (node.mesh >= 0 && static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
      return not_there(name_, "meshes", node.mesh);
    if (node.mesh >= 0)
      for (const tinygltf::Primitive& part :
           model_.meshes[static_cast<std::size_t>(node.mesh)].primitives)
        if (auto done = visit_part(part, here); !done) return done;
    for (const int child : node.children)
      if (auto done = visit_node(child, here, depth + 1); !done) return done;
    return {};
  }

  Result<void> visit_part(const tinygltf::Primitive& primitive, const Matrix& here) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode != TINYGLTF_MODE_TRIANGLES) return {};  // points and lines have no surface
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return {};
    const auto places = GltfNumbers::of(model_, position->second, 3, name_);
    if (!places) return tl::unexpected(places.error());
    GltfPart part(primitive, name_, *places);
    part.placed_ = here;
    if (primitive.indices >= 0) {
      const auto indices = GltfNumbers::of(model_, primitive.indices, 1, name_);
      if (!indices) return tl::unexpected(indices.error());
      part.indices_ = *indices;
    }
    const std::size_t triangles = (part.indices_ ? part.indices_->size() : places->size()) / 3;
    if (triangles > left_)
      return fail(ErrorKind::OutOfRange, name_,
                  fmt::format("has more than {} triangles; reduce the mesh", most_));
    left_ -= triangles;
    part.count_ = 3 * triangles;
    return visit_(part);
  }

  const tinygltf::Model& model_;
  const std::string& name_;
  std::size_t left_, most_, visited_{};
  const Visit& visit_;
};

Result<void> for_each_part(const tinygltf::Model& model, const std::string& name, std::size_t most,
                           const std::function<Result<void>(const GltfPart&)>& visit) {
  return GltfScene(model, name, most, visit).walk();
}

Result<tinygltf::Model> read_gltf(const std::string& name, std::string_view bytes,
                                  const OpenBeside& open) {
  if (bytes.size() > std::numeric_limits<unsigned>::max() / 2)
    return fail(ErrorKind::OutOfRange, name, "is larger than 2 GB; reduce the model");
  tinygltf::TinyGLTF reader;
  reader.SetImageLoader(keep_picture, nullptr);
  reader.SetFsCallbacks({is_there, as_named, read_beside, write_nothing,
                         const_cast<OpenBeside*>(&open)});  // it is only read
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
  return model;
}

}  // namespace popcut
