// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "core/model/model_readers.hpp"

namespace popcut::model_readers {
namespace {

constexpr std::size_t kHead = 84;      // bytes before the first triangle, the count last
constexpr std::size_t kTriangle = 50;  // bytes of a triangle
constexpr std::size_t kNormal = 12;    // of them, before its corners

std::uint32_t announced(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHead - sizeof count, sizeof count);
  return count;
}

bool is_binary(std::string_view bytes) {
  if (bytes.size() < kHead) return false;
  if (is_whole_binary_stl(bytes)) return true;
  // A text file begins with "solid" and holds no zero bytes.
  return !bytes.starts_with("solid") || bytes.substr(0, 1000).find('\0') != std::string_view::npos;
}

tl::unexpected<Error> no_triangles(const std::string& name) {
  return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
}

/// The triangles that the head announces; bytes after them are left out.
Result<Model> read_binary(const std::string& name, std::string_view bytes) {
  const std::size_t count = announced(bytes), there = (bytes.size() - kHead) / kTriangle;
  if (there < count)
    return fail(
        ErrorKind::Malformed, name,
        fmt::format("announces {} triangles and holds {}; is the file whole?", count, there));
  if (auto few = check_triangles(name, count); !few) return tl::unexpected(few.error());
  if (count == 0) return no_triangles(name);
  Model out;
  out.corners.reserve(9 * count);
  for (std::size_t t = 0; t < count; ++t) {
    std::array<float, 9> corners{};
    std::memcpy(corners.data(), bytes.data() + kHead + kTriangle * t + kNormal, sizeof corners);
    if (!std::all_of(corners.begin(), corners.end(), [](float v) { return std::isfinite(v); }))
      return fail(ErrorKind::OutOfRange, fmt::format("{}: triangle {}", name, t),
                  "has a corner that is not a finite number; repair the mesh");
    out.corners.insert(out.corners.end(), corners.begin(), corners.end());
  }
  return out;
}

Result<Model> read_text(const std::string& name, std::string_view bytes) {
  Model out;
  std::size_t facets = 0, corners = 0;
  const auto done = for_each_line(bytes, [&](std::string_view line, std::size_t number) {
    const auto broken = [&](const char* what) {
      return Result<void>(fail(ErrorKind::Malformed, line_place(name, number), what));
    };
    if (line.starts_with("facet")) {
      if (corners != 3 * facets) return broken("a facet begins before the last has three corners");
      if (auto few = check_triangles(name, ++facets); !few) return few;
    }
    if (line.starts_with("vertex")) {
      if (++corners > 3 * facets) return broken("is a fourth corner of a facet; three are needed");
      line.remove_prefix(6);
      const auto vertex = read_vertex(name, number, line);
      if (!vertex) return Result<void>(tl::unexpected(vertex.error()));
      out.corners.insert(out.corners.end(), vertex->begin(), vertex->end());
    }
    return Result<void>{};
  });
  if (!done) return tl::unexpected(done.error());
  if (facets == 0 && !bytes.starts_with("solid"))
    return fail(ErrorKind::Malformed, name, "is not an STL file; it has neither head nor facets");
  if (facets == 0) return no_triangles(name);
  if (corners != 3 * facets)
    return fail(ErrorKind::Malformed, name, "ends inside a facet; is the file whole?");
  return out;
}

}  // namespace

bool is_whole_binary_stl(std::string_view bytes) {
  return bytes.size() >= kHead && bytes.size() == kHead + kTriangle * std::size_t{announced(bytes)};
}

Result<Model> read_stl(const std::string& name, std::string_view bytes) {
  return is_binary(bytes) ? read_binary(name, bytes) : read_text(name, bytes);
}

}  // namespace popcut::model_readers
