// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/drawing/clean.hpp"
#include "core/drawing/nesting.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/geometry/overlap.hpp"

namespace popcut {
namespace {

// Of each border edge on average, and of all: overlaps with others, and others that lie near.
constexpr std::size_t kMostOverlaps = 100, kFewOverlaps = 100'000;
constexpr std::size_t kMostCompared = 2'000, kFewCompared = 1'000'000;

bool flat(const FoldFrame& frame) {
  if (frame.vertices.empty() || (frame.edges.empty() && frame.faces.empty())) return false;
  double low = 1e300, high = -1e300, size = 0.0;
  for (const auto& p : frame.vertices) {
    low = std::min(low, p[2]);
    high = std::max(high, p[2]);
    size = std::max({size, std::abs(p[0]), std::abs(p[1])});
  }
  return high - low <= 1e-6 * std::max(size, 1.0);
}

using Point = std::array<double, 3>;

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The sum of the faces' areas as vectors: it points to the side from which they run
/// counterclockwise. Zero without faces.
Point area_vector(const FoldFrame& frame) {
  Point area{};
  for (const auto& face : frame.faces)
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Point& p = frame.vertices[face[0]];
      const Point a =
          cross(minus(frame.vertices[face[i]], p), minus(frame.vertices[face[i + 1]], p));
      for (std::size_t c = 0; c < 3; ++c) area[c] += a[c];
    }
  return area;
}

/// The unit normal of the plane in which all vertices lie; none if they lie in no plane, or on a
/// line. It points to the side of the faces, else to +z, +y or +x, the first that it can.
std::optional<Point> plane_of(const FoldFrame& frame) {
  if (frame.vertices.size() < 3 || (frame.edges.empty() && frame.faces.empty()))
    return std::nullopt;
  const auto farthest = [&](auto measure) {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < frame.vertices.size(); ++i)
      if (const double d = measure(frame.vertices[i]); d > most) most = d, best = i;
    return frame.vertices[best];
  };
  const Point& p = frame.vertices[0];
  const Point u = minus(farthest([&](const Point& v) { return dot(minus(v, p), minus(v, p)); }), p);
  const double size = std::sqrt(dot(u, u));
  Point n = cross(u, minus(farthest([&](const Point& v) {
                             const Point a = cross(u, minus(v, p));
                             return dot(a, a);
                           }),
                           p));
  const double area = std::sqrt(dot(n, n));
  constexpr double kFlat = 1e-6;
  if (!(area > kFlat * size * size)) return std::nullopt;
  for (double& c : n) c /= area;
  for (const Point& v : frame.vertices)
    if (std::abs(dot(minus(v, p), n)) > kFlat * std::max(size, 1e-300)) return std::nullopt;
  double side = dot(area_vector(frame), n);
  for (const std::size_t axis : {2u, 1u, 0u})
    if (std::abs(side) < 1e-9 * size * size) side = std::abs(n[axis]) > 1e-6 ? n[axis] : 0;
  if (side < 0)
    for (double& c : n) c = -c;
  return n;
}

/// The frame turned so that `normal` points to +z, by the smallest rotation (Rodrigues).
FoldFrame turned_up(FoldFrame frame, const Point& normal) {
  // About the axis k = n x z; v' = v cos + (k x v) sin + k (k.v)(1 - cos).
  const double sine = std::hypot(normal[0], normal[1]), cosine = normal[2];
  const Point k = sine > 1e-12 ? Point{normal[1] / sine, -normal[0] / sine, 0} : Point{1, 0, 0};
  const double height = dot(frame.vertices[0], normal);
  for (Point& v : frame.vertices) {
    const Point turned = cross(k, v);
    const double along = dot(k, v) * (1 - cosine);
    for (std::size_t c = 0; c < 3; ++c) v[c] = v[c] * cosine + turned[c] * sine + k[c] * along;
    v[2] -= height;
  }
  return frame;
}

/// Edges that no list gives, from the faces; and where no edge is a border (B), the sides of one
/// face only become it.
void fill_from_faces(FoldFrame& frame) {
  std::vector<std::array<std::uint32_t, 2>> sides;
  for (const auto& face : frame.faces)
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::uint32_t a = face[i], b = face[(i + 1) % face.size()];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(sides.begin(), sides.end());
  if (frame.edges.empty()) {
    frame.edges = sides;
    frame.edges.erase(std::unique(frame.edges.begin(), frame.edges.end()), frame.edges.end());
    frame.assignments.assign(frame.edges.size(), 'U');
    frame.fold_angles_deg.assign(frame.edges.size(), 0.0);
  }
  const bool bordered =
      std::find(frame.assignments.begin(), frame.assignments.end(), 'B') != frame.assignments.end();
  if (bordered) return;
  std::vector<std::array<std::uint32_t, 2>> border;  // sides of one face
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end] == sides[i]) ++end;
    if (end - i == 1) border.push_back(sides[i]);
    i = end;
  }
  std::vector<std::uint8_t> listed(border.size(), 0);
  for (std::size_t e = 0; e < frame.edges.size(); ++e) {
    const std::array<std::uint32_t, 2> side{std::min(frame.edges[e][0], frame.edges[e][1]),
                                            std::max(frame.edges[e][0], frame.edges[e][1])};
    const auto found = std::lower_bound(border.begin(), border.end(), side);
    if (found == border.end() || *found != side) continue;
    listed[static_cast<std::size_t>(found - border.begin())] = 1;
    if (frame.assignments[e] == 'U') frame.assignments[e] = 'B';
  }
  for (std::size_t k = 0; k < border.size(); ++k) {
    if (listed[k] != 0) continue;
    frame.edges.push_back(border[k]);
    frame.assignments.push_back('B');
    frame.fold_angles_deg.push_back(0.0);
  }
}

/// The first frame that is flat in some plane, looking at +z; folded forms come last.
std::optional<FoldFrame> flat_anywhere(const FoldFile& file) {
  for (const bool folded : {false, true})
    for (const FoldFrame& frame : file.frames) {
      if (frame.folded_form != folded || frame.vertices.empty()) continue;
      if (flat(frame)) return frame;
      if (const auto normal = plane_of(frame)) return turned_up(frame, *normal);
    }
  return std::nullopt;
}

/// Whether a frame in one plane is a model folded flat: its faces show both sides, or without faces
/// two of its corners lie in one place. A crease pattern shows one side; programs name it a folded
/// form, too, so the name alone says little.
bool is_folded_flat(const FoldFrame& frame) {
  bool up = false, down = false;
  for (const std::vector<std::uint32_t>& face : frame.faces) {
    double twice_area = 0.0;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto &a = frame.vertices[face[k]], &b = frame.vertices[face[(k + 1) % face.size()]];
      twice_area += a[0] * b[1] - a[1] * b[0];
    }
    up = up || twice_area > 0.0, down = down || twice_area < 0.0;
  }
  if (!frame.faces.empty()) return up && down;
  auto corners = frame.vertices;
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

/// The parts of 0..length that no interval of `taken` (sorted by start) covers.
std::vector<std::pair<double, double>> free_parts(const std::vector<OverlapIndex::Covered>& taken,
                                                  double length) {
  std::vector<std::pair<double, double>> parts;
  double t = 0.0;
  for (const auto& part : taken) {
    if (part.from > t + kOverlapTolerance) parts.emplace_back(t, part.from);
    t = std::max(t, part.to);
  }
  if (length > t + kOverlapTolerance || t == 0.0) parts.emplace_back(t, length);
  return parts;
}

/// Of border edges between the same points, keeps at most two: the sides of a slit.
void keep_pairs(std::vector<Segment>& borders) {
  for (Segment& s : borders)
    if (s.b < s.a) std::swap(s.a, s.b);
  std::sort(borders.begin(), borders.end(),
            [](const Segment& p, const Segment& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  const auto same = [](const Segment& p, const Segment& q) { return p.a == q.a && p.b == q.b; };
  std::size_t kept = 0;
  for (std::size_t i = 0; i < borders.size(); ++i)
    if (kept < 2 || !same(borders[i], borders[kept - 1]) || !same(borders[i], borders[kept - 2]))
      borders[kept++] = borders[i];
  borders.resize(kept);
}

// Splits each border edge where another one lies on it. The common part is a slit, drawn once; the
// other parts are the sheet's edge.
bool add_borders(std::vector<Segment> borders, LineWork& work) {
  keep_pairs(borders);
  OverlapIndex index(OverlapIndex::cell_for(borders), kOverlapTolerance, borders.size());
  for (std::uint32_t i = 0; i < borders.size(); ++i) index.insert(borders[i], i);
  std::vector<OverlapIndex::Covered> covered, slit;
  std::vector<Segment> edge;
  std::size_t overlaps = 0;
  for (std::uint32_t i = 0; i < borders.size(); ++i) {
    const Segment& s = borders[i];
    const double l = distance(s.a, s.b);
    if (!(l > 0.0)) continue;
    const auto at = [&](double t) { return between(s.a, s.b, t / l); };
    index.covered(s, i, covered);
    overlaps += covered.size();
    if (overlaps > kFewOverlaps + kMostOverlaps * borders.size() ||
        index.compared() > kFewCompared + kMostCompared * borders.size())
      return false;
    for (const auto& [from, to] : free_parts(covered, l)) edge.push_back({at(from), at(to)});
    // Subtract all other edges for the outline, and the earlier ones for the slit's first side.
    slit.clear();
    double t = 0.0;
    for (const auto& part : covered) {
      if (part.from > t + kOverlapTolerance) slit.push_back({t, part.from, i});
      t = std::max(t, part.to);
    }
    if (l > t + kOverlapTolerance) slit.push_back({t, l, i});
    for (const auto& part : covered)
      if (part.by < i) slit.push_back(part);
    std::sort(slit.begin(), slit.end(),
              [](const auto& p, const auto& q) { return p.from < q.from; });
    if (covered.empty()) continue;
    for (const auto& [from, to] : free_parts(slit, l))
      work.append(Operation::Cut, std::array{at(from), at(to)});
  }
  LineWork loops;
  join_loops(edge, 2 * kOverlapTolerance, loops);
  const std::vector<std::uint32_t> depth =
      nesting_depth(loops, std::vector<std::uint8_t>(loops.lines.size(), 1));
  for (std::size_t i = 0; i < loops.lines.size(); ++i)
    work.append(depth[i] % 2 == 0 ? Operation::Outline : Operation::Cut,
                loops.points_of(loops.lines[i]));
  return true;
}

struct UncutEdges {
  std::size_t flat{}, joined{}, unassigned{}, by_angle{}, against_angle{}, empty{};
  void add_warnings(std::vector<Warning>& warnings) const {
    const auto say = [&](std::size_t count, const char* code, const char* what,
                         bool spoils = false) {
      if (count > 0)
        warnings.push_back(
            {.code = code, .message = fmt::format("{} {}", count, what), .spoils = spoils});
    };
    say(flat, "flat_not_cut", "flat creases (F) are not cut");
    say(joined, "join_not_cut", "joins (J) are not cut");
    say(unassigned, "unassigned_not_cut",
        "edges have no assignment (U) and no fold angle; they are not cut", true);
    say(empty, "no_size", "edges have no length and are left out");
    say(against_angle, "fold_against_angle",
        "folds have a fold angle of the other side; their assignment (M or V) counts", true);
    say(by_angle, "fold_by_angle", "unassigned edges become folds by the sign of their fold angle");
  }
};

// Clockwise faces mean that the drawing shows the back of the sheet.
bool seen_from_back(const FoldFrame& frame) {
  double area = 0.0;
  for (const auto& face : frame.faces)
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto& p = frame.vertices[face[i]];
      const auto& q = frame.vertices[face[(i + 1) % face.size()]];
      area += p[0] * q[1] - p[1] * q[0];
    }
  return area < 0.0;
}

/// The lines of a flat frame; `place` is the JSON pointer of its frame.
Result<LineWork> linework_of(FoldFrame frame, const std::string& place,
                             std::optional<double> unit_mm, double enlarged) {
  fill_from_faces(frame);
  const double mm = unit_mm.value_or(fold_unit_mm(frame.unit));
  if (mm == 0.0)
    return fail(
        ErrorKind::Malformed, place + "/frame_unit",
        fmt::format("is {}; use mm, cm, m, in, pt, um, nm or unit", frame.unit.substr(0, 20)));
  LineWork work;
  work.name = frame.title;
  if (!unit_mm && (frame.unit.empty() || frame.unit == "unit")) {
    Box box;
    for (const auto& v : frame.vertices) box.add({v[1], v[0]});
    work.warnings.push_back(
        {.code = "no_unit",
         .message =
             fmt::format("the file gives no unit of length (frame_unit); 1 unit is read as 1 "
                         "mm, and the drawing is {:.4g} x {:.4g} mm; `units`, `width` or "
                         "`scale` gives it another size",
                         box.width(), box.height()),
         .spoils = true});
  }
  if (seen_from_back(frame))
    work.warnings.push_back(
        {.code = "seen_from_back",
         .message = "faces run clockwise: the drawing shows the back of the sheet, where mountains "
                    "look like valleys"});
  std::vector<Segment> borders;
  UncutEdges uncut;
  for (std::size_t e = 0; e < frame.edges.size(); ++e) {
    const auto point = [&](std::uint32_t v) {
      return PagePoint{mm * enlarged * frame.vertices[v][1], mm * enlarged * frame.vertices[v][0]};
    };
    const Segment s{point(frame.edges[e][0]), point(frame.edges[e][1])};
    const double most = kMaxCoordinate * std::max(enlarged, 1.0);
    for (const PagePoint& p : {s.a, s.b})
      if (std::abs(p.x) > most || std::abs(p.y) > most)
        return fail(ErrorKind::OutOfRange, fmt::format("{}/edges_vertices/{}", place, e),
                    "an end lies more than 100 m from the origin");
    const double angle = frame.fold_angles_deg[e];
    if (s.a == s.b) {  // apart from the pattern, it would make it larger
      ++uncut.empty;
      continue;
    }
    const std::array ends{s.a, s.b};
    const char assigned = frame.assignments[e];
    if ((assigned == 'M' && angle > 0.0) || (assigned == 'V' && angle < 0.0)) ++uncut.against_angle;
    switch (frame.assignments[e]) {
      case 'M':
        work.append(Operation::FoldMountain, ends);
        break;
      case 'V':
        work.append(Operation::FoldValley, ends);
        break;
      case 'C':
        work.append(Operation::Cut, ends);
        break;
      case 'B':
        borders.push_back(s);
        break;
      case 'F':
        ++uncut.flat;
        break;
      case 'J':
        ++uncut.joined;
        break;
      default:
        if (angle != 0.0)
          work.append(angle > 0 ? Operation::FoldValley : Operation::FoldMountain, ends);
        ++(angle != 0.0 ? uncut.by_angle : uncut.unassigned);
    }
  }
  if (!add_borders(std::move(borders), work))
    return fail(ErrorKind::OutOfRange, place + "/edges_vertices",
                "too many border edges lie on or beside each other; draw each side of a cut once");
  for (PagePoint& p : work.points) p = {p.x / enlarged, p.y / enlarged};
  // Faces of one panel of a card of parts are joined because of its holes.
  if (!place.empty()) uncut.flat = uncut.joined = 0;
  uncut.add_warnings(work.warnings);
  const bool cuts = std::any_of(work.lines.begin(), work.lines.end(),
                                [](const DrawnLine& line) { return is_cut(line.operation); });
  if (!cuts && !work.lines.empty())
    work.warnings.push_back({.code = "no_outline",
                             .message = "no edge is a border (B) or a cut (C): the sheet is folded "
                                        "but not cut out"});
  return work;
}

}  // namespace

const FoldFrame* flat_frame(const FoldFile& file) {
  for (const bool folded : {false, true})
    for (const FoldFrame& frame : file.frames)
      if (frame.folded_form == folded && flat(frame)) return &frame;
  return nullptr;
}

Result<LineWork> linework_from_fold(std::string_view text, const FoldLimits& limits,
                                    std::optional<double> unit_mm, double enlarged) {
  const auto file = read_fold(text, limits);
  if (!file) return tl::unexpected(file.error());
  std::optional<FoldFrame> frame = flat_anywhere(*file);
  if (!frame)
    return fail(
        ErrorKind::Malformed, "/vertices_coords",
        file->frames.size() == 1 && file->frames[0].edges.empty()
            ? "has vertices, but the file has neither edges_vertices nor faces_vertices; add "
              "the creases"
            : "lie in no plane: this is a folded model; give its flat crease pattern, which "
              "most programs export beside it");
  if (frame->folded_form && is_folded_flat(*frame))
    return fail(ErrorKind::Malformed, "/vertices_coords",
                "are those of a model that is folded flat; give its crease pattern, which most "
                "programs export beside it");
  const auto others = static_cast<std::size_t>(
      std::count_if(file->frames.begin(), file->frames.end(), [&](const FoldFrame& one) {
        const bool is_pattern =
            !one.folded_form && !one.edges.empty() && (flat(one) || plane_of(one).has_value());
        return is_pattern && one.edges != frame->edges;
      }));
  auto work = linework_of(std::move(*frame), "", unit_mm, enlarged);
  if (work && others > 0)
    work->warnings.push_back(
        {.code = "more_patterns",
         .message = fmt::format("the file has {} more crease pattern{}; only the first is read; "
                                "save the one that you want as a file of its own",
                                others, others == 1 ? "" : "s")});
  return work;
}

Result<std::vector<LineWork>> sheets_from_fold(std::string_view text, const FoldLimits& limits,
                                               std::optional<double> unit_mm, double enlarged) {
  std::vector<LineWork> out;
  const auto add = [&](Result<LineWork> one) -> Result<void> {
    if (!one) return tl::unexpected(one.error());
    out.push_back(std::move(*one));
    return {};
  };
  if (!lists_joints(text)) {
    if (auto done = add(linework_from_fold(text, limits, unit_mm, enlarged)); !done)
      return tl::unexpected(done.error());
    return out;
  }
  auto file = read_fold(text, limits);
  if (!file) return tl::unexpected(file.error());
  for (std::size_t k = 0; k < file->frames.size(); ++k) {
    FoldFrame& frame = file->frames[k];
    if (frame.vertices.empty()) continue;
    const std::string place = k == 0 ? "" : fmt::format("/file_frames/{}", k - 1);
    if (!flat(frame))
      return fail(ErrorKind::Malformed, place + "/vertices_coords",
                  "are not flat; give the part as it is cut");
    if (auto done = add(linework_of(std::move(frame), place, unit_mm, enlarged)); !done)
      return tl::unexpected(done.error());
  }
  return out;
}

}  // namespace popcut
