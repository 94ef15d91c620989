// SPDX-License-Identifier: MIT
// Part of core/verify/target/target_surface.hpp. Meshes of glTF 2.0 files (Khronos, 2021).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/geometry/vec.hpp"
#include "core/text/json_text.hpp"
#include "core/verify/target/target_surface.hpp"

namespace popcut::verify {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostCorners = 30'000'000;
constexpr int kDeepest = 256;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t out = 0;
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

/// RFC 4648; what is no such letter ends it.
std::string from_base64(std::string_view text) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> values{};
  values.fill(-1);
  for (std::size_t k = 0; k < kLetters.size(); ++k)
    values[static_cast<unsigned char>(kLetters[k])] = static_cast<int>(k);
  std::string out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t held = 0;
  int bits = 0;
  for (const char letter : text) {
    const int value = values[static_cast<unsigned char>(letter)];
    if (value < 0) break;
    held = held << 6 | static_cast<std::uint32_t>(value);
    if ((bits += 6) < 8) continue;
    bits -= 8;
    out.push_back(static_cast<char>(held >> bits & 0xFF));
  }
  return out;
}

/// Keeps the first thing that is wrong; what comes after it reads nothing.
class Scene {
 public:
  explicit Scene(std::string name) : name_(std::move(name)) {}

  Result<TargetTriangles> read(std::string_view text) {
    std::string_view binary;
    if (text.starts_with("glTF")) std::tie(text, binary) = chunks(text);
    if (fault_) return tl::unexpected(*fault_);
    auto json = parse_json_data(text);
    if (!json)
      return fail(ErrorKind::Malformed, name_,
                  fmt::format("is no glTF: {}; save the model again", message(json.error())));
    json_ = std::move(*json);
    read_buffers(binary);
    const Json& scenes = list("scenes");
    const std::size_t scene = whole(json_, "scene").value_or(0);
    if (scene < scenes.size() && scenes[scene].contains("nodes"))
      for (const Json& root : scenes[scene]["nodes"])
        add_node(index(root), Eigen::Matrix4d::Identity(), 0);
    if (fault_) return tl::unexpected(*fault_);
    return std::move(out_);
  }

 private:
  void refuse(std::string what, ErrorKind kind = ErrorKind::Malformed) {
    if (!fault_) fault_ = Error{kind, name_, std::move(what)};
  }

  std::pair<std::string_view, std::string_view> chunks(std::string_view bytes) {
    constexpr std::size_t kHead = 12, kChunkHead = 8;
    constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
    std::string_view json, binary;
    for (std::size_t at = kHead; at + kChunkHead <= bytes.size();) {
      const std::size_t size = word_at(bytes, at);
      const std::uint32_t type = word_at(bytes, at + 4);
      at += kChunkHead;
      if (size > bytes.size() - at) {
        refuse("ends inside a chunk; is the file whole?");
        break;
      }
      if (type == kJson && json.empty()) json = bytes.substr(at, size);
      if (type == kBinary && binary.empty()) binary = bytes.substr(at, size);
      at += size;
    }
    return {json, binary};
  }

  void read_buffers(std::string_view binary) {
    for (const Json& buffer : list("buffers")) {
      if (!buffer.is_object() || !buffer.contains("uri")) {
        buffers_.emplace_back(binary);
        continue;
      }
      const Json& uri = buffer["uri"];
      const std::string text = uri.is_string() ? uri.get<std::string>() : "";
      const std::size_t comma = text.find(";base64,");
      if (!text.starts_with("data:") || comma == text.npos)
        return refuse("keeps its mesh in another file; save it as one file (.glb)");
      buffers_.push_back(from_base64(std::string_view(text).substr(comma + 8)));
    }
  }

  const Json& list(const char* key) const {
    static const Json none = Json::array();
    const auto found = json_.is_object() ? json_.find(key) : json_.end();
    return json_.is_object() && found != json_.end() && found->is_array() ? *found : none;
  }
  const Json& entry(const char* key, std::size_t k) {
    static const Json none = Json::object();
    const Json& all = list(key);
    if (k < all.size() && all[k].is_object()) return all[k];
    refuse(fmt::format("names /{}/{}, which is not there; repair the model", key, k));
    return none;
  }
  std::size_t index(const Json& value) {
    if (value.is_number_unsigned()) return value.get<std::size_t>();
    refuse("has an index that is no whole number; repair the model");
    return std::numeric_limits<std::size_t>::max();
  }
  std::optional<std::size_t> whole(const Json& of, const char* key) {
    if (!of.is_object() || !of.contains(key)) return std::nullopt;
    return index(of[key]);
  }
  template <std::size_t N>
  std::array<double, N> numbers(const Json& of, const char* key, std::array<double, N> usual) {
    if (!of.contains(key)) return usual;
    const Json& all = of[key];
    bool is_right = all.is_array() && all.size() == N;
    for (std::size_t k = 0; is_right && k < N; ++k) {
      is_right = all[k].is_number();
      if (is_right) usual[k] = all[k].get<double>();
    }
    if (!is_right)
      refuse(fmt::format("has a node whose {} is not {} numbers; repair the model", key, N));
    return usual;
  }

  Eigen::Matrix4d matrix_of(const Json& node) {
    if (node.contains("matrix")) {
      const auto by_columns = numbers<16>(node, "matrix", {});
      return Eigen::Map<const Eigen::Matrix4d>(by_columns.data());
    }
    const auto move = numbers<3>(node, "translation", {}),
               size = numbers<3>(node, "scale", {1, 1, 1});
    const auto q = numbers<4>(node, "rotation", {0, 0, 0, 1});
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

  void add_node(std::size_t k, const Eigen::Matrix4d& above, int depth) {
    if (depth > kDeepest || ++visited_ > list("nodes").size())
      refuse("has a node that lies in itself or in two others; repair the model");
    if (fault_) return;
    const Json& node = entry("nodes", k);
    const Eigen::Matrix4d here = above * matrix_of(node);
    if (const auto mesh = whole(node, "mesh")) {
      const Json& parts = entry("meshes", *mesh);
      if (parts.contains("primitives") && parts["primitives"].is_array())
        for (const Json& part : parts["primitives"]) add_part(part, here);
    }
    if (node.contains("children") && node["children"].is_array())
      for (const Json& child : node["children"]) add_node(index(child), here, depth + 1);
  }

  /// Values of an accessor, checked to be there.
  struct Values {
    const char* at{};
    std::size_t count{}, step{};
    int type{};
    bool normalized{};

    [[nodiscard]] double get(std::size_t i, std::size_t part) const {
      const char* const from = at + i * step;
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

  [[nodiscard]] Values values(std::size_t k, const char* type, std::size_t parts) {
    const auto none = [this](std::string what) {
      refuse(std::move(what));
      return Values{};
    };
    const Json& accessor = entry("accessors", k);
    if (fault_) return {};
    const auto view_of = whole(accessor, "bufferView");
    if (accessor.contains("sparse") || !view_of)
      return none("has numbers that are sparse or compressed; save the model without compression");
    if (!accessor.contains("type") || accessor["type"] != type)
      return none(
          fmt::format("has /accessors/{} of another type than {}; repair the model", k, type));
    const Json& view = entry("bufferViews", *view_of);
    const std::size_t buffer = whole(view, "buffer").value_or(buffers_.size());
    if (fault_ || buffer >= buffers_.size())
      return none("names a buffer that is not there; repair the model");
    Values out;
    out.type =
        static_cast<int>(std::min<std::size_t>(whole(accessor, "componentType").value_or(0), 9999));
    const std::size_t bytes = out.type == 5120 || out.type == 5121   ? 1
                              : out.type == 5122 || out.type == 5123 ? 2
                              : out.type == 5125 || out.type == 5126 ? 4
                                                                     : 0;
    if (bytes == 0) return none("has numbers of a type that glTF has not; repair the model");
    out.count = whole(accessor, "count").value_or(0);
    out.step = whole(view, "byteStride").value_or(parts * bytes);
    out.normalized = accessor.contains("normalized") && accessor["normalized"] == true;
    const std::string& data = buffers_[buffer];
    const std::size_t begin = whole(view, "byteOffset").value_or(0),
                      more = whole(accessor, "byteOffset").value_or(0);
    const bool begins = begin <= data.size() && more <= data.size() - begin;
    const std::size_t room = begins ? data.size() - begin - more : 0, each = parts * bytes;
    if (out.count > 0 &&
        (room < each || (out.step > 0 && (out.count - 1) > (room - each) / out.step)))
      return none(fmt::format("announces {} values, more than its buffer holds; is the file whole?",
                              out.count));
    out.at = data.data() + begin + more;
    return out;
  }

  void add_part(const Json& part, const Eigen::Matrix4d& here) {
    constexpr std::size_t kTriangles = 4;
    if (whole(part, "mode").value_or(kTriangles) != kTriangles) return;
    if (!part.is_object() || !part.contains("attributes")) return;
    const auto position = whole(part["attributes"], "POSITION");
    if (!position) return;
    const Values places = values(*position, "VEC3", 3);
    std::optional<Values> indices;
    if (const auto of = whole(part, "indices")) indices = values(*of, "SCALAR", 1);
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
  Json json_;
  std::vector<std::string> buffers_;
  std::size_t visited_{};
  TargetTriangles out_;
};

}  // namespace

Result<TargetTriangles> read_target_gltf(const std::string& name, const std::string& bytes) {
  return Scene(name).read(bytes);
}

}  // namespace popcut::verify
