// SPDX-License-Identifier: MIT
#include "core/search/coarse_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <unordered_map>

namespace popcut {

TriangleMesh coarse_mesh(const TriangleMesh& mesh, int cells, std::size_t most) {
  if (mesh.size() <= most) return mesh;
  const MeshBox box = box_of(mesh);
  double side = 0.0;
  for (std::size_t i = 0; i < 3; ++i) side = std::max(side, box.high[i] - box.low[i]);
  const double cell = side / cells;
  std::unordered_map<std::uint64_t, std::array<float, 3>> corner_of;
  TriangleMesh out;
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    std::array<std::uint64_t, 3> key{};
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<float, 3> p{};
      for (std::size_t i = 0; i < 3; ++i) {
        p[i] = mesh.corners[9 * t + 3 * c + i];
        const auto at = static_cast<std::uint64_t>((static_cast<double>(p[i]) - box.low[i]) / cell);
        key[c] = key[c] << 20 | at;
      }
      corners[c] = corner_of.try_emplace(key[c], p).first->second;
    }
    if (key[0] == key[1] || key[1] == key[2] || key[2] == key[0]) continue;
    for (const auto& p : corners) out.corners.insert(out.corners.end(), p.begin(), p.end());
  }
  return out.size() > 0 ? out : mesh;
}

std::string stl_bytes(const TriangleMesh& mesh) {
  constexpr std::size_t kHead = 80, kRecord = 50, kNormal = 12;
  const auto count = static_cast<std::uint32_t>(mesh.size());
  std::string out(kHead + sizeof(count) + kRecord * mesh.size(), '\0');
  std::memcpy(out.data() + kHead, &count, sizeof(count));
  for (std::size_t t = 0; t < mesh.size(); ++t)
    std::memcpy(out.data() + kHead + sizeof(count) + kRecord * t + kNormal, &mesh.corners[9 * t],
                9 * sizeof(float));
  return out;
}

}  // namespace popcut
