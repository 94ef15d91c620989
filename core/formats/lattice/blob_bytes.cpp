// SPDX-License-Identifier: MIT
#include "core/formats/lattice/blob_bytes.hpp"

#include <bit>
#include <cstring>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr std::uint32_t kVersion = 1;

constexpr std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

constexpr const char* type_of(float) { return "f32"; }
constexpr const char* type_of(std::uint32_t) { return "u32"; }
constexpr const char* type_of(std::int32_t) { return "i32"; }
constexpr const char* type_of(std::uint8_t) { return "u8"; }

/// Calls `visit(name, array, is_optional)` for each array, in the order of the blob.
template <typename Visit>
void each_array(const LatticeArrays& a, Visit visit) {
  visit("points", a.points, false);
  visit("triangles", a.triangles, false);
  visit("triangle_face", a.triangle_face, false);
  visit("sides", a.sides, false);
  visit("face_kind", a.face_kind, false);
  visit("face_slice", a.face_slice, false);
  visit("face_level", a.face_level, false);
  visit("face_error", a.face_error, false);
  visit("face_merged", a.face_merged, false);
  visit("face_part", a.face_part, true);
  visit("point_k", a.point_k, true);
  visit("point_h", a.point_h, true);
  visit("face_k", a.face_k, true);
  visit("face_h", a.face_h, true);
  visit("tips", a.tips, true);
  visit("tip_apex", a.tip_apex, true);
  visit("tip_w", a.tip_w, true);
  visit("tip_alpha", a.tip_alpha, true);
  visit("lines", a.lines, false);
  visit("line_role", a.line_role, false);
  visit("ghost_points", a.ghost_points, true);
  visit("ghost_triangles", a.ghost_triangles, true);
  visit("frames", a.frames, true);
}

void put_u32(std::string& out, std::uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<char>(number >> shift & 0xff));
}

template <typename T>
void put_array(std::string& out, const std::vector<T>& values) {
  if constexpr (std::endian::native == std::endian::little) {
    const std::size_t before = out.size();
    out.resize(before + values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(out.data() + before, values.data(), values.size() * sizeof(T));
  } else if constexpr (sizeof(T) == 1) {
    for (const T value : values) out.push_back(static_cast<char>(value));
  } else {
    for (const T value : values) put_u32(out, std::bit_cast<std::uint32_t>(value));
  }
  out.resize(padded(out.size()), '\0');
}

}  // namespace

std::string blob_bytes(std::string head, const LatticeArrays& arrays) {
  std::string list;
  std::size_t offset = 0;
  each_array(arrays, [&](const char* name, const auto& values, bool is_optional) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    if (is_optional && values.empty()) return;
    list += fmt::format(R"({}"{}":{{"type":"{}","offset":{},"length":{}}})",
                        list.empty() ? "" : ",", name, type_of(Value{}), offset, values.size());
    offset += padded(values.size() * sizeof(Value));
  });
  head.pop_back();  // the closing brace
  head += (head.size() > 1 ? ",\"arrays\":{" : "\"arrays\":{") + list + "}}";
  head.resize(padded(head.size()), ' ');

  std::string out;
  out.reserve(12 + head.size() + offset);
  out += "PCLB";
  put_u32(out, kVersion);
  put_u32(out, static_cast<std::uint32_t>(head.size()));
  out += head;
  each_array(arrays, [&](const char*, const auto& values, bool is_optional) {
    if (!(is_optional && values.empty())) put_array(out, values);
  });
  return out;
}

}  // namespace popcut
