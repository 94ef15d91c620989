// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/cell_grid.hpp"
#include "core/verify/motion/crossing.hpp"

namespace popcut::verify {
namespace {

using Box = Eigen::AlignedBox3d;

constexpr std::size_t kMostMarked = 3000;  ///< faces whose pairs are marked, in 1.1 MB

struct Interval {
  double from{}, to{};
};

bool apart(const Box& a, const Box& b, double slack) {
  return (a.min().array() > b.max().array() + slack).any() ||
         (b.min().array() > a.max().array() + slack).any();
}

/// Where a line cuts a polygon, if corners within `slack` of the line count as lying on its side
/// `lean`. `off` holds each corner's distance from the line, `along` its position along the line.
std::vector<Interval> cut_leaning(const std::vector<double>& off, const std::vector<double>& along,
                                  double slack, bool lean) {
  const auto side = [&](std::size_t k) { return std::abs(off[k]) <= slack ? lean : off[k] > 0.0; };
  std::vector<double> at;
  for (std::size_t k = 0; k < off.size(); ++k) {
    const std::size_t l = k + 1 == off.size() ? 0 : k + 1;
    if (side(k) != side(l))
      at.push_back(along[k] + off[k] / (off[k] - off[l]) * (along[l] - along[k]));
  }
  std::sort(at.begin(), at.end());
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i + 1 < at.size(); i += 2) intervals.push_back({at[i], at[i + 1]});
  return intervals;
}

std::vector<Interval> common(const std::vector<Interval>& a, const std::vector<Interval>& b) {
  std::vector<Interval> result;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const Interval both{std::max(a[i].from, b[j].from), std::min(a[i].to, b[j].to)};
    if (both.from < both.to) result.push_back(both);
    a[i].to < b[j].to ? ++i : ++j;
  }
  return result;
}

/// One pose's faces as planar polygons in space.
class FacesInSpace {
 public:
  FacesInSpace(const FoldModel& file, const Sheet& sheet, const Pose& pose,
               const PoseMotion& motion, double slack)
      : file_(file), sheet_(sheet), pose_(pose), motion_(motion), slack_(slack) {
    boxes_.reserve(file.faces());
    in_plane_.reserve(file.faces());
    for (std::size_t f = 0; f < file.faces(); ++f) {
      const PanelMotion& own = this->motion(static_cast<std::uint32_t>(f));
      Box box, in_plane;
      for (const std::uint32_t v : face_of(file, f)) {
        const Vec3& p = pose.at[v];
        box.extend(p);
        const Vec3 off = p - own.origin;
        in_plane.extend(Vec3{dot(own.along_u, off), dot(own.along_v, off), dot(own.normal, off)});
      }
      boxes_.push_back(box);
      in_plane_.push_back(in_plane);
    }
  }

  [[nodiscard]] const Box& box(std::size_t f) const { return boxes_[f]; }
  [[nodiscard]] const PanelMotion& motion(std::uint32_t f) const {
    return motion_.panel[sheet_.panel_of_face[f]];
  }

  enum class Relation { Apart, Cross, SamePlane };

  /// How face `g` lies relative to face `f`. `where` gets a point of the crossing.
  Relation relation(std::uint32_t f, std::uint32_t g, Vec3& where) const {
    if (apart(boxes_[f], boxes_[g], slack_) || is_beside(g, f) || is_beside(f, g))
      return Relation::Apart;
    std::vector<double> g_off;
    std::vector<double> f_off;
    g_off.reserve(face_of(file_, g).size());
    f_off.reserve(face_of(file_, f).size());
    const Straddle of_g = distances(g, f, g_off);
    if (of_g == Straddle::Lies) return Relation::SamePlane;
    if (of_g == Straddle::Beside || distances(f, g, f_off) != Straddle::Through)
      return Relation::Apart;
    const Vec3 line = unit(cross(motion(f).normal, motion(g).normal));
    if (norm(line) < 0.5) return Relation::Apart;
    const auto inside = common(interior(f, f_off, line), interior(g, g_off, line));
    for (const Interval& part : inside) {
      if (part.to - part.from <= 4.0 * slack_) continue;
      where = point_on_line(f, g, line, 0.5 * (part.from + part.to));
      return Relation::Cross;
    }
    return Relation::Apart;
  }

 private:
  enum class Straddle { Beside, Through, Lies };

  /// Whether the box of face `g` in its own plane is on one side of the plane of face `f`, and not
  /// all of it in that plane.
  [[nodiscard]] bool is_beside(std::uint32_t g, std::uint32_t f) const {
    const PanelMotion &plane = motion(f), &own = motion(g);
    const Box& box = in_plane_[g];
    const Vec3 middle = box.center(), half = 0.5 * box.sizes();
    const double at =
        dot(plane.normal, Vec3(own.origin + middle.x() * own.along_u + middle.y() * own.along_v +
                               middle.z() * own.normal - plane.origin));
    const double reach = half.x() * std::abs(dot(plane.normal, own.along_u)) +
                         half.y() * std::abs(dot(plane.normal, own.along_v)) +
                         half.z() * std::abs(dot(plane.normal, own.normal));
    return std::abs(at) - reach >= -slack_ && std::abs(at) + reach > 2.0 * slack_;
  }

  /// Distances of the corners of face `g` from the plane of face `f`.
  Straddle distances(std::uint32_t g, std::uint32_t f, std::vector<double>& off) const {
    const PanelMotion& plane = motion(f);
    double low = 0.0;
    double high = 0.0;
    for (const std::uint32_t v : face_of(file_, g)) {
      const double d = dot(plane.normal, pose_.at[v] - plane.origin);
      off.push_back(d);
      low = std::min(low, d);
      high = std::max(high, d);
    }
    if (low >= -slack_ && high <= slack_) return Straddle::Lies;
    return low >= -slack_ || high <= slack_ ? Straddle::Beside : Straddle::Through;
  }

  /// The stretches of the line that stay strictly inside face `f`, even if the line shifts by the
  /// slack.
  [[nodiscard]] std::vector<Interval> interior(std::uint32_t f, const std::vector<double>& off,
                                               const Vec3& line) const {
    std::vector<double> along;
    along.reserve(off.size());
    for (const std::uint32_t v : face_of(file_, f)) along.push_back(dot(line, pose_.at[v]));
    return common(cut_leaning(off, along, slack_, true), cut_leaning(off, along, slack_, false));
  }

  [[nodiscard]] Vec3 point_on_line(std::uint32_t f, std::uint32_t g, const Vec3& line,
                                   double t) const {
    const Vec3 n = motion(f).normal;
    const Vec3 m = motion(g).normal;
    const double a = dot(n, motion(f).origin);
    const double b = dot(m, motion(g).origin);
    const double c = dot(n, m);
    const double s = 1.0 / (1.0 - c * c);
    return s * (a - b * c) * n + s * (b - a * c) * m + t * line;
  }

  const FoldModel& file_;
  const Sheet& sheet_;
  const Pose& pose_;
  const PoseMotion& motion_;
  double slack_;
  std::vector<Box> boxes_, in_plane_;
};

/// The area that two faces in one plane share, measured in the plane of `f`.
double shared_area(const Triangles& triangles, const Pose& pose, const PanelMotion& plane,
                   std::uint32_t f, std::uint32_t g, double& reach) {
  const auto corners = [&](std::uint32_t t) {
    std::array<Vec2, 3> shape{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = pose.at[triangles.corners[t][k]] - plane.origin;
      shape[k] = {dot(p, plane.along_u), dot(p, plane.along_v)};
    }
    if (cross(shape[1] - shape[0], shape[2] - shape[0]) < 0.0) std::swap(shape[1], shape[2]);
    return shape;
  };
  double shared = 0.0;
  for (std::uint32_t s = triangles.first[f]; s < triangles.first[f + 1]; ++s) {
    const auto a = corners(s);
    for (std::uint32_t t = triangles.first[g]; t < triangles.first[g + 1]; ++t) {
      const auto b = corners(t);
      shared += common_area(a, b);
      reach = std::max(reach, std::min(norm(a[1] - a[0]) + norm(a[2] - a[0]),
                                       norm(b[1] - b[0]) + norm(b[2] - b[0])));
    }
  }
  return shared;
}

}  // namespace

Meetings meeting_faces(const FoldModel& file, const Sheet& sheet, const Triangles& triangles,
                       const Pose& pose, const PoseMotion& motion, double slack_mm,
                       const std::function<bool(std::uint32_t, std::uint32_t)>& is_known) {
  const FacesInSpace space(file, sheet, pose, motion, slack_mm);
  Box all = space.box(0);
  for (std::size_t f = 1; f < file.faces(); ++f) all.extend(space.box(f));
  // Sorts faces into cells, seen along the direction in which the structure is thinnest.
  const Vec3 size = all.sizes();
  const int thin = size.x() <= size.y() && size.x() <= size.z() ? 0 : size.y() <= size.z() ? 1 : 2;
  const auto seen = [&](Vec3 p) {
    return thin == 0 ? Vec2{p.y(), p.z()} : thin == 1 ? Vec2{p.x(), p.z()} : Vec2{p.x(), p.y()};
  };
  const auto corners = [&](std::size_t f) {
    const Vec2 a = seen(space.box(f).min());
    const Vec2 c = seen(space.box(f).max());
    return std::array<Vec2, 4>{a, Vec2{c.x(), a.y()}, c, Vec2{a.x(), c.y()}};
  };
  Meetings met;
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen_pairs;
  const CellGrid grid(file.faces(), slack_mm, corners);
  // Large faces share many cells.
  std::vector<bool> compared(file.faces() <= kMostMarked ? file.faces() * file.faces() : 0, false);
  met.complete = grid.each_pair(4 * pair_budget(file.faces()), [&](std::uint32_t f,
                                                                   std::uint32_t g) {
    if (sheet.panel_of_face[f] == sheet.panel_of_face[g] || met.pairs.size() > kMostReported)
      return;
    if (!compared.empty()) {
      auto is_done = compared[f * file.faces() + g];
      if (is_done) return;
      is_done = true;
    }
    if (is_known && is_known(sheet.panel_of_face[f], sheet.panel_of_face[g])) return;
    MeetingFaces pair{.f = f, .g = g, .crosses = false, .where = Vec3::Zero(), .overlap_mm2 = 0.0};
    const auto relation = space.relation(f, g, pair.where);
    pair.crosses = relation == FacesInSpace::Relation::Cross;
    if (relation == FacesInSpace::Relation::SamePlane && !motion.shut) {
      double reach = 0.0;
      const double shared = shared_area(triangles, pose, space.motion(f), f, g, reach);
      if (shared > 4.0 * slack_mm * (reach + slack_mm)) pair.overlap_mm2 = shared;
    }
    if ((pair.crosses || pair.overlap_mm2 > 0.0) && seen_pairs.emplace(f, g).second)
      met.pairs.push_back(pair);
  });
  return met;
}

void check_faces_apart(const FoldModel& file, const Sheet& sheet, const Triangles& triangles,
                       const Pose& pose, const PoseMotion& motion, double slack_mm,
                       VerifyCheck& check) {
  const Meetings met = meeting_faces(file, sheet, triangles, pose, motion, slack_mm);
  for (const MeetingFaces& pair : met.pairs)
    check.fail(
        face_place(pair.g),
        pair.crosses
            ? fmt::format("faces {} and {} cross near ({:.6g}, {:.6g}, {:.6g}) in {}", pair.f,
                          pair.g, pair.where.x(), pair.where.y(), pair.where.z(), pose_name(pose))
            : fmt::format("faces {} and {} overlap by {:.6g} mm2 in {}", pair.f, pair.g,
                          pair.overlap_mm2, pose_name(pose)));
  if (!met.complete) check.not_judged("too many faces lie in one place to compare them");
}

}  // namespace popcut::verify
