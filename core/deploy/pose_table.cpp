// SPDX-License-Identifier: MIT
#include "core/deploy/pose_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/geometry/buckets.hpp"

namespace popcut {
namespace {

constexpr double kRigidWithin = 1e-7;   // of the sheet's size
constexpr double kStillWithin = 1e-10;  // of the size, or rad

/// Three corners of a face that lie well apart, as indices of vertices.
struct Anchor {
  std::array<std::uint32_t, 3> corner{};
  bool flat{};    ///< it spans no area; then the face only shifts
  double area{};  ///< of the whole face, mm^2
};

struct Work {
  const Pattern& pattern;
  std::vector<Vec3> flat;
  std::vector<Anchor> anchors;
  double size{1};
};

Anchor anchor_of(const Work& work, std::size_t f) {
  const auto face = work.pattern.face(f);
  Anchor anchor;
  if (face.empty()) return {.flat = true};
  anchor.corner.fill(face[0]);
  const Vec3& a = work.flat[face[0]];
  for (const std::uint32_t i : face)
    if (norm(work.flat[i] - a) > norm(work.flat[anchor.corner[1]] - a)) anchor.corner[1] = i;
  const Vec3 along = work.flat[anchor.corner[1]] - a;
  double widest = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 here = work.flat[face[i]] - a;
    const double wide = norm(cross(along, here));
    if (wide > widest) {
      widest = wide;
      anchor.corner[2] = face[i];
    }
    anchor.area += 0.5 * cross(here, work.flat[face[(i + 1) % face.size()]] - a)[2];
  }
  anchor.area = std::abs(anchor.area);
  anchor.flat = !(widest > 1e-12 * dot(along, along));
  return anchor;
}

Result<void> check_angles(std::span<const double> psi_rad) {
  for (std::size_t k = 0; k < psi_rad.size(); ++k) {
    if (!(psi_rad[k] >= 0 && psi_rad[k] <= std::numbers::pi)) {
      return fail(ErrorKind::OutOfRange, fmt::format("pose {}", k),
                  fmt::format("{} rad is not an opening angle; must be from 0 (shut) to pi (flat)",
                              psi_rad[k]));
    }
    const bool turns = k >= 2 && (psi_rad[k] > psi_rad[k - 1]) != (psi_rad[1] > psi_rad[0]);
    if (k >= 1 && (turns || psi_rad[k] == psi_rad[k - 1])) {
      return fail(ErrorKind::OutOfRange, fmt::format("pose {}", k),
                  fmt::format("{} rad after {} rad; the angles must rise throughout or fall "
                              "throughout",
                              psi_rad[k], psi_rad[k - 1]));
    }
  }
  return {};
}

/// The motion of each face at one pose, checked at all its vertices.
Result<void> move_faces(const Work& work, std::span<const Vec3> places, double psi_rad,
                        double slack_mm, std::span<rigid::Motion> motions) {
  for (std::size_t f = 0; f < work.pattern.faces(); ++f) {
    const auto& [c, flat, area] = work.anchors[f];
    const auto face = work.pattern.face(f);
    if (face.empty()) continue;
    motions[f] = flat ? rigid::Motion{rigid::kNoTurn, places[c[0]] - work.flat[c[0]]}
                      : rigid::motion_of({work.flat[c[0]], work.flat[c[1]], work.flat[c[2]]},
                                         {places[c[0]], places[c[1]], places[c[2]]});
    for (const std::uint32_t i : face) {
      const double off = norm(motions[f](work.flat[i]) - places[i]);
      if (off <= std::max(slack_mm, kRigidWithin * work.size)) continue;
      return fail(ErrorKind::OutOfRange, fmt::format("faces/{}", f),
                  fmt::format("does not stay rigid: vertex {} is off by {:.3g} mm at psi = {} rad; "
                              "every pose must be a rigid motion of each face",
                              i, off, psi_rad));
    }
  }
  return {};
}

/// Consecutive poses get quaternions on the same side, so that they can be interpolated.
void align_signs(PoseTable& table) {
  for (std::size_t k = 1; k < table.poses(); ++k) {
    for (std::size_t b = 0; b < table.bodies(); ++b) {
      rigid::Turn& turn = table.motions[k * table.bodies() + b].turn;
      turn = rigid::toward(turn, table.at(k - 1, b).turn);
    }
  }
}

/// 0 for a face that never moves, 1 for one that turns about the spine, 2 for the others.
int restlessness(const PoseTable& table, std::size_t f, double size) {
  int rank = 0;
  for (std::size_t k = 0; k < table.poses(); ++k) {
    const rigid::Motion& motion = table.at(k, f);
    if (norm(motion.shift) > kStillWithin * size) return 2;
    if (motion.turn.angularDistance(rigid::kNoTurn) > kStillWithin) rank = 1;
  }
  return rank;
}

/// A face across a fold. All folds between two faces lie on one line, so any of them will do.
struct Neighbour {
  std::uint32_t face{}, edge{};
};

Buckets<Neighbour> neighbours_of(const Pattern& pattern) {
  return {pattern.faces(), [&](auto&& put) {
            for (std::uint32_t e = 0; e < pattern.edges.size(); ++e) {
              const PatternEdge& edge = pattern.edges[e];
              if (edge.role != EdgeRole::Mountain && edge.role != EdgeRole::Valley) continue;
              if (edge.left < 0 || edge.right < 0 || edge.left == edge.right) continue;
              const auto left = static_cast<std::uint32_t>(edge.left);
              const auto right = static_cast<std::uint32_t>(edge.right);
              put(left, {right, e});
              put(right, {left, e});
            }
          }};
}

/// Breadth first from the stillest and largest face of each piece, so that chains stay short.
void grow_tree(const Work& work, PoseTable& table) {
  const std::size_t faces = table.faces;
  std::vector<std::uint32_t> start(faces);
  std::vector<int> rank(faces);
  for (std::uint32_t f = 0; f < faces; ++f) {
    start[f] = f;
    rank[f] = restlessness(table, f, work.size);
  }
  std::sort(start.begin(), start.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (rank[a] != rank[b]) return rank[a] < rank[b];
    if (work.anchors[a].area != work.anchors[b].area)
      return work.anchors[a].area > work.anchors[b].area;
    return a < b;
  });
  const Buckets<Neighbour> neighbours = neighbours_of(work.pattern);
  std::vector<std::uint8_t> seen(faces, 0);
  for (const std::uint32_t root : start) {
    if (seen[root] != 0) continue;
    seen[root] = 1;
    table.pivot[root] = rank[root] == 1 ? Vec3{} : work.flat[work.anchors[root].corner[0]];
    std::size_t done = table.order.size();
    table.order.push_back(root);
    for (; done < table.order.size(); ++done) {
      const std::uint32_t from = table.order[done];
      for (const auto& [to, e] : neighbours[from]) {
        if (seen[to] != 0) continue;
        seen[to] = 1;
        const PatternEdge& edge = work.pattern.edges[e];
        table.parent[to] = static_cast<std::int32_t>(from);
        table.pivot[to] = 0.5 * (work.flat[edge.from] + work.flat[edge.to]);
        table.order.push_back(to);
      }
    }
  }
}

/// Hangs roots that shift on a link that turns with the wall; see `pose_table`.
void carry_roots(const Work& work, PoseTable& table) {
  const Pattern& pattern = work.pattern;
  std::vector<std::uint32_t> hung;
  for (const std::uint32_t f : table.order) {
    const auto face = pattern.face(f);
    if (table.parent[f] >= 0 || face.empty() || restlessness(table, f, work.size) < 2) continue;
    const PatternVertex& p = pattern.vertices[face[0]];
    const auto all = [&](auto&& same) {
      return std::all_of(face.begin(), face.end(),
                         [&](std::uint32_t i) { return same(pattern.vertices[i]); });
    };
    if (all([&](const PatternVertex& q) { return q.z == p.z; })) {
      table.pivot[f] = {-p.z, p.v, 0};
      hung.push_back(f);
    } else if (all([&](const PatternVertex& q) { return q.x == p.x; })) {
      table.pivot[f] = {p.x, p.v, 0};
    }
  }
  if (hung.empty()) return;
  const std::size_t bodies = table.bodies();
  std::vector<rigid::Motion> motions;
  motions.reserve(table.poses() * (bodies + 1));
  for (std::size_t k = 0; k < table.poses(); ++k) {
    const auto first = table.motions.begin() + static_cast<std::ptrdiff_t>(k * bodies);
    motions.insert(motions.end(), first, first + static_cast<std::ptrdiff_t>(bodies));
    const Eigen::AngleAxisd wall(std::numbers::pi - table.psi_rad[k], Vec3::UnitY());
    motions.push_back({rigid::Turn(wall), Vec3::Zero()});
  }
  table.motions = std::move(motions);
  for (const std::uint32_t f : hung) table.parent[f] = static_cast<std::int32_t>(bodies);
  table.parent.push_back(-1);
  table.pivot.push_back(Vec3::Zero());
  table.order.insert(table.order.begin(), static_cast<std::uint32_t>(bodies));
}

Work prepare(const Pattern& pattern) {
  Work work{pattern, {}, {}, 0};
  work.flat.reserve(pattern.vertices.size());
  for (const PatternVertex& p : pattern.vertices) {
    work.flat.push_back(flat_place(pattern, p));
    work.size = std::max(work.size, norm(work.flat.back()));
  }
  if (work.size == 0) work.size = 1;
  for (std::size_t f = 0; f < pattern.faces(); ++f) work.anchors.push_back(anchor_of(work, f));
  return work;
}

Result<PoseTable> tabled(const Work& work, std::span<const double> psi_rad,
                         const PosedVertices& positions, double slack_mm = 0) {
  if (auto sound = check_angles(psi_rad); !sound) return tl::unexpected(sound.error());
  const std::size_t faces = work.pattern.faces();
  if (faces > 0 && psi_rad.size() > kMaxTabled / faces) {
    return fail(ErrorKind::OutOfRange, "poses",
                fmt::format("{} poses of {} faces are too many at once; ask for fewer",
                            psi_rad.size(), faces));
  }
  PoseTable table;
  table.psi_rad.assign(psi_rad.begin(), psi_rad.end());
  table.faces = faces;
  table.parent.assign(faces, -1);
  table.pivot.resize(faces);
  table.motions.resize(faces * psi_rad.size());
  std::vector<Vec3> places(work.flat.size());
  for (std::size_t k = 0; k < psi_rad.size(); ++k) {
    positions(psi_rad[k], places);
    const auto motions = std::span(table.motions).subspan(k * faces, faces);
    if (auto done = move_faces(work, places, psi_rad[k], slack_mm, motions); !done)
      return tl::unexpected(done.error());
  }
  align_signs(table);
  grow_tree(work, table);
  return table;
}

std::vector<std::size_t> spread(std::size_t poses, std::size_t steps) {
  std::vector<std::size_t> keys;
  for (std::size_t i = 0; i <= steps; ++i) keys.push_back(i * (poses - 1) / steps);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

bool are_enough(const PoseTable& table, const std::vector<std::size_t>& keys) {
  constexpr double kWithinRad = 1e-9;
  for (std::size_t b = 0; b < table.bodies(); ++b) {
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      const double from = table.psi_rad[keys[i]], to = table.psi_rad[keys[i + 1]];
      const rigid::Turn first = joint_turn(table, keys[i], b),
                        last = joint_turn(table, keys[i + 1], b);
      const Vec3 place = joint_place(table, keys[0], b);
      for (std::size_t k = keys[i]; k <= keys[i + 1]; ++k) {
        const rigid::Turn there =
            rigid::slerp(first, last, (table.psi_rad[k] - from) / (to - from));
        if (there.angularDistance(joint_turn(table, k, b)) > kWithinRad) return false;
        const double size = std::max(1.0, norm(place));
        if (table.parent[b] < 0 && norm(joint_place(table, k, b) - place) > kWithinRad * size)
          return false;
      }
    }
  }
  return true;
}

}  // namespace

Vec3 flat_place(const Pattern& pattern, const PatternVertex& vertex) {
  return {pattern.u(vertex) - pattern.wall_mm, vertex.v, 0};
}

Result<PoseTable> pose_table(const Pattern& pattern, std::span<const double> psi_rad,
                             const PosedVertices& positions, double slack_mm) {
  return tabled(prepare(pattern), psi_rad, positions, slack_mm);
}

Result<PoseTable> pose_table(const Pattern& pattern, std::span<const double> psi_rad) {
  const Work work = prepare(pattern);
  auto table = tabled(work, psi_rad, [&](double psi, std::span<Vec3> places) {
    const auto posed = posed_vertices(pattern, psi);
    for (std::size_t i = 0; i < posed.size(); ++i) places[i] = vec3(posed[i]);
  });
  if (table) carry_roots(work, *table);
  return table;
}

rigid::Turn joint_turn(const PoseTable& table, std::size_t pose, std::size_t body) {
  const rigid::Turn& turn = table.at(pose, body).turn;
  const std::int32_t parent = table.parent[body];
  if (parent < 0) return turn;
  return table.at(pose, static_cast<std::size_t>(parent)).turn.conjugate() * turn;
}

Vec3 joint_place(const PoseTable& table, std::size_t pose, std::size_t body) {
  const std::int32_t parent = table.parent[body];
  if (parent < 0) return table.at(pose, body)(table.pivot[body]);
  return table.pivot[body] - table.pivot[static_cast<std::size_t>(parent)];
}

std::vector<std::size_t> animation_keys(const PoseTable& table) {
  const std::size_t poses = table.poses();
  if (poses < 3) return spread(poses, std::max<std::size_t>(poses, 2) - 1);
  const double span = std::abs(table.psi_rad.back() - table.psi_rad.front());
  constexpr double kStepRad = std::numbers::pi / 3;
  const auto steps = static_cast<std::size_t>(std::ceil(span / kStepRad - 1e-9));
  const auto few = spread(poses, std::clamp<std::size_t>(steps, 1, poses - 1));
  return are_enough(table, few) ? few : spread(poses, poses - 1);
}

Result<std::vector<double>> opening_angles(double from_rad, double to_rad, int frames) {
  const auto wrong = [](std::string detail) {
    return fail(ErrorKind::Usage, "command line", std::move(detail));
  };
  if (frames < 1 || frames > kMaxFrames) {
    return wrong(fmt::format("{} frames; give 1 to {}", frames, kMaxFrames));
  }
  for (const double psi : {from_rad, to_rad}) {
    if (!(psi >= 0 && psi <= std::numbers::pi)) {
      return wrong(
          fmt::format("{} rad is not an opening angle; must be from 0 (shut) to pi (flat)", psi));
    }
  }
  if (frames > 1 && from_rad == to_rad) {
    return wrong(
        fmt::format("{} frames from {} rad to the same angle; give two different angles, "
                    "or one frame",
                    frames, from_rad));
  }
  std::vector<double> angles(static_cast<std::size_t>(frames), from_rad);
  for (int k = 1; k < frames; ++k)
    angles[static_cast<std::size_t>(k)] = from_rad + (to_rad - from_rad) * k / (frames - 1);
  if (frames > 1) angles.back() = to_rad;
  return angles;
}

}  // namespace popcut
