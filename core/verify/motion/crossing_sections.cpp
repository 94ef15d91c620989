// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/verify/motion/crossing.hpp"

namespace popcut::verify {
namespace {

constexpr std::size_t kMostEntries = 60'000'000;
constexpr std::uint64_t kPairBudget = 400'000'000;

/// A side of a face along the folds, where it passes a slab: there the face begins or ends.
struct Entry {
  std::uint32_t slab{};
  std::uint32_t face{};
  double across{};  ///< of the folds
};

/// A face in a section: a line segment.
struct Segment {
  Vec2 from, to;  ///< in section coordinates, mm
  double u0{}, u1{};
  std::uint32_t face{}, panel{};
};

double distance(Vec2 p, const Segment& s) {
  const Vec2 way = s.to - s.from;
  const double length2 = dot(way, way);
  const double t = length2 > 0.0 ? std::clamp(dot(p - s.from, way) / length2, 0.0, 1.0) : 0.0;
  return norm(p - (s.from + t * way));
}

enum class Contact { None, Touch, Cross, Overlap };

bool meets_on_sheet(const Segment& a, const Segment& b, double slack) {
  return std::abs(a.u1 - b.u0) <= slack || std::abs(b.u1 - a.u0) <= slack;
}

Contact contact(const Segment& a, const Segment& b, double slack) {
  // The ends of each segment that lie on the other. Two such places mean that they run along each
  // other.
  std::array<Vec2, 4> on{};
  std::size_t count = 0;
  for (const Vec2& p : {a.from, a.to}) {
    if (distance(p, b) <= slack) on[count++] = p;
  }
  for (const Vec2& p : {b.from, b.to}) {
    if (distance(p, a) <= slack) on[count++] = p;
  }
  for (std::size_t k = 1; k < count; ++k) {
    if (norm(on[k] - on[0]) > 4.0 * slack) return Contact::Overlap;
  }
  const auto near = [&](Vec2 p, Vec2 q) { return norm(p - q) <= slack; };
  const bool shared =
      near(a.from, b.from) || near(a.from, b.to) || near(a.to, b.from) || near(a.to, b.to);
  if (shared && meets_on_sheet(a, b, slack)) return Contact::None;
  if (count > 0) return Contact::Touch;
  const Vec2 way_a = a.to - a.from;
  const Vec2 way_b = b.to - b.from;
  const bool proper =
      (cross(way_a, b.from - a.from) > 0.0) != (cross(way_a, b.to - a.from) > 0.0) &&
      (cross(way_b, a.from - b.from) > 0.0) != (cross(way_b, a.to - b.from) > 0.0);
  return proper ? Contact::Cross : Contact::None;
}

/// The distinct positions of vertices along the folds, ascending; those within `slack` count as
/// one.
std::vector<double> levels(const FoldModel& file, Vec2 axis, double slack) {
  std::vector<double> all;
  all.reserve(file.flat.size());
  for (const Vec2& p : file.flat) all.push_back(dot(p, axis));
  std::sort(all.begin(), all.end());
  std::vector<double> distinct;
  for (const double v : all) {
    if (distinct.empty() || v - distinct.back() > slack) distinct.push_back(v);
  }
  return distinct;
}

std::size_t level_of(const std::vector<double>& levels, double v, double slack) {
  return static_cast<std::size_t>(std::upper_bound(levels.begin(), levels.end(), v + 0.5 * slack) -
                                  levels.begin()) -
         1;
}

/// Section coordinates of a pose: two directions perpendicular to the folds.
struct Section {
  Vec3 across, up;
  [[nodiscard]] Vec2 operator()(Vec3 p) const { return {dot(p, across), dot(p, up)}; }
};

Section section_of(Vec3 axis) {
  Vec3 across = Vec3{1.0, 0.0, 0.0} - axis.x() * axis;
  if (norm(across) < 0.1) across = Vec3{0.0, 0.0, 1.0} - axis.z() * axis;
  across = unit(across);
  return {across, cross(across, axis)};
}

const char* words(Contact contact) {
  return contact == Contact::Cross ? "cross" : contact == Contact::Touch ? "touch" : "overlap";
}

/// The sides of faces along the folds, slab by slab; none if there are too many.
std::optional<std::vector<Entry>> slab_entries(const FoldModel& file, const Sheet& sheet, Vec2 axis,
                                               const std::vector<double>& level, double slack) {
  const Vec2 square{axis.y(), -axis.x()};
  std::vector<Entry> entries;
  for (std::uint32_t s = 0; s < sheet.side_face.size(); ++s) {
    const Vec2 from = file.flat[file.face_vertices[s]];
    const Vec2 to = file.flat[file.face_vertices[sheet.next(file, s)]];
    std::size_t begin = level_of(level, dot(from, axis), slack);
    std::size_t end = level_of(level, dot(to, axis), slack);
    if (begin > end) std::swap(begin, end);
    if (entries.size() + (end - begin) > kMostEntries) return {};
    for (std::size_t slab = begin; slab < end; ++slab)
      entries.push_back({static_cast<std::uint32_t>(slab), sheet.side_face[s], dot(from, square)});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tuple(a.slab, a.face, a.across) < std::tuple(b.slab, b.face, b.across);
  });
  return entries;
}

/// Calls `visit(a, b)` for segments whose extents across the section meet. Sorts the segments.
/// @return false if more than `budget` pairs were visited
template <typename Visit>
bool each_near_pair(std::vector<Segment>& segments, double slack, std::uint64_t& budget,
                    Visit visit) {
  const auto low = [](const Segment& s) { return std::min(s.from.x(), s.to.x()); };
  std::sort(segments.begin(), segments.end(),
            [&](const Segment& a, const Segment& b) { return low(a) < low(b); });
  for (std::size_t a = 0; a < segments.size(); ++a) {
    const double high = std::max(segments[a].from.x(), segments[a].to.x()) + slack;
    for (std::size_t b = a + 1; b < segments.size() && low(segments[b]) <= high; ++b) {
      if (budget == 0) return false;
      --budget;
      if (segments[a].panel != segments[b].panel) visit(segments[a], segments[b]);
    }
  }
  return true;
}

}  // namespace

std::optional<Vec2> common_fold_direction(const FoldModel& file, const Sheet& sheet,
                                          double slack_mm) {
  std::optional<Vec2> axis;
  for (const Hinge& hinge : sheet.hinges) {
    if (sheet.panel_of_face[hinge.left] == sheet.panel_of_face[hinge.right]) continue;
    const Vec2 way = file.flat[hinge.to] - file.flat[hinge.from];
    if (!(norm(way) > 0.0)) return {};
    if (!axis) axis = (1.0 / norm(way)) * way;
    if (std::abs(cross(*axis, way)) > slack_mm) return {};
  }
  if (!axis) return {};
  for (const auto& [a, b] : file.edges) {
    const Vec2 way = file.flat[b] - file.flat[a];
    if (std::abs(cross(*axis, way)) > slack_mm && std::abs(dot(*axis, way)) > slack_mm) return {};
  }
  return axis;
}

bool in_two_directions(const Sheet& sheet, const PoseMotion& motion, Vec2 axis) {
  const Vec2 square{axis.y(), -axis.x()};
  const auto direction = [&](std::size_t p) -> Vec3 {
    return square.x() * motion.panel[p].along_u + square.y() * motion.panel[p].along_v;
  };
  std::optional<Vec3> second;
  const Vec3 first = direction(0);
  for (std::size_t p = 1; p < sheet.panels; ++p) {
    const Vec3 d = direction(p);
    if (norm(d - first) <= 1e-6) continue;
    if (!second) second = d;
    if (norm(d - *second) > 1e-6) return false;
  }
  return true;
}

bool check_sections(const FoldModel& file, const Sheet& sheet, Vec2 axis, const PoseMotion& motion,
                    double slack_mm, VerifyCheck& check) {
  const Vec2 square{axis.y(), -axis.x()};
  const std::vector<double> level = levels(file, axis, slack_mm);
  const auto entries = slab_entries(file, sheet, axis, level, slack_mm);
  if (!entries) return false;
  const Section section =
      section_of(unit(axis.x() * motion.panel[0].along_u + axis.y() * motion.panel[0].along_v));
  std::set<std::pair<std::uint32_t, std::uint32_t>> reported;
  std::vector<Segment> segments;
  std::uint64_t budget = kPairBudget;
  for (std::size_t i = 0; i < entries->size();) {
    // 1. The faces of one slab, each from a side where it begins to a side where it ends.
    const std::uint32_t slab = (*entries)[i].slab;
    const double v = 0.5 * (level[slab] + level[slab + 1]);
    segments.clear();
    for (; i + 1 < entries->size() && (*entries)[i + 1].slab == slab; i += 2) {
      const Entry& from = (*entries)[i];
      const Entry& to = (*entries)[i + 1];
      const std::uint32_t panel = sheet.panel_of_face[from.face];
      const auto at = [&](double u) { return section(motion.panel[panel](u * square + v * axis)); };
      segments.push_back(
          {at(from.across), at(to.across), from.across, to.across, from.face, panel});
    }
    while (i < entries->size() && (*entries)[i].slab == slab) ++i;
    // 2. No two of them meet, except where the sheet continues from one to the other.
    const bool all =
        each_near_pair(segments, slack_mm, budget, [&](const Segment& a, const Segment& b) {
          const Contact found = contact(a, b, slack_mm);
          const auto [f, g] = std::minmax(a.face, b.face);
          if (found == Contact::None || reported.size() > kMostReported ||
              !reported.emplace(f, g).second)
            return;
          const Vec3 where = motion.panel[a.panel](0.5 * (a.u0 + a.u1) * square + v * axis);
          check.fail(face_place(g),
                     fmt::format("faces {} and {} {} near ({:.6g}, {:.6g}, {:.6g})", f, g,
                                 words(found), where.x(), where.y(), where.z()));
        });
    if (!all) return false;
  }
  return true;
}

}  // namespace popcut::verify
