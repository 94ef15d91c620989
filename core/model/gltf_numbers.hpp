// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "core/result.hpp"

namespace tinygltf {
class Model;
}

namespace popcut::model_readers {

/// The numbers of an accessor of a glTF file (Khronos, glTF 2.0 Specification, 3.6.2), checked
/// against the bytes that are there.
class GltfNumbers {
 public:
  /// @param least_parts  numbers that each value has at least
  /// @param name         of the file, for errors
  /// @retval Malformed  it does not exist, is compressed, or holds less than it announces
  [[nodiscard]] static Result<GltfNumbers> of(const tinygltf::Model& model, int index,
                                              std::size_t least_parts, const std::string& name);

  [[nodiscard]] std::size_t size() const { return count_; }

  /// Number `part` of value `i`. Whole numbers that stand for -1 to 1 are given as that.
  [[nodiscard]] double get(std::size_t i, std::size_t part) const;

 private:
  const unsigned char* at_{};
  std::size_t count_{}, step_{};
  int type_{};
  bool normalized_{};
};

}  // namespace popcut::model_readers
