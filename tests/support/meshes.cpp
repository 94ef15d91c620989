// SPDX-License-Identifier: MIT
#include "tests/support/meshes.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut::testing {
namespace {

void add(TriangleMesh& mesh, const Point& a, const Point& b, const Point& c) {
  for (const Point& p : {a, b, c})
    for (const double value : p) mesh.corners.push_back(static_cast<float>(value));
}

void add_quad(TriangleMesh& mesh, const Point& a, const Point& b, const Point& c, const Point& d) {
  add(mesh, a, b, c);
  add(mesh, a, c, d);
}

}  // namespace

TriangleMesh sphere_mesh(double radius, int rings, int sectors) {
  TriangleMesh mesh;
  mesh.corners.reserve(18 * static_cast<std::size_t>(rings) * static_cast<std::size_t>(sectors));
  const auto at = [&](int ring, int sector) {
    const double theta = kPi * ring / rings, phi = 2.0 * kPi * (sector % sectors) / sectors;
    const double across = ring == 0 || ring == rings ? 0.0 : std::sin(theta);
    return Point{radius * across * std::cos(phi), radius * across * std::sin(phi),
                 radius * std::cos(theta)};
  };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      if (r + 1 < rings) add(mesh, at(r, s), at(r + 1, s), at(r + 1, s + 1));
      if (r > 0) add(mesh, at(r, s), at(r + 1, s + 1), at(r, s + 1));
    }
  return mesh;
}

TriangleMesh icosphere(double radius, int times) {
  const double g = std::numbers::phi;
  const std::vector<Point> v{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                             {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                             {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  const std::vector<std::array<std::size_t, 3>> faces{
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  const auto on_sphere = [&](const Point& p) {
    const double length = std::hypot(p[0], p[1], p[2]);
    return Point{radius * p[0] / length, radius * p[1] / length, radius * p[2] / length};
  };
  std::vector<std::array<Point, 3>> now;
  for (const auto& f : faces)
    now.push_back({on_sphere(v[f[0]]), on_sphere(v[f[1]]), on_sphere(v[f[2]])});
  for (int k = 0; k < times; ++k) {
    std::vector<std::array<Point, 3>> next;
    for (const auto& [a, b, c] : now) {
      const auto middle = [&](const Point& p, const Point& q) {
        return on_sphere({p[0] + q[0], p[1] + q[1], p[2] + q[2]});
      };
      const Point ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      next.insert(next.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    now = std::move(next);
  }
  TriangleMesh mesh;
  for (const auto& [a, b, c] : now) add(mesh, a, b, c);
  return mesh;
}

TriangleMesh torus(double big_radius, double small_radius, int sectors) {
  TriangleMesh mesh;
  const auto at = [&](int i, int j) {
    const double u = 2.0 * kPi * (i % sectors) / sectors, w = 2.0 * kPi * (j % sectors) / sectors;
    const double across = big_radius + small_radius * std::cos(w);
    return Point{across * std::cos(u), across * std::sin(u), small_radius * std::sin(w)};
  };
  for (int i = 0; i < sectors; ++i)
    for (int j = 0; j < sectors; ++j)
      add_quad(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  return mesh;
}

TriangleMesh box_mesh(const Point& low, const Point& high, bool hole) {
  TriangleMesh mesh;
  const auto at = [&](int x, int y, int z) {
    return Point{x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]};
  };
  add_quad(mesh, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
  if (!hole) add_quad(mesh, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
  add_quad(mesh, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  add_quad(mesh, at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
  add_quad(mesh, at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
  add_quad(mesh, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  return mesh;
}

TriangleMesh shell_of(const std::function<Point(double, double)>& point, int across, int along) {
  TriangleMesh mesh;
  const auto at = [&](int i, int j) {
    return point(static_cast<double>(i) / across, static_cast<double>(j) / along);
  };
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < across; ++i)
      add_quad(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  return mesh;
}

std::string binary_stl(const TriangleMesh& mesh) {
  std::string out(84 + 50 * mesh.size(), '\0');
  const auto count = static_cast<std::uint32_t>(mesh.size());
  std::memcpy(out.data() + 80, &count, 4);
  for (std::size_t k = 0; k < mesh.size(); ++k)
    std::memcpy(out.data() + 84 + 50 * k + 12, mesh.corners.data() + 9 * k, 36);
  return out;
}

std::string text_stl(const TriangleMesh& mesh) {
  std::string out = "solid test\n";
  for (std::size_t k = 0; k < mesh.size(); ++k) {
    out += "facet normal 0 0 0\n outer loop\n";
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const p = mesh.corners.data() + 9 * k + 3 * c;
      out += fmt::format("  vertex {} {} {}\n", p[0], p[1], p[2]);
    }
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid test\n";
}

std::string obj(const TriangleMesh& mesh) {
  std::string out = "# test\no part\n";
  for (std::size_t k = 0; k < mesh.corners.size(); k += 3)
    out += fmt::format("v {} {} {}\n", mesh.corners[k], mesh.corners[k + 1], mesh.corners[k + 2]);
  for (std::size_t k = 0; k < mesh.size(); ++k)
    out += fmt::format("f {} {} {}\n", 3 * k + 1, 3 * k + 2, 3 * k + 3);
  return out;
}

std::string corner_bytes(const TriangleMesh& mesh) {
  return {reinterpret_cast<const char*>(mesh.corners.data()), mesh.corners.size() * sizeof(float)};
}

std::string gltf(const TriangleMesh& mesh, const std::string& buffer, const std::string& nodes) {
  const std::size_t bytes = mesh.corners.size() * sizeof(float);
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
"nodes": {}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
"buffers": [{{"byteLength": {}{}}}], "bufferViews": [{{"buffer": 0, "byteLength": {}}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": {}, "type": "VEC3"}}]}})",
      nodes, bytes, buffer.empty() ? "" : fmt::format(R"(, "uri": "{}")", buffer), bytes,
      3 * mesh.size());
}

std::string glb(const TriangleMesh& mesh, const std::string& nodes) {
  std::string json = gltf(mesh, "", nodes);
  while (json.size() % 4 != 0) json += ' ';
  const std::string binary = corner_bytes(mesh);
  std::string out = "glTF";
  const auto put = [&](std::size_t number) {
    const auto word = static_cast<std::uint32_t>(number);
    out.append(reinterpret_cast<const char*>(&word), sizeof word);
  };
  constexpr std::size_t kHead = 12, kChunkHead = 8, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  put(2), put(kHead + 2 * kChunkHead + json.size() + binary.size());
  put(json.size()), put(kJson);
  out += json;
  put(binary.size()), put(kBinary);
  return out + binary;
}

}  // namespace popcut::testing
