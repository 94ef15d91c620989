// SPDX-License-Identifier: MIT
#include "core/search/mesh_faults.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/vec.hpp"

namespace popcut {
namespace {

using Corner = std::array<float, 3>;

/// Numbers for corners, the same for those at the same place.
std::vector<std::uint32_t> numbered_corners(const TriangleMesh& mesh) {
  const auto corner = [&](std::size_t k) {
    return Corner{mesh.corners[3 * k] + 0.0F, mesh.corners[3 * k + 1] + 0.0F,
                  mesh.corners[3 * k + 2] + 0.0F};  // -0 is 0
  };
  const std::size_t count = mesh.corners.size() / 3;
  std::vector<std::uint32_t> order(count), out(count);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return corner(a) < corner(b); });
  std::uint32_t number = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (k > 0 && corner(order[k]) != corner(order[k - 1])) ++number;
    out[order[k]] = number;
  }
  return out;
}

std::size_t open_edges(const std::vector<std::uint32_t>& corners) {
  std::vector<std::uint64_t> edges;
  edges.reserve(corners.size());
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(corners[t + k], corners[t + (k + 1) % 3]);
      if (a != b) edges.push_back(static_cast<std::uint64_t>(a) << 32 | b);
    }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t end = k;
    while (end < edges.size() && edges[end] == edges[k]) ++end;
    if (end - k == 1) ++open;
    k = end;
  }
  return open;
}

/// Pairs of triangles that go through each other.
class Crossings {
 public:
  Crossings(const TriangleMesh& mesh, const std::vector<std::uint32_t>& numbers)
      : mesh_(mesh), numbers_(numbers) {
    const MeshBox box = box_of(mesh);
    double size = 0.0;
    for (std::size_t i = 0; i < 3; ++i) size = std::max(size, box.high[i] - box.low[i]);
    inside_ = 1e-6 * size;
    for (std::size_t t = 0; t < mesh.size(); ++t) boxes_.push_back(box_of_triangle(t));
  }

  /// A sweep along x over the triangles' boxes.
  [[nodiscard]] std::size_t count() const {
    std::vector<std::uint32_t> order(boxes_.size()), open;
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(boxes_[a].low[0], a) < std::pair(boxes_[b].low[0], b);
    });
    std::size_t crossings = 0;
    for (const std::uint32_t t : order) {
      std::erase_if(open, [&](std::uint32_t o) { return boxes_[o].high[0] < boxes_[t].low[0]; });
      for (const std::uint32_t o : open)
        if (boxes_meet(o, t) && !have_common_corner(o, t) && (enters(o, t) || enters(t, o)))
          ++crossings;
      open.push_back(t);
    }
    return crossings;
  }

 private:
  struct FloatBox {
    Corner low{}, high{};
  };
  [[nodiscard]] FloatBox box_of_triangle(std::size_t t) const {
    FloatBox box;
    for (std::size_t i = 0; i < 3; ++i) {
      const float a = mesh_.corners[9 * t + i], b = mesh_.corners[9 * t + 3 + i],
                  c = mesh_.corners[9 * t + 6 + i];
      box.low[i] = std::min({a, b, c}), box.high[i] = std::max({a, b, c});
    }
    return box;
  }
  [[nodiscard]] bool boxes_meet(std::size_t a, std::size_t b) const {
    for (std::size_t i = 1; i < 3; ++i)
      if (boxes_[a].high[i] < boxes_[b].low[i] || boxes_[b].high[i] < boxes_[a].low[i])
        return false;
    return true;
  }
  [[nodiscard]] bool have_common_corner(std::size_t a, std::size_t b) const {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t l = 0; l < 3; ++l)
        if (numbers_[3 * a + k] == numbers_[3 * b + l]) return true;
    return false;
  }
  [[nodiscard]] Vec3 corner(std::size_t t, std::size_t k) const {
    const float* p = &mesh_.corners[9 * t + 3 * k];
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }
  /// Whether a side of `a` goes through the inside of `b`.
  [[nodiscard]] bool enters(std::size_t a, std::size_t b) const {
    const Vec3 p = corner(b, 0), q = corner(b, 1), r = corner(b, 2);
    const Vec3 normal = unit(cross(Vec3(q - p), Vec3(r - p)));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 from = corner(a, k), to = corner(a, (k + 1) % 3);
      const double before = dot(normal, Vec3(from - p)), after = dot(normal, Vec3(to - p));
      if (!(std::min(before, after) < -inside_ && std::max(before, after) > inside_)) continue;
      const Vec3 at = from + (before / (before - after)) * (to - from);
      const auto left_of = [&](const Vec3& s, const Vec3& e) {
        const Vec3 side = e - s;
        return dot(cross(side, Vec3(at - s)), normal) > inside_ * norm(side);
      };
      if (left_of(p, q) && left_of(q, r) && left_of(r, p)) return true;
    }
    return false;
  }

  const TriangleMesh& mesh_;
  const std::vector<std::uint32_t>& numbers_;
  std::vector<FloatBox> boxes_;
  double inside_{};
};

double area_of_mesh(const TriangleMesh& mesh) {
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      const float* p = &mesh.corners[9 * t + 3 * k];
      return Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
    };
    const Vec3 a = corner(1) - corner(0), b = corner(2) - corner(0);
    area += 0.5 * norm(cross(a, b));
  }
  return area;
}

}  // namespace

MeshFaults faults_of(const TriangleMesh& mesh) {
  MeshFaults out;
  const std::vector<std::uint32_t> numbers = numbered_corners(mesh);
  out.open_edges = open_edges(numbers);
  out.area = area_of_mesh(mesh);
  out.crossings_counted = mesh.size() <= kMostCrossed;
  if (out.crossings_counted) out.crossings = Crossings(mesh, numbers).count();
  return out;
}

std::vector<std::string> in_words(const MeshFaults& faults) {
  std::vector<std::string> out;
  if (faults.open_edges > 0)
    out.push_back(fmt::format(
        "the model has holes ({} {} one triangle only); that does not matter for a card",
        faults.open_edges, faults.open_edges == 1 ? "edge has" : "edges have"));
  if (faults.crossings > 0)
    out.push_back(fmt::format(
        "parts of the model run through each other ({} of triangles); that does not matter for a "
        "card, which shows what is outermost",
        faults.crossings == 1 ? std::string("a pair") : fmt::format("{} pairs", faults.crossings)));
  return out;
}

}  // namespace popcut
