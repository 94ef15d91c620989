// SPDX-License-Identifier: MIT
#include "core/model/gltf_numbers.hpp"

#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <tiny_gltf.h>

namespace popcut::model_readers {
namespace {

template <typename T>
double value_at(const unsigned char* p, std::size_t part) {
  T out;
  std::memcpy(&out, p + part * sizeof(T), sizeof(T));
  return static_cast<double>(out);
}

}  // namespace

Result<GltfNumbers> GltfNumbers::of(const tinygltf::Model& model, int index,
                                    std::size_t least_parts, const std::string& name) {
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
  if (view.extensions.contains("EXT_meshopt_compression"))
    return fail(ErrorKind::Malformed, place,
                "is compressed (EXT_meshopt_compression); save the model without compression");
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
    return broken(fmt::format("has values of {} numbers, where {} are needed", parts, least_parts));
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
  if (begins) out.at_ = data.data() + view.byteOffset + accessor.byteOffset;
  out.count_ = accessor.count, out.step_ = step;
  out.type_ = accessor.componentType, out.normalized_ = accessor.normalized;
  return out;
}

double GltfNumbers::get(std::size_t i, std::size_t part) const {
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

}  // namespace popcut::model_readers
