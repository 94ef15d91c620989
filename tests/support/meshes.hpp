// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "core/model/triangle_mesh.hpp"

namespace popcut::testing {

using Point = std::array<double, 3>;

/// A closed sphere about the origin with 2 sectors (rings - 1) triangles.
[[nodiscard]] TriangleMesh sphere_mesh(double radius, int rings, int sectors);
/// An icosahedron refined `times` (each triangle into four), on a sphere.
[[nodiscard]] TriangleMesh icosphere(double radius, int times);
/// A torus about the z axis.
[[nodiscard]] TriangleMesh torus(double big_radius, double small_radius, int sectors);
/// A closed box between two corners; with `hole`, without the side at the largest x.
[[nodiscard]] TriangleMesh box_mesh(const Point& low, const Point& high, bool hole);
/// The surface (x, y, z(x, y)) for x in [0, d(y)], y in [0, length]: open, as a shell is.
[[nodiscard]] TriangleMesh shell_of(const std::function<Point(double, double)>& point, int across,
                                    int along);

[[nodiscard]] std::string binary_stl(const TriangleMesh& mesh);
[[nodiscard]] std::string text_stl(const TriangleMesh& mesh);
[[nodiscard]] std::string obj(const TriangleMesh& mesh);
/// A .gltf whose mesh is in the file `buffer` beside it (`corner_bytes`), or with `buffer` empty in
/// the chunk after it.
/// @param nodes  JSON; the first one is the scene, mesh 0 is the mesh
[[nodiscard]] std::string gltf(const TriangleMesh& mesh, const std::string& buffer,
                               const std::string& nodes = R"([{"mesh": 0}])");
[[nodiscard]] std::string corner_bytes(const TriangleMesh& mesh);
/// The same as one file.
[[nodiscard]] std::string glb(const TriangleMesh& mesh,
                              const std::string& nodes = R"([{"mesh": 0}])");

}  // namespace popcut::testing
