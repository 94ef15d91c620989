// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace popcut {

/// The arrays of a lattice blob (docs/geometry.md, section 9). Empty ones that are optional are
/// left out of the blob.
struct LatticeArrays {
  std::vector<float> points;  ///< x, z, v of each vertex, mm
  std::vector<std::uint32_t> triangles, triangle_face;
  std::vector<std::uint8_t> sides;
  std::vector<std::uint8_t> face_kind;
  std::vector<std::int32_t> face_slice, face_level;
  std::vector<float> face_error;
  std::vector<std::uint8_t> face_merged;
  std::vector<std::int32_t> face_part;                  ///< optional
  std::vector<float> point_k, point_h, face_k, face_h;  ///< optional
  std::vector<std::uint32_t> tips;                      ///< optional, with the next three
  std::vector<float> tip_apex, tip_w, tip_alpha;
  std::vector<float> lines;
  std::vector<std::uint8_t> line_role;
  std::vector<float> ghost_points;  ///< optional, with the next one
  std::vector<std::uint32_t> ghost_triangles;
  std::vector<float> frames;  ///< optional
};

/// Puts a blob together: "PCLB", the version, the head and the arrays. `head` is the text of a JSON
/// object; the member "arrays" (type, offset and length of each) is added to it.
[[nodiscard]] std::string blob_bytes(std::string head, const LatticeArrays& arrays);

}  // namespace popcut
