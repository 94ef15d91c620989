// SPDX-License-Identifier: MIT
#include "core/model/gltf_numbers.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

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

std::size_t bytes_of(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return 4;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return 1;
    default:
      return 0;  // the library lets others pass
  }
}

/// Finds the bytes of an accessor in its buffers.
class Finder {
 public:
  Finder(const tinygltf::Model& model, std::string place)
      : model_(model), place_(std::move(place)) {}

  [[nodiscard]] tl::unexpected<Error> broken(std::string what) const {
    return fail(ErrorKind::Malformed, place_, what + "; repair the model");
  }

  [[nodiscard]] Result<const tinygltf::BufferView*> view(int index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.bufferViews.size())
      return broken("refers to a buffer view that does not exist");
    const auto& view = model_.bufferViews[static_cast<std::size_t>(index)];
    if (view.extensions.contains("EXT_meshopt_compression"))
      return fail(ErrorKind::Malformed, place_,
                  "is compressed (EXT_meshopt_compression); save the model without compression");
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size())
      return broken("refers to a buffer that does not exist");
    return &view;
  }

  /// Where `count` values begin, of `each` bytes, `step` bytes apart.
  [[nodiscard]] Result<const unsigned char*> values(const tinygltf::BufferView& view,
                                                    std::size_t offset, std::size_t count,
                                                    std::size_t each, std::size_t step) const {
    const auto& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
    const std::size_t behind = data.size() - std::min(view.byteOffset, data.size());
    const std::size_t length = std::min(view.byteLength, behind);
    const bool begins = view.byteOffset <= data.size() && offset <= length;
    const std::size_t room = begins ? length - offset : std::size_t{0};
    if (count > 0 && (room < each || (count - 1) > (room - each) / step))
      return fail(
          ErrorKind::Malformed, place_,
          fmt::format("announces {} values, more than its buffer view holds; is the file whole?",
                      count));
    return begins ? data.data() + view.byteOffset + offset : nullptr;
  }

  /// The same without gaps, of a sparse accessor.
  [[nodiscard]] Result<const unsigned char*> sparse(int view_index, int offset, std::size_t count,
                                                    std::size_t each) const {
    if (offset < 0) return broken("has sparse values before the begin of their buffer view");
    const auto found = view(view_index);
    if (!found) return tl::unexpected(found.error());
    return values(**found, static_cast<std::size_t>(offset), count, each, each);
  }

 private:
  const tinygltf::Model& model_;
  std::string place_;
};

}  // namespace

Result<GltfNumbers> GltfNumbers::of(const tinygltf::Model& model, int index,
                                    std::size_t least_parts, const std::string& name) {
  const std::string place = fmt::format("{}: /accessors/{}", name, index);
  const Finder finder(model, place);
  if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
    return finder.broken("does not exist");
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const auto& sparse = accessor.sparse;
  if (accessor.bufferView < 0 && !sparse.isSparse)
    return fail(ErrorKind::Malformed, place,
                "has no values, or is compressed; save the model without compression");
  const int parts = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  const std::size_t bytes = bytes_of(accessor.componentType);
  if (parts <= 0 || bytes == 0)
    return finder.broken("has a component type that glTF does not define");
  if (static_cast<std::size_t>(parts) < least_parts)
    return finder.broken(
        fmt::format("has values of {} numbers, where {} are needed", parts, least_parts));
  GltfNumbers out;
  out.count_ = accessor.count, out.value_bytes_ = static_cast<std::size_t>(parts) * bytes;
  out.type_ = accessor.componentType, out.normalized_ = accessor.normalized;
  if (accessor.bufferView >= 0) {
    const auto view = finder.view(accessor.bufferView);
    if (!view) return tl::unexpected(view.error());
    const int stride = accessor.ByteStride(**view);
    if (stride <= 0) return finder.broken("has a stride that does not fit its component type");
    out.step_ = static_cast<std::size_t>(stride);
    const auto at =
        finder.values(**view, accessor.byteOffset, out.count_, out.value_bytes_, out.step_);
    if (!at) return tl::unexpected(at.error());
    out.at_ = *at;
  }
  if (!sparse.isSparse) return out;
  const int index_type = sparse.indices.componentType;
  if (index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT &&
      index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
    return finder.broken("has sparse indices of a component type that glTF does not allow");
  if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > out.count_)
    return finder.broken(fmt::format("replaces {} of {} values", sparse.count, out.count_));
  out.replaced_ = static_cast<std::size_t>(sparse.count);
  out.index_type_ = index_type;
  const auto indices = finder.sparse(sparse.indices.bufferView, sparse.indices.byteOffset,
                                     out.replaced_, bytes_of(index_type));
  if (!indices) return tl::unexpected(indices.error());
  const auto values = finder.sparse(sparse.values.bufferView, sparse.values.byteOffset,
                                    out.replaced_, out.value_bytes_);
  if (!values) return tl::unexpected(values.error());
  out.indices_ = *indices, out.values_ = *values;
  return out;
}

std::size_t GltfNumbers::replaced_index(std::size_t k) const {
  switch (index_type_) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<std::size_t>(value_at<std::uint32_t>(indices_, k));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return static_cast<std::size_t>(value_at<std::uint16_t>(indices_, k));
    default:
      return indices_[k];
  }
}

bool GltfNumbers::is_in_order() const {
  for (std::size_t k = 0; k < replaced_; ++k)
    if (replaced_index(k) >= count_ || (k > 0 && replaced_index(k) <= replaced_index(k - 1)))
      return false;
  return true;
}

double GltfNumbers::get(std::size_t i, std::size_t part) const {
  const unsigned char* p = at_ != nullptr ? at_ + i * step_ : nullptr;
  std::size_t low = 0;
  for (std::size_t high = replaced_; low < high;) {
    const std::size_t middle = low + (high - low) / 2;
    if (replaced_index(middle) < i)
      low = middle + 1;
    else
      high = middle;
  }
  if (low < replaced_ && replaced_index(low) == i) p = values_ + low * value_bytes_;
  if (p == nullptr) return 0;
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
