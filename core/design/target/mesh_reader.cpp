// SPDX-License-Identifier: MIT
#include "core/design/target/mesh_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/triangulate.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

std::string extension(const std::string& name) {
  const auto dot = name.rfind('.');
  std::string out = dot == std::string::npos ? "" : name.substr(dot + 1);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

Result<void> too_many(const std::string& name, std::size_t count) {
  return fail(
      ErrorKind::OutOfRange, name,
      fmt::format("has {} triangles; at most {} are read: reduce the mesh", count, kMaxTriangles));
}

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;

/// Is it just as long as its head says? Whatever that head begins with, it is one.
bool is_whole_binary_stl(std::string_view bytes) {
  if (bytes.size() < kStlHead) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  return bytes.size() == kStlHead + kStlTriangle * static_cast<std::size_t>(count);
}

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < kStlHead) return false;
  if (is_whole_binary_stl(bytes)) return true;
  // A text file begins with "solid" and holds no zero bytes.
  return bytes.substr(0, 5) != "solid" ||
         bytes.substr(0, 1000).find('\0') != std::string_view::npos;
}

/// The triangles that the head announces; more bytes may follow and are left out.
Result<TriangleMesh> read_binary_stl(const std::string& name, std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  const std::size_t there = (bytes.size() - kStlHead) / kStlTriangle;
  if (there < count)
    return fail(
        ErrorKind::Malformed, name,
        fmt::format("announces {} triangles and holds {}; is the file whole?", count, there));
  if (count > kMaxTriangles) return tl::unexpected(too_many(name, count).error());
  if (count == 0) return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
  TriangleMesh out;
  out.corners.resize(9 * static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < count; ++t) {
    float* const corner = &out.corners[9 * t];
    std::memcpy(corner, bytes.data() + kStlHead + kStlTriangle * t + 12, 36);  // after the normal
    if (!std::all_of(corner, corner + 9, [](float value) { return std::isfinite(value); }))
      return fail(ErrorKind::OutOfRange, fmt::format("{}: triangle {}", name, t),
                  "has a corner that is not a finite number; repair the mesh");
  }
  return out;
}

/// Walks the lines of a text file, each without its end and the blanks around it.
template <typename Visit>
Result<void> for_each_line(std::string_view text, const Visit& visit) {
  std::size_t number = 1;
  for (std::size_t at = 0; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(text.substr(at, end - at), " \t\r");
    at = end + 1;
    if (line.empty()) continue;
    if (auto ok = visit(line, number); !ok) return ok;
  }
  return {};
}

/// Takes the first word off a line.
std::string_view next_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Three finite numbers, as a vertex has; more words may follow.
Result<std::array<float, 3>> read_vertex(const std::string& place, std::string_view words) {
  std::array<float, 3> out{};
  for (float& value : out) {
    std::string_view word = next_word(words);
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || end != word.data() + word.size() || error == std::errc::invalid_argument)
      return fail(ErrorKind::Malformed, place,
                  fmt::format("has \"{}\" where a number is needed; a vertex has three",
                              word.substr(0, 24)));
    const bool tiny = error == std::errc::result_out_of_range && word.find("e-") != word.npos;
    if ((error != std::errc{} && !tiny) || !std::isfinite(value))
      return fail(ErrorKind::OutOfRange, place,
                  fmt::format("has the coordinate {}; a finite number is needed: repair the mesh",
                              word.substr(0, 24)));
  }
  return out;
}

constexpr std::size_t kLongestLine = 1u << 16;

Result<TriangleMesh> read_text_stl(const std::string& name, std::string_view bytes) {
  TriangleMesh out;
  std::size_t facets = 0, corners = 0;
  const auto done = for_each_line(bytes, [&](std::string_view line, std::size_t number) {
    const auto broken = [&](const char* what) {
      return Result<void>(
          fail(ErrorKind::Malformed, fmt::format("{}: line {}", name, number), what));
    };
    if (line.rfind("facet", 0) == 0) {
      if (corners != 3 * facets) return broken("a facet begins before the last has three corners");
      if (++facets > kMaxTriangles) return too_many(name, facets);
    }
    if (line.rfind("vertex", 0) == 0) {
      if (++corners > 3 * facets) return broken("is a fourth corner of a facet; three are needed");
      const auto vertex = read_vertex(fmt::format("{}: line {}", name, number), line.substr(6));
      if (!vertex) return Result<void>(tl::unexpected(vertex.error()));
      out.corners.insert(out.corners.end(), vertex->begin(), vertex->end());
    }
    return Result<void>{};
  });
  if (!done) return tl::unexpected(done.error());
  if (facets == 0 && bytes.substr(0, 5) != "solid")
    return fail(ErrorKind::Malformed, name, "is not an STL file; it has neither head nor facets");
  if (facets == 0) return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
  if (corners != 3 * facets)
    return fail(ErrorKind::Malformed, name, "ends inside a facet; is the file whole?");
  return out;
}

/// The vertex that one "v", "v/t" or "v/t/n" of a face names: counted from 1, or backward from the
/// last one with a minus.
std::optional<std::size_t> named_vertex(std::string_view word, std::size_t vertices) {
  const bool backward = !word.empty() && word.front() == '-';
  if (backward) word.remove_prefix(1);
  std::size_t value = 0, digits = 0;
  for (; digits < word.size() && word[digits] >= '0' && word[digits] <= '9' && digits < 10;
       ++digits)
    value = 10 * value + static_cast<std::size_t>(word[digits] - '0');
  if (digits == 0 || (digits < word.size() && word[digits] != '/')) return std::nullopt;
  if (word.find_first_not_of("0123456789-/", digits) != std::string_view::npos) return std::nullopt;
  if (value < 1 || value > vertices) return std::nullopt;  // only what was read so far
  return backward ? vertices - value : value - 1;
}

}  // namespace

std::vector<Triangle> polygon_triangles(std::span<const std::array<float, 3>> vertices,
                                        const std::vector<std::uint32_t>& face) {
  std::vector<Vec3> corners;
  for (const std::uint32_t i : face)
    corners.push_back(Eigen::Vector3f(vertices[i].data()).cast<double>() -
                      Eigen::Vector3f(vertices[face[0]].data()).cast<double>());
  Vec3 normal;
  for (std::size_t k = 2; k < corners.size(); ++k) normal += corners[k - 1].cross(corners[k]);
  std::vector<Triangle> fan;
  bool convex = true;
  for (std::uint32_t k = 2; k < corners.size(); ++k) {
    fan.push_back({0, k - 1, k});
    convex = convex && corners[k - 1].cross(corners[k]).dot(normal) >= 0.0;
  }
  if (convex) return fan;
  Eigen::Index along{};
  normal.cwiseAbs().maxCoeff(&along);
  const Eigen::Index u = (along + 1) % 3, v = (along + 2) % 3;
  std::vector<Vec2> seen;
  for (const Vec3& p : corners) seen.emplace_back(normal[along] < 0.0 ? -p[u] : p[u], p[v]);
  std::vector<std::uint32_t> all(corners.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<Triangle> ears;
  return triangulate(seen, all, ears) ? ears : fan;
}

namespace {

using Vertex = std::array<float, 3>;

/// The faces of an OBJ file, of which nothing else is read than vertices and faces.
Result<TriangleMesh> read_obj(const std::string& name, std::string_view bytes) {
  TriangleMesh out;
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> face;
  std::size_t triangles = 0;
  const auto done = for_each_line(bytes, [&](std::string_view line, std::size_t number) {
    const auto broken = [&](std::string what) {
      return Result<void>(
          fail(ErrorKind::Malformed, fmt::format("{}: line {}", name, number), std::move(what)));
    };
    const bool is_vertex = line.size() > 1 && line[0] == 'v' && is_blank(line[1]);
    const bool is_face = line.size() > 1 && line[0] == 'f' && is_blank(line[1]);
    if (!is_vertex && !is_face) return Result<void>{};
    if (line.size() > kLongestLine) return broken("is longer than 65536 characters");
    if (line.back() == '\\') return broken("goes on in the next line; write it in one");
    if (is_vertex) {
      const auto vertex = read_vertex(fmt::format("{}: line {}", name, number), line.substr(1));
      if (!vertex) return Result<void>(tl::unexpected(vertex.error()));
      vertices.push_back(*vertex);
      return vertices.size() > 3 * kMaxTriangles ? too_many(name, kMaxTriangles + 1)
                                                 : Result<void>{};
    }
    face.clear();
    std::string_view rest = line.substr(1);
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const auto vertex = named_vertex(word, vertices.size());
      if (!vertex)
        return broken(
            fmt::format("names vertex \"{}\"; a number from 1 to {}, the vertices before "
                        "it, is needed",
                        word.substr(0, 24), vertices.size()));
      face.push_back(static_cast<std::uint32_t>(*vertex));
    }
    if (face.size() < 3) return broken("a face needs three vertices");
    if ((triangles += face.size() - 2) > kMaxTriangles) return too_many(name, triangles);
    for (const Triangle& triangle : polygon_triangles(vertices, face))
      for (const std::uint32_t k : triangle)
        out.corners.insert(out.corners.end(), vertices[face[k]].begin(), vertices[face[k]].end());
    return Result<void>{};
  });
  if (!done) return tl::unexpected(done.error());
  if (vertices.empty())
    return fail(ErrorKind::Malformed, name, "has no vertices; is it an OBJ file?");
  if (out.size() == 0) return fail(ErrorKind::Malformed, name, "has no faces; a mesh needs some");
  return out;
}

}  // namespace

Result<TriangleMesh> read_mesh(const std::string& name, std::string_view bytes) {
  if (const auto foreign = foreign_kind(bytes); !foreign.empty() && !is_whole_binary_stl(bytes))
    return fail(ErrorKind::Malformed, name,
                fmt::format("is {}; give a 3D model as an STL, OBJ or GLB file", foreign));
  std::string kind = extension(name);
  // A name without an ending, as assets have, says nothing. An OBJ is text with vertices in it,
  // a .gltf begins with a brace.
  if (kind.empty()) {
    const bool stl = bytes.substr(0, 5) == "solid" || bytes.find('\0') != std::string_view::npos;
    const bool gltf =
        bytes.substr(0, 4) == "glTF" || trimmed(bytes.substr(0, 256)).starts_with('{');
    kind = gltf ? "gltf" : stl ? "stl" : "obj";
  }
  if (kind == "glb" || kind == "gltf") return read_gltf_mesh(name, bytes);
  if (kind == "obj") return read_obj(name, bytes);
  if (kind == "stl")
    return is_binary_stl(bytes) ? read_binary_stl(name, bytes) : read_text_stl(name, bytes);
  return fail(
      ErrorKind::Malformed, name,
      fmt::format("is a \"{}\" file; meshes are read from .stl, .obj, .glb and .gltf", kind));
}

}  // namespace popcut
