// SPDX-License-Identifier: MIT
#include "core/deploy/stl.hpp"

#include <bit>
#include <ostream>
#include <string>

namespace popcut {
namespace {

constexpr std::size_t kHeaderBytes = 80, kTriangleBytes = 50;

void put_u32(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<char>((value >> shift) & 0xff));
}

void put_vector(std::string& bytes, const Vec3& p) {
  for (const double value : p)
    put_u32(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

}  // namespace

void write_stl(const SheetMesh& mesh, const PoseTable& table, std::size_t pose, MeshAxes axes,
               std::string_view title, std::ostream& out) {
  // 1. Every corner in its place.
  std::vector<Vec3> places;
  places.reserve(mesh.at.size());
  for (std::size_t i = 0; i < mesh.at.size(); ++i) {
    const Vec3 p = table.at(pose, mesh.body[i])(mesh.at[i]);
    places.push_back(axes == MeshAxes::Paper ? Vec3{p[0], 1 - p[2], p[1]} : p);
  }
  // 2. The header; it must not start with "solid", which is how readers know the other STL.
  std::string bytes = "popcut, mm: ";
  bytes.append(title.substr(0, kHeaderBytes - bytes.size()));
  bytes.resize(kHeaderBytes, ' ');
  put_u32(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  // 3. The triangles, in blocks.
  constexpr std::size_t kBlockBytes = 1u << 16;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 across = cross(places[b] - places[a], places[c] - places[a]);
    put_vector(bytes, unit(across));
    for (const std::uint32_t corner : {a, b, c}) put_vector(bytes, places[corner]);
    bytes.append(2, '\0');
    if (bytes.size() + kTriangleBytes < kBlockBytes) continue;
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.clear();
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace popcut
