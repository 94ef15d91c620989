// SPDX-License-Identifier: MIT
#include "core/parts/structure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace popcut {
namespace {

using Eigen::Isometry3d;

constexpr double kSame_mm = 1e-7;

Vec3 on_sheet(Vec2 p) { return {p.x(), p.y(), 0.0}; }

Isometry3d axes(const Vec3& origin, const Vec3& x, const Vec3& y, const Vec3& z) {
  Isometry3d out = Isometry3d::Identity();
  out.linear().col(0) = x, out.linear().col(1) = y, out.linear().col(2) = z;
  out.translation() = origin;
  return out;
}

/// Places of the faces that are glued, once those they are glued to have theirs.
void place_tabs(const Structure& card, std::size_t first, std::size_t count, PartPoses& pose,
                std::vector<std::vector<bool>>& known) {
  for (bool any = true; any;) {
    any = false;
    for (const PartJoint& joint : card.joints) {
      const PartSide &a = joint.a, &b = joint.b;
      if (joint.kind != PartJointKind::Glue || a.part < first || a.part >= first + count ||
          known[a.part][a.face] || !known[b.part][b.face])
        continue;
      pose[a.part][a.face] = pose[b.part][b.face] * glued(a.line, b.line, joint.turned);
      known[a.part][a.face] = any = true;
    }
  }
}

SeatFrame frame_of(const Seat& seat, const PartPoses& pose) {
  const auto direction = [&](const SeatSide& side, Vec2 d) {
    return Vec3(pose[side.part][side.face].linear() * on_sheet(d));
  };
  const Vec3 right = direction(seat.right, seat.right.away),
             left = direction(seat.left, seat.left.away),
             along = direction(seat.right, seat.right.along);
  // Near an opening of pi the sum of both vanishes, and their difference does near 0.
  Vec3 x = right - left, z = right + left;
  const double wide = norm(x), high = norm(z);
  if (wide > high) {
    x /= wide, z = cross(x, along);
  } else {
    z /= high, x = cross(along, z);
  }
  const Vec3 origin = pose[seat.right.part][seat.right.face] * on_sheet(seat.right.origin);
  return {axes(origin, x, along, z), 2.0 * std::atan2(wide, high)};
}

}  // namespace

std::uint32_t SheetPart::add_face(std::span<const Vec2> corners) {
  std::vector<std::uint32_t> face;
  for (const Vec2& p : corners) {
    std::uint32_t v = 0;
    while (v < vertices.size() && norm(Vec2(vertices[v] - p)) > kSame_mm) ++v;
    if (v == vertices.size()) vertices.push_back(p);
    face.push_back(v);
  }
  double twice = 0.0;
  for (std::size_t k = 0; k < face.size(); ++k)
    twice += cross(vertices[face[k]], vertices[face[(k + 1) % face.size()]]);
  if (twice < 0.0) std::reverse(face.begin(), face.end());
  faces.push_back(std::move(face));
  return static_cast<std::uint32_t>(faces.size() - 1);
}

void SheetPart::add_corner(Vec2 at) {
  std::uint32_t v = 0;
  while (v < vertices.size() && norm(Vec2(vertices[v] - at)) > kSame_mm) ++v;
  for (auto& face : faces) {
    if (std::find(face.begin(), face.end(), v) != face.end()) continue;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Vec2 p = vertices[face[k]], q = vertices[face[(k + 1) % face.size()]];
      const Vec2 d = unit(Vec2(q - p)), to = at - p;
      const double along = dot(to, d);
      if (std::abs(cross(d, to)) > kSame_mm || along < kSame_mm ||
          along > norm(Vec2(q - p)) - kSame_mm)
        continue;
      if (v == vertices.size()) vertices.push_back(at);
      face.insert(face.begin() + static_cast<std::ptrdiff_t>(k) + 1, v);
      break;
    }
  }
}

bool SheetPart::is_slit(std::uint32_t from, std::uint32_t to) const {
  const Vec2 p = vertices[from], q = vertices[to];
  return std::any_of(slits.begin(), slits.end(), [&](const FlatLine& line) {
    const Vec2 d = unit(Vec2(line[1] - line[0]));
    const double length = norm(Vec2(line[1] - line[0]));
    const auto lies_on = [&](Vec2 at) {
      const double along = dot(Vec2(at - line[0]), d);
      return std::abs(cross(d, Vec2(at - line[0]))) <= kSame_mm && along >= -kSame_mm &&
             along <= length + kSame_mm;
    };
    return lies_on(p) && lies_on(q);
  });
}

Vec3 SeatFrame::out(double side) const {
  return {side * std::sin(0.5 * opening_rad), 0.0, std::cos(0.5 * opening_rad)};
}

Structure plain_card(double page_mm, double length_mm) {
  Structure card;
  card.page_mm = page_mm, card.length_mm = length_mm;
  SheetPart pages;
  pages.name = "card";
  for (const double side : {-1.0, 1.0})
    pages.add_face(std::array{Vec2{0.0, 0.0}, Vec2{side * page_mm, 0.0},
                              Vec2{side * page_mm, length_mm}, Vec2{0.0, length_mm}});
  card.parts.push_back(std::move(pages));
  return card;
}

Seat spine_of(const Structure&) {
  const Vec2 origin{0.0, 0.0}, along{0.0, 1.0};
  return {{0, 0, origin, along, {-1.0, 0.0}}, {0, 1, origin, along, {1.0, 0.0}}};
}

Isometry3d laid(const std::array<Vec2, 3>& flat, const std::array<Vec3, 3>& space) {
  const auto frame = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 x = unit(Vec3(b - a));
    const Vec3 z = unit(cross(x, Vec3(c - a)));
    return axes(a, x, cross(z, x), z);
  };
  return frame(space[0], space[1], space[2]) *
         frame(on_sheet(flat[0]), on_sheet(flat[1]), on_sheet(flat[2])).inverse();
}

Isometry3d glued(const FlatLine& from, const FlatLine& to, bool turned) {
  const auto frame = [](const FlatLine& line, double up) {
    const Vec3 x = unit(Vec3(on_sheet(line[1]) - on_sheet(line[0]))), z{0.0, 0.0, up};
    return axes(on_sheet(line[0]), x, cross(z, x), z);
  };
  return frame(to, turned ? -1.0 : 1.0) * frame(from, 1.0).inverse();
}

double tab_depth_mm(const Structure& card, double fold_mm) {
  return std::min(card.tab_mm, 0.45 * fold_mm);
}

void add_tab(Structure& card, std::size_t part, const FlatLine& fold, std::size_t on_part,
             std::uint32_t on_face, const FlatLine& to, bool on_left) {
  SheetPart& sheet = card.parts[part];
  for (const Vec2& end : fold) sheet.add_corner(end);
  const Vec2 along = fold[1] - fold[0];
  const double length = norm(along);
  const Vec2 d = along / length, left{-d.y(), d.x()};
  const auto lies = [&](Vec2 a) { return std::abs(dot(Vec2(a - fold[0]), left)) <= kSame_mm; };
  // The tab is on the other side of the fold than the panel, whose border runs along it.
  bool is_left = true;
  for (const auto& corners : sheet.faces)
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec2 p = sheet.vertices[corners[k]],
                 q = sheet.vertices[corners[(k + 1) % corners.size()]];
      if (!lies(p) || !lies(q)) continue;
      const double from = dot(Vec2(p - fold[0]), d), end = dot(Vec2(q - fold[0]), d);
      if (std::max(from, end) < 0.5 * length || std::min(from, end) > 0.5 * length) continue;
      is_left = end < from;  // a panel is on the left of its own border
    }
  const double depth = tab_depth_mm(card, length), side = is_left ? 1.0 : -1.0;
  const std::uint32_t tab =
      sheet.add_face(std::array{fold[0], fold[1], Vec2(fold[1] - depth * d + side * depth * left),
                                Vec2(fold[0] + depth * d + side * depth * left)});
  sheet.tabs.push_back(tab);
  // Where the panel is of several faces, the fold has a corner at each border of them.
  for (const Vec2& at : std::vector<Vec2>(sheet.vertices))
    if (lies(at)) sheet.add_corner(at);
  card.joints.push_back(
      {PartJointKind::Glue, {part, tab, fold}, {on_part, on_face, to}, is_left != on_left});
}

void turn_over(Structure& card, std::size_t part) {
  const auto turn = [](Vec2& p) { p.x() = -p.x(); };
  SheetPart& sheet = card.parts[part];
  for (Vec2& p : sheet.vertices) turn(p);
  for (auto& face : sheet.faces) std::reverse(face.begin(), face.end());
  for (FlatLine& slit : sheet.slits)
    for (Vec2& p : slit) turn(p);
  for (PartJoint& joint : card.joints)
    for (PartSide* side : {&joint.a, &joint.b}) {
      if (side->part != part) continue;
      for (Vec2& p : side->line) turn(p);
      joint.turned = !joint.turned;
    }
  for (Element& element : card.elements) {
    if (part < element.first_part || part >= element.first_part + element.parts) continue;
    element.pose = [own = part - element.first_part, before = element.pose](const SeatFrame& at) {
      PartPoses out = before(at);
      for (Isometry3d& face : out[own])
        face = face * Eigen::AngleAxisd(std::acos(-1.0), Vec3{0.0, 1.0, 0.0});
      return out;
    };
  }
}

PartPoses posed(const Structure& card, double opening_rad) {
  PartPoses pose;
  std::vector<std::vector<bool>> known;
  for (const SheetPart& part : card.parts) {
    pose.emplace_back(part.faces.size(), Isometry3d::Identity());
    known.emplace_back(part.faces.size(), false);
  }
  const Isometry3d upright(Eigen::AngleAxisd(std::acos(-1.0) - opening_rad, Vec3{0.0, 1.0, 0.0}));
  pose[0][card.pages[0]] = upright;
  const Vec3 both{1.0 + std::cos(opening_rad), 0.0, std::sin(opening_rad)};
  for (std::size_t f = 0; f < card.planes.size(); ++f) {
    const SheetPlane& plane = card.planes[f];
    pose[0][f] = Eigen::Translation3d(plane.offset_mm * both) *
                 (plane.upright ? upright : Isometry3d::Identity());
  }
  known[0].assign(known[0].size(), true);
  for (const Element& element : card.elements) {
    const SeatFrame frame = frame_of(element.seat, pose);
    const PartPoses own = element.pose(frame);
    for (std::size_t p = 0; p < own.size(); ++p)
      for (std::size_t f = 0; f < own[p].size(); ++f) {
        pose[element.first_part + p][f] = frame.to_space * own[p][f];
        known[element.first_part + p][f] = true;
      }
    place_tabs(card, element.first_part, element.parts, pose, known);
  }
  return pose;
}

std::vector<PartFold> folds_of(const SheetPart& part, std::span<const Isometry3d> pose) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> face_left_of;
  for (std::uint32_t f = 0; f < part.faces.size(); ++f)
    for (std::size_t k = 0; k < part.faces[f].size(); ++k)
      face_left_of[{part.faces[f][k], part.faces[f][(k + 1) % part.faces[f].size()]}] = f;
  std::vector<PartFold> out;
  for (const auto& [ends, left] : face_left_of) {
    if (ends.first > ends.second) continue;
    const auto other = face_left_of.find({ends.second, ends.first});
    if (other == face_left_of.end()) continue;
    const Isometry3d &l = pose[left], &r = pose[other->second];
    const Vec3 along =
        unit(Vec3(r.linear() * on_sheet(part.vertices[ends.second] - part.vertices[ends.first])));
    const Vec3 from = r.linear().col(2), to = l.linear().col(2);
    out.push_back({ends.first, ends.second, left, other->second,
                   std::atan2(dot(along, cross(from, to)), dot(from, to))});
  }
  return out;
}

}  // namespace popcut
