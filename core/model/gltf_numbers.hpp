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
/// against the bytes that are there. A sparse accessor replaces some values of a buffer, or of
/// zeros, by others; it takes no memory for either.
class GltfNumbers {
 public:
  /// @param least_parts  numbers that each value has at least
  /// @param name         of the file, for errors
  /// @retval Malformed  it does not exist, is compressed, or holds less than it announces
  [[nodiscard]] static Result<GltfNumbers> of(const tinygltf::Model& model, int index,
                                              std::size_t least_parts, const std::string& name);

  [[nodiscard]] std::size_t size() const { return count_; }

  /// Values that a sparse accessor replaces.
  [[nodiscard]] std::size_t replaced() const { return replaced_; }

  /// Values that are in the file; others are zero.
  [[nodiscard]] std::size_t given() const { return at_ ? count_ : replaced_; }

  /// Whether the replaced values are in order and exist, as `get` needs to find them. Looks at
  /// each.
  [[nodiscard]] bool is_in_order() const;

  /// Number `part` of value `i`. Whole numbers that stand for -1 to 1 are given as that. A sparse
  /// accessor is searched: log(replaced()) steps.
  [[nodiscard]] double get(std::size_t i, std::size_t part) const;

 private:
  [[nodiscard]] std::size_t replaced_index(std::size_t k) const;

  const unsigned char* at_{};  ///< null where all values are zero
  std::size_t count_{}, step_{};
  const unsigned char *indices_{}, *values_{};  ///< of a sparse accessor, without gaps
  std::size_t replaced_{}, value_bytes_{};
  int type_{}, index_type_{};
  bool normalized_{};
};

}  // namespace popcut::model_readers
