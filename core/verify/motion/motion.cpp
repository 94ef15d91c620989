// SPDX-License-Identifier: MIT
#include "core/verify/motion/motion.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut::verify {
namespace {

/// Three vertices of a panel far apart: one, the farthest from it, the farthest from their line.
std::array<std::uint32_t, 3> far_apart(const FoldModel& file,
                                       std::span<const std::uint32_t> vertices) {
  const auto farthest = [&](auto measure) {
    return *std::max_element(vertices.begin(), vertices.end(),
                             [&](std::uint32_t a, std::uint32_t b) {
                               return measure(file.flat[a]) < measure(file.flat[b]);
                             });
  };
  const Vec2 start = file.flat[vertices[0]];
  const std::uint32_t a = farthest([&](Vec2 p) { return dot(p - start, p - start); });
  const Vec2 at = file.flat[a];
  const std::uint32_t b = farthest([&](Vec2 p) { return dot(p - at, p - at); });
  const Vec2 way = file.flat[b] - at;
  const std::uint32_t c = farthest([&](Vec2 p) { return std::abs(cross(way, p - at)); });
  return {a, b, c};
}

PanelMotion motion_of(const FoldModel& file, const std::array<std::uint32_t, 3>& anchors,
                      const Pose& pose) {
  const auto [a, b, c] = anchors;
  const Vec2 flat_a = file.flat[a];
  const Vec2 along = file.flat[b] - flat_a;
  const double length = norm(along);
  const Vec2 e1 = (length > 0.0 ? 1.0 / length : 0.0) * along;
  const double side = cross(e1, file.flat[c] - flat_a) < 0.0 ? -1.0 : 1.0;
  const Vec2 e2{-e1.y(), e1.x()};
  // The same frame in space: the first axis towards b, the second towards c's side.
  const Vec3 f1 = unit(pose.at[b] - pose.at[a]);
  const Vec3 toward = pose.at[c] - pose.at[a];
  const Vec3 f2 = side * unit(toward - dot(toward, f1) * f1);
  PanelMotion motion;
  motion.along_u = e1.x() * f1 + e2.x() * f2;
  motion.along_v = e1.y() * f1 + e2.y() * f2;
  motion.normal = cross(f1, f2);
  motion.origin = pose.at[a] - flat_a.x() * motion.along_u - flat_a.y() * motion.along_v;
  return motion;
}

double edge_change(const FoldModel& file, const Pose& pose, std::size_t e) {
  const auto [a, b] = file.edges[e];
  return norm(pose.at[b] - pose.at[a]) - norm(file.flat[b] - file.flat[a]);
}

/// Fold angle about a hinge in degrees: positive if the faces turn towards their face side.
double angle_about(const FoldModel& file, const Hinge& hinge, const PanelMotion& left,
                   const PanelMotion& right) {
  const Vec2 way = file.flat[hinge.to] - file.flat[hinge.from];
  const Vec3 axis = unit(way.x() * left.along_u + way.y() * left.along_v);
  return kDegrees *
         std::atan2(dot(cross(right.normal, left.normal), axis), dot(left.normal, right.normal));
}

/// How far two panels place the ends of their hinge apart.
double gap_mm(const FoldModel& file, const Hinge& hinge, const PanelMotion& left,
              const PanelMotion& right) {
  const auto apart = [&](std::uint32_t v) {
    return norm(left(file.flat[v]) - right(file.flat[v]));
  };
  return std::max(apart(hinge.from), apart(hinge.to));
}

}  // namespace

PanelMotion further(const PanelMotion& from, const PanelMotion& to, double by) {
  PanelMotion motion = to;
  motion.along_u = unit(to.along_u + by * (to.along_u - from.along_u));
  const Vec3 v = to.along_v + by * (to.along_v - from.along_v);
  motion.along_v = unit(v - dot(v, motion.along_u) * motion.along_u);
  motion.normal = cross(motion.along_u, motion.along_v);
  motion.origin = to.origin + by * (to.origin - from.origin);
  return motion;
}

std::string pose_name(const Pose& pose) {
  if (pose.opened) return "the pose " + pose.place;
  const std::string frame = pose.place.empty() ? "the key frame" : "frame " + pose.place;
  return pose.psi_rad ? fmt::format("{} (psi {:.4f})", frame, *pose.psi_rad) : frame;
}

Panels make_panels(const FoldModel& file, const Sheet& sheet) {
  Panels panels;
  panels.vertices = Buckets<std::uint32_t>(sheet.panels, [&](auto&& put) {
    for (std::size_t f = 0; f < file.faces(); ++f)
      for (const std::uint32_t v : face_of(file, f)) put(sheet.panel_of_face[f], v);
  });
  panels.anchors.reserve(sheet.panels);
  for (std::size_t p = 0; p < sheet.panels; ++p)
    panels.anchors.push_back(far_apart(file, panels.vertices[p]));
  return panels;
}

PoseMotion measure(const FoldModel& file, const Sheet& sheet, const Panels& panels,
                   const Pose& pose) {
  PoseMotion result;
  result.least_generic = 1.0;
  result.panel.reserve(sheet.panels);
  for (std::size_t p = 0; p < sheet.panels; ++p) {
    const PanelMotion motion = motion_of(file, panels.anchors[p], pose);
    for (const std::uint32_t v : panels.vertices[p])
      result.isometry_mm = std::max(result.isometry_mm, norm(motion(file.flat[v]) - pose.at[v]));
    result.panel.push_back(motion);
  }
  // In the solver's poses, an edge without a face has no panel that carries it.
  for (std::size_t s = 0; pose.opened && s < sheet.side_edge.size(); ++s) {
    if (sheet.side_edge[s] < 0) continue;
    const auto e = static_cast<std::size_t>(sheet.side_edge[s]);
    result.isometry_mm = std::max(result.isometry_mm, std::abs(edge_change(file, pose, e)));
  }
  for (std::size_t e = 0; !pose.opened && e < file.edges.size(); ++e)
    result.isometry_mm = std::max(result.isometry_mm, std::abs(edge_change(file, pose, e)));
  result.hinge_angle_deg.reserve(sheet.hinges.size());
  for (const Hinge& hinge : sheet.hinges) {
    const std::uint32_t left = sheet.panel_of_face[hinge.left];
    const std::uint32_t right = sheet.panel_of_face[hinge.right];
    result.hinge_gap_mm =
        std::max(result.hinge_gap_mm, gap_mm(file, hinge, result.panel[left], result.panel[right]));
    const double angle = angle_about(file, hinge, result.panel[left], result.panel[right]);
    result.hinge_angle_deg.push_back(angle);
    if (left == right) continue;
    const double bend = std::abs(angle);
    result.sharpest_deg = std::max(result.sharpest_deg, bend);
    result.least_generic = std::min(result.least_generic, std::abs(std::sin(angle / kDegrees)));
    result.shut = result.shut || bend > 180.0 - kFlatOrShut_deg;
    result.bent = result.bent || (bend > kFlatOrShut_deg && bend < 180.0 - kFlatOrShut_deg);
  }
  return result;
}

void check_isometry(const FoldModel& file, const Sheet& sheet, const Pose& pose,
                    const PoseMotion& motion, double limit_mm, VerifyCheck& check) {
  if (motion.isometry_mm > limit_mm) {
    for (std::uint32_t e = 0; e < file.edges.size(); ++e) {
      const double change = edge_change(file, pose, e);
      if (std::abs(change) <= limit_mm) continue;
      const double flat = norm(file.flat[file.edges[e][1]] - file.flat[file.edges[e][0]]);
      check.fail(edge_place(e),
                 fmt::format("the edge is {:.9g} mm long on the sheet, but {:.9g} mm in {}", flat,
                             flat + change, pose_name(pose)));
    }
    for (std::size_t f = 0; f < file.faces(); ++f) {
      double worst = 0.0;
      for (const std::uint32_t v : face_of(file, f)) {
        const Vec3 where = motion.panel[sheet.panel_of_face[f]](file.flat[v]);
        worst = std::max(worst, norm(where - pose.at[v]));
      }
      if (worst <= limit_mm) continue;
      check.fail(face_place(f),
                 fmt::format("the face is bent or sheared in {}: a vertex is off by {:.3g} mm",
                             pose_name(pose), worst));
    }
  }
  if (motion.hinge_gap_mm <= 4.0 * limit_mm) return;
  for (const Hinge& hinge : sheet.hinges) {
    const double gap = gap_mm(file, hinge, motion.panel[sheet.panel_of_face[hinge.left]],
                              motion.panel[sheet.panel_of_face[hinge.right]]);
    if (gap <= 4.0 * limit_mm) continue;
    check.fail(edge_place(hinge.edge),
               fmt::format("the hinge between faces {} and {} opens by {:.3g} mm in {}", hinge.left,
                           hinge.right, gap, pose_name(pose)));
  }
}

double check_fold_angles(const FoldModel& file, const Sheet& sheet, const Pose& pose,
                         const PoseMotion& motion, const std::vector<double>& angle_deg,
                         double limit_deg, VerifyCheck& check) {
  double largest = 0.0;
  for (std::size_t h = 0; h < sheet.hinges.size(); ++h) {
    const std::uint32_t e = sheet.hinges[h].edge;
    const double listed = angle_deg[e];
    if (std::isnan(listed)) continue;
    const double off = std::abs(std::remainder(listed - motion.hinge_angle_deg[h], 360.0));
    largest = std::max(largest, off);
    if (off <= limit_deg) continue;
    check.fail(
        fmt::format("{}/edges_foldAngle/{}", pose.fold_angle_deg.empty() ? "" : pose.place, e),
        fmt::format("{:.6g} degrees are listed, but the fold has {:.6g} in {}", listed,
                    motion.hinge_angle_deg[h], pose_name(pose)));
  }
  for (std::uint32_t e = 0; e < file.edges.size(); ++e) {
    if (holds(file.assignment[e]) || std::isnan(angle_deg[e]) || angle_deg[e] == 0.0) continue;
    check.fail(
        fmt::format("{}/edges_foldAngle/{}", pose.fold_angle_deg.empty() ? "" : pose.place, e),
        fmt::format("{:.6g} degrees are listed for a border or a cut; list 0", angle_deg[e]));
  }
  return largest;
}

void check_assignments(const FoldModel& file, const Sheet& sheet, const Pose& pose,
                       const PoseMotion& motion, double limit_deg, VerifyCheck& check) {
  for (std::size_t h = 0; h < sheet.hinges.size(); ++h) {
    const std::uint32_t e = sheet.hinges[h].edge;
    const Assignment a = file.assignment[e];
    const double angle = motion.hinge_angle_deg[h];
    const bool shut = std::abs(angle) > 180.0 - limit_deg;
    if (a == Assignment::Mountain && angle > limit_deg && !shut) {
      check.fail(edge_place(e),
                 fmt::format("the mountain fold turns as a valley, by {:.6g} degrees, in {}", angle,
                             pose_name(pose)));
    } else if (a == Assignment::Valley && angle < -limit_deg && !shut) {
      check.fail(edge_place(e),
                 fmt::format("the valley fold turns as a mountain, by {:.6g} degrees, in {}", angle,
                             pose_name(pose)));
    }
  }
}

}  // namespace popcut::verify
