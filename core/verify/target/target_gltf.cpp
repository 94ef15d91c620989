// SPDX-License-Identifier: MIT
// Part of core/verify/target/target_surface.hpp. Meshes of glTF 2.0 files (Khronos, 2021).
// The library parses; where a triangle lies is worked out here, apart from what designs read.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/geometry/vec.hpp"
#include "core/verify/target/target_surface.hpp"

namespace popcut::verify {
namespace {

constexpr std::size_t kMostCorners = 30'000'000;
constexpr int kDeepest = 256;

// Pictures say nothing of a shape.
bool leave_picture(tinygltf::Image*, int, std::string*, std::string*, int, int,
                   const unsigned char*, int, void*) {
  return true;
}

// A target is one file: that another one was asked for is noted.
bool note_other_file(const std::string&, void* asked) {
  *static_cast<bool*>(asked) = true;
  return false;
}
std::string as_named(const std::string& name, void*) { return name; }
bool read_nothing(std::vector<unsigned char>*, std::string*, const std::string&, void*) {
  return false;
}
bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

/// Keeps the first thing that is wrong; what comes after it reads nothing.
class Scene {
 public:
  explicit Scene(std::string name) : name_(std::move(name)) {}

  Result<TargetTriangles> read(std::string_view bytes) {
    parse(bytes);
    const std::size_t scene =
        model_.defaultScene > 0 ? static_cast<std::size_t>(model_.defaultScene) : 0;
    if (!fault_ && scene < model_.scenes.size())
      for (const int root : model_.scenes[scene].nodes)
        add_node(root, Eigen::Matrix4d::Identity(), 0);
    if (fault_) return tl::unexpected(*fault_);
    return std::move(out_);
  }

 private:
  void refuse(std::string what, ErrorKind kind = ErrorKind::Malformed) {
    if (!fault_) fault_ = Error{kind, name_, std::move(what)};
  }

  void parse(std::string_view bytes) {
    if (bytes.size() > std::numeric_limits<unsigned>::max() / 2)
      return refuse("is larger than 2 GB; reduce the model", ErrorKind::OutOfRange);
    bool asked = false;
    tinygltf::TinyGLTF reader;
    reader.SetImageLoader(leave_picture, nullptr);
    reader.SetFsCallbacks({note_other_file, as_named, read_nothing, write_nothing, &asked});
    std::string error, warning;
    const auto size = static_cast<unsigned>(bytes.size());
    const bool is_read =
        bytes.starts_with("glTF")
            ? reader.LoadBinaryFromMemory(&model_, &error, &warning,
                                          reinterpret_cast<const unsigned char*>(bytes.data()),
                                          size)
            : reader.LoadASCIIFromString(&model_, &error, &warning, bytes.data(), size, "");
    if (is_read) return;
    refuse(asked ? "keeps its mesh in another file; save it as one file (.glb)"
                 : "is no glTF that can be read; save the model again");
  }

  /// One of a list, or none: the file names what it does not have.
  template <typename T>
  const T* entry(const std::vector<T>& all, int k, const char* list) {
    if (k >= 0 && static_cast<std::size_t>(k) < all.size())
      return &all[static_cast<std::size_t>(k)];
    refuse(fmt::format("names /{}/{}, which is not there; repair the model", list, k));
    return nullptr;
  }

  template <std::size_t N>
  static std::array<double, N> numbers(const std::vector<double>& given,
                                       std::array<double, N> usual) {
    for (std::size_t k = 0; given.size() == N && k < N; ++k) usual[k] = given[k];
    return usual;
  }

  static Eigen::Matrix4d matrix_of(const tinygltf::Node& node) {
    if (node.matrix.size() == 16)  // by columns
      return Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
    const auto move = numbers<3>(node.translation, {}), size = numbers<3>(node.scale, {1, 1, 1});
    const auto q = numbers<4>(node.rotation, {0, 0, 0, 1});
    // Rows of the rotation of a unit quaternion (x, y, z, w).
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double x = q[0] / n, y = q[1] / n, z = q[2] / n, w = q[3] / n;
    Eigen::Matrix4d out;
    out << size[0] * (1 - 2 * (y * y + z * z)), size[1] * 2 * (x * y - z * w),
        size[2] * 2 * (x * z + y * w), move[0],  //
        size[0] * 2 * (x * y + z * w), size[1] * (1 - 2 * (x * x + z * z)),
        size[2] * 2 * (y * z - x * w), move[1],  //
        size[0] * 2 * (x * z - y * w), size[1] * 2 * (y * z + x * w),
        size[2] * (1 - 2 * (x * x + y * y)), move[2],  //
        0, 0, 0, 1;
    return out;
  }

  void add_node(int k, const Eigen::Matrix4d& above, int depth) {
    if (depth > kDeepest || ++visited_ > model_.nodes.size())
      refuse("has a node that lies in itself or in two others; repair the model");
    if (fault_) return;
    const tinygltf::Node* const node = entry(model_.nodes, k, "nodes");
    if (!node) return;
    const Eigen::Matrix4d here = above * matrix_of(*node);
    if (node->mesh >= 0)
      if (const tinygltf::Mesh* const mesh = entry(model_.meshes, node->mesh, "meshes"))
        for (const tinygltf::Primitive& part : mesh->primitives) add_part(part, here);
    for (const int child : node->children) add_node(child, here, depth + 1);
  }

  /// Values of an accessor, checked to be there.
  struct Values {
    const unsigned char* at{};
    std::size_t count{}, step{};
    int type{};
    bool normalized{};

    [[nodiscard]] double get(std::size_t i, std::size_t part) const {
      const unsigned char* const from = at + i * step;
      const auto read = [&](auto value) {
        std::memcpy(&value, from + part * sizeof value, sizeof value);
        return static_cast<double>(value);
      };
      const auto share = [&](double value, double most) {
        return normalized ? value / most : value;
      };
      switch (type) {
        case 5120:
          return share(read(std::int8_t{}), 127);
        case 5121:
          return share(read(std::uint8_t{}), 255);
        case 5122:
          return share(read(std::int16_t{}), 32767);
        case 5123:
          return share(read(std::uint16_t{}), 65535);
        case 5125:
          return read(std::uint32_t{});
        default:
          return read(float{});
      }
    }
  };

  [[nodiscard]] Values values(int k, int type, std::size_t parts) {
    const auto none = [this](std::string what) {
      refuse(std::move(what));
      return Values{};
    };
    const tinygltf::Accessor* const accessor = entry(model_.accessors, k, "accessors");
    if (!accessor) return {};
    if (accessor->sparse.isSparse || accessor->bufferView < 0)
      return none("has numbers that are sparse or compressed; save the model without compression");
    if (accessor->type != type)
      return none(
          fmt::format("has /accessors/{} of a type that does not fit; repair the model", k));
    const auto* const view = entry(model_.bufferViews, accessor->bufferView, "bufferViews");
    const auto* const buffer = view ? entry(model_.buffers, view->buffer, "buffers") : nullptr;
    if (!buffer) return {};
    Values out;
    out.type = accessor->componentType;
    const std::size_t bytes = out.type == 5120 || out.type == 5121   ? 1
                              : out.type == 5122 || out.type == 5123 ? 2
                              : out.type == 5125 || out.type == 5126 ? 4
                                                                     : 0;
    if (bytes == 0) return none("has numbers of a type that glTF has not; repair the model");
    out.count = accessor->count;
    out.step = view->byteStride > 0 ? view->byteStride : parts * bytes;
    out.normalized = accessor->normalized;
    const std::vector<unsigned char>& data = buffer->data;
    const std::size_t begin = view->byteOffset, more = accessor->byteOffset;
    const bool begins = begin <= data.size() && more <= data.size() - begin;
    const std::size_t room = begins ? data.size() - begin - more : 0, each = parts * bytes;
    if (out.count > 0 && (room < each || (out.count - 1) > (room - each) / out.step))
      return none(fmt::format("announces {} values, more than its buffer holds; is the file whole?",
                              out.count));
    if (begins) out.at = data.data() + begin + more;
    return out;
  }

  void add_part(const tinygltf::Primitive& part, const Eigen::Matrix4d& here) {
    if (part.mode >= 0 && part.mode != TINYGLTF_MODE_TRIANGLES) return;
    const auto position = part.attributes.find("POSITION");
    if (position == part.attributes.end()) return;
    const Values places = values(position->second, TINYGLTF_TYPE_VEC3, 3);
    std::optional<Values> indices;
    if (part.indices >= 0) indices = values(part.indices, TINYGLTF_TYPE_SCALAR, 1);
    if (fault_) return;
    const std::size_t corners = (indices ? indices->count : places.count) / 3 * 3;
    if (corners > kMostCorners - out_.corners.size() / 3)
      return refuse("there are more than 10000000 triangles; make it coarser",
                    ErrorKind::OutOfRange);
    for (std::size_t k = 0; k < corners; ++k) {
      const auto i = indices ? static_cast<std::size_t>(indices->get(k, 0)) : k;
      if (i >= places.count)
        return refuse(
            fmt::format("a triangle names vertex {} of {}; repair the model", i, places.count));
      const Eigen::Vector4d at =
          here * Eigen::Vector4d(places.get(i, 0), places.get(i, 1), places.get(i, 2), 1);
      if (!at.allFinite())
        return refuse("a coordinate is not a finite number", ErrorKind::OutOfRange);
      for (int axis = 0; axis < 3; ++axis) out_.corners.push_back(static_cast<float>(at[axis]));
    }
  }

  std::string name_;
  std::optional<Error> fault_;
  tinygltf::Model model_;
  std::size_t visited_{};
  TargetTriangles out_;
};

}  // namespace

Result<TargetTriangles> read_target_gltf(const std::string& name, const std::string& bytes) {
  return Scene(name).read(bytes);
}

}  // namespace popcut::verify
