// SPDX-License-Identifier: MIT
#include "core/design/target/mesh_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <new>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

namespace popcut {
namespace {

/// No file is opened: core reads none, and a mesh from outside names none that we want.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

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

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < kStlHead) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() == kStlHead + kStlTriangle * static_cast<std::size_t>(count)) return true;
  // A text file begins with "solid" and holds no zero bytes.
  return bytes.substr(0, 5) != "solid" ||
         bytes.substr(0, 1000).find('\0') != std::string_view::npos;
}

/// The bytes that head and announced triangles take; more may follow and is left out.
Result<std::string_view> whole_binary_stl(const std::string& name, std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  const std::size_t there = (bytes.size() - kStlHead) / kStlTriangle;
  if (there < count)
    return fail(
        ErrorKind::Malformed, name,
        fmt::format("announces {} triangles and holds {}; is the file whole?", count, there));
  if (count > kMaxTriangles) return tl::unexpected(too_many(name, count).error());
  if (count == 0) return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
  return bytes.substr(0, kStlHead + kStlTriangle * static_cast<std::size_t>(count));
}

/// Walks the lines of a text file, each without its end and without blanks before it.
template <typename Visit>
Result<void> for_each_line(std::string_view text, const Visit& visit) {
  std::size_t number = 1;
  for (std::size_t at = 0; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t'))
      line.remove_suffix(1);
    const std::size_t begin = line.find_first_not_of(" \t");
    line.remove_prefix(std::min(begin, line.size()));
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

/// A text STL in its binary form: assimp's reader of text loses memory where a file is broken.
Result<std::string> binary_of_text(const std::string& name, std::string_view bytes) {
  std::string out(kStlHead, '\0');
  std::size_t facets = 0, corners = 0;
  const auto done = for_each_line(bytes, [&](std::string_view line, std::size_t number) {
    const auto broken = [&](const char* what) {
      return Result<void>(
          fail(ErrorKind::Malformed, fmt::format("{}: line {}", name, number), what));
    };
    if (line.rfind("facet", 0) == 0) {
      if (corners != 3 * facets) return broken("a facet begins before the last has three corners");
      if (++facets > kMaxTriangles) return too_many(name, facets);
      out.append(12, '\0');  // the normal
    }
    if (line.rfind("vertex", 0) == 0) {
      if (++corners > 3 * facets) return broken("is a fourth corner of a facet; three are needed");
      const auto vertex = read_vertex(fmt::format("{}: line {}", name, number), line.substr(6));
      if (!vertex) return Result<void>(tl::unexpected(vertex.error()));
      char raw[12];
      std::memcpy(raw, vertex->data(), 12);
      out.append(raw, 12);
      if (corners == 3 * facets) out.append(2, '\0');
    }
    return Result<void>{};
  });
  if (!done) return tl::unexpected(done.error());
  if (facets == 0 && bytes.substr(0, 5) != "solid")
    return fail(ErrorKind::Malformed, name, "is not an STL file; it has neither head nor facets");
  if (facets == 0) return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
  if (corners != 3 * facets)
    return fail(ErrorKind::Malformed, name, "ends inside a facet; is the file whole?");
  const auto count = static_cast<std::uint32_t>(facets);
  std::memcpy(out.data() + 80, &count, 4);
  return out;
}

/// One "v", "v/t" or "v/t/n" of a face: a whole number that names a vertex.
bool names_vertex(std::string_view word, long vertices) {
  if (!word.empty() && word.front() == '-') word.remove_prefix(1);
  long value = 0;
  std::size_t digits = 0;
  for (; digits < word.size() && word[digits] >= '0' && word[digits] <= '9' && digits < 10;
       ++digits)
    value = 10 * value + (word[digits] - '0');
  if (digits == 0 || (digits < word.size() && word[digits] != '/')) return false;
  if (word.find_first_not_of("0123456789-/", digits) != std::string_view::npos) return false;
  return value >= 1 && value <= vertices;  // backward or forward, only to what was read so far
}

/// The vertices and faces of an OBJ file and nothing else of it, so that no other part of it
/// reaches the reader; each face names at least three vertices that are there.
Result<std::string> plain_obj(const std::string& name, std::string_view bytes) {
  std::string out;
  out.reserve(bytes.size() + 1);
  long vertices = 0;
  std::size_t triangles = 0;
  const auto done = for_each_line(bytes, [&](std::string_view line, std::size_t number) {
    const auto broken = [&](std::string what) {
      return Result<void>(
          fail(ErrorKind::Malformed, fmt::format("{}: line {}", name, number), std::move(what)));
    };
    const bool vertex = line.size() > 1 && line[0] == 'v' && (line[1] == ' ' || line[1] == '\t');
    const bool face = line.size() > 1 && line[0] == 'f' && (line[1] == ' ' || line[1] == '\t');
    if (!vertex && !face) return Result<void>{};
    if (line.size() > kLongestLine) return broken("is longer than 65536 characters");
    if (line.back() == '\\') return broken("goes on in the next line; write it in one");
    if (vertex) {
      const auto ok = read_vertex(fmt::format("{}: line {}", name, number), line.substr(1));
      if (!ok) return Result<void>(tl::unexpected(ok.error()));
    }
    std::size_t words = 0;
    out += line[0];
    for (std::string_view rest = line.substr(1); !(vertex && words == 3);) {
      const std::string_view word = next_word(rest);
      if (word.empty()) break;
      ++words;
      if (face && !names_vertex(word, vertices))
        return broken(
            fmt::format("names vertex \"{}\"; a number from 1 to {}, the vertices before "
                        "it, is needed",
                        word.substr(0, 24), vertices));
      out += ' ';
      out += face ? word.substr(0, word.find('/')) : word;
    }
    out += '\n';
    if (words < 3) return broken("a face needs three vertices");
    if (vertex && ++vertices > static_cast<long>(3 * kMaxTriangles))
      return too_many(name, kMaxTriangles + 1);
    if (face && (triangles += words - 2) > kMaxTriangles) return too_many(name, triangles);
    return Result<void>{};
  });
  if (!done) return tl::unexpected(done.error());
  if (vertices == 0) return fail(ErrorKind::Malformed, name, "has no vertices; is it an OBJ file?");
  if (triangles == 0) return fail(ErrorKind::Malformed, name, "has no faces; a mesh needs some");
  return out;
}

/// The triangles of all parts as a flat list; points and lines are left out.
Result<TriangleMesh> flatten(const std::string& name, const aiScene& scene) {
  std::size_t triangles = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) triangles += scene.mMeshes[m]->mNumFaces;
  if (triangles > kMaxTriangles) return tl::unexpected(too_many(name, triangles).error());
  TriangleMesh out;
  out.corners.reserve(9 * triangles);
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices)
          return fail(ErrorKind::Malformed, name, "a face names a vertex that is not there");
        const aiVector3D& p = mesh.mVertices[face.mIndices[k]];
        for (const float value : {p.x, p.y, p.z}) {
          if (!std::isfinite(value))
            return fail(ErrorKind::OutOfRange, fmt::format("{}: triangle {}", name, f),
                        "has a corner that is not a finite number; repair the mesh");
          out.corners.push_back(value);
        }
      }
    }
  }
  if (out.size() == 0)
    return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
  return out;
}

Result<TriangleMesh> import(const std::string& name, std::string_view bytes, const char* kind) {
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new NoFiles);  // the importer owns it
    const aiScene* const scene =
        importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, kind);
    if (scene == nullptr)
      return fail(ErrorKind::Malformed, name,
                  fmt::format("cannot be read as {}: {}", kind, importer.GetErrorString()));
    return flatten(name, *scene);
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::OutOfRange, name, "does not fit into memory; reduce the mesh");
  } catch (const std::exception& e) {
    return fail(ErrorKind::Malformed, name,
                fmt::format("cannot be read as {}: {}", kind, e.what()));
  }
}

}  // namespace

Result<TriangleMesh> read_mesh(const std::string& name, std::string_view bytes) {
  std::string kind = extension(name);
  // A name without an ending, as assets have, says nothing. An OBJ is text with vertices in it.
  if (kind.empty()) {
    const bool stl = bytes.substr(0, 5) == "solid" || bytes.find('\0') != std::string_view::npos;
    kind = stl ? "stl" : "obj";
  }
  if (kind == "obj") {
    const auto plain = plain_obj(name, bytes);
    if (!plain) return tl::unexpected(plain.error());
    return import(name, *plain, "obj");
  }
  if (kind != "stl")
    return fail(ErrorKind::Malformed, name,
                fmt::format("is a \"{}\" file; meshes are read from .stl and .obj", kind));
  if (!is_binary_stl(bytes)) {
    const auto binary = binary_of_text(name, bytes);
    if (!binary) return tl::unexpected(binary.error());
    return import(name, *binary, "stl");
  }
  const auto whole = whole_binary_stl(name, bytes);
  if (!whole) return tl::unexpected(whole.error());
  return import(name, *whole, "stl");
}

}  // namespace popcut
