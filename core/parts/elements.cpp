// SPDX-License-Identifier: MIT
#include "core/parts/elements.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

using Eigen::Isometry3d;

constexpr double kPiRad = std::numbers::pi;
constexpr double kAlike = 1e-9;  ///< of rad and mm: sums that are to be equal

Vec3 at_y(const Vec3& section, double y) { return section + Vec3{0.0, y, 0.0}; }

/// The slopes of a gabled roof, from wall to ridge.
double slope_mm(const BoxElement& e) { return std::hypot(e.half_mm, e.rise_mm); }

/// Each half of an end, from a wall to its fold.
double half_end_mm(const BoxElement& e) { return std::hypot(e.half_mm, e.bend_mm); }

constexpr double kLeastApart_rad = radians(20.0);

/// From the tops of the walls to the top of a pyramid.
double pyramid_top_mm(const BoxElement& e, double opening_rad) {
  return std::hypot(e.rise_mm, e.half_mm * std::cos(0.5 * opening_rad));
}

/// The roof of a pyramid on its sheet: triangles around its top, counter-clockwise as seen from
/// above. It begins at the right slope; without slopes at its far end, at the left one.
struct PyramidFan {
  double side_rad{}, end_rad{};      ///< half of the angle of a slope at the top
  double edge_mm{}, end_mm{};        ///< from the top to a corner, and to the middle of an end
  std::vector<std::size_t> corners;  ///< of its rim: of the eight of `in_space`
  std::vector<Vec2> rim;

  explicit PyramidFan(const BoxElement& e) {
    const double half_length = 0.5 * (e.to_mm - e.from_mm);
    side_rad = std::atan2(half_length, slope_mm(e));
    end_mm = std::hypot(half_length + e.hip_bend_mm, e.rise_mm);
    edge_mm = std::hypot(half_length, slope_mm(e));
    const double half_foot = std::hypot(e.half_mm, e.hip_bend_mm);
    end_rad = std::acos((edge_mm * edge_mm + end_mm * end_mm - half_foot * half_foot) /
                        (2.0 * edge_mm * end_mm));
    const std::size_t first = e.has_hips[1] ? 0 : 3, last = !e.has_hips[1]  ? 7
                                                            : e.has_hips[0] ? 6
                                                                            : 4;
    double at = 0.0;
    for (std::size_t k = first; k <= last; ++k) {
      const bool is_end = k == 2 || k == 5;
      rim.emplace_back((is_end ? end_mm : edge_mm) * Vec2{std::cos(at), std::sin(at)});
      corners.push_back(k);
      at += k == 0 || k == 3 || k == 6 ? 2.0 * side_rad : end_rad;
    }
  }

  [[nodiscard]] bool is_closed() const { return corners.size() == 7; }
  /// The angle between its first and its last border, where the sheet is open.
  [[nodiscard]] double apart_rad() const { return 2.0 * kPiRad - 4.0 * (side_rad + end_rad); }
  /// Where a corner of `in_space` is on its rim.
  [[nodiscard]] Vec2 place(std::size_t corner) const {
    return rim[static_cast<std::size_t>(std::find(corners.begin(), corners.end(), corner) -
                                        corners.begin())];
  }
  /// Its foot around it, from the right corner at the beginning on, and its top, in the axes of the
  /// seat. The first and the last two of eight corners are the same.
  [[nodiscard]] static std::array<Vec3, 9> in_space(const BoxElement& e, double opening_rad) {
    const double a = e.half_mm, s = std::sin(0.5 * opening_rad), c = std::cos(0.5 * opening_rad);
    const double low = e.height_mm + a * c, middle = 0.5 * (e.from_mm + e.to_mm);
    const Vec2 foot = hip_foot(e, opening_rad);
    const Vec3 right_from{a * s, e.from_mm, low}, right_to{a * s, e.to_mm, low},
        base{0.0, middle, low};
    return {right_from,
            right_to,
            base + Vec3{0.0, foot.x(), foot.y()},
            Vec3{-a * s, e.to_mm, low},
            Vec3{-a * s, e.from_mm, low},
            base + Vec3{0.0, -foot.x(), foot.y()},
            right_from,
            right_to,
            base + Vec3{0.0, 0.0, pyramid_top_mm(e, opening_rad)}};
  }

  /// Its faces, in the axes of the seat.
  [[nodiscard]] std::vector<Isometry3d> pose(const BoxElement& e, double opening_rad) const {
    const std::array<Vec3, 9> at = in_space(e, opening_rad);
    std::vector<Isometry3d> faces;
    for (std::size_t k = 0; k + 1 < rim.size(); ++k)
      faces.push_back(
          laid({Vec2{0.0, 0.0}, rim[k], rim[k + 1]}, {at[8], at[corners[k]], at[corners[k + 1]]}));
    return faces;
  }
};

/// A strip of paper: folds across it at `at`, from `v0` to `v1` along its folds.
void add_strip(SheetPart& part, const std::vector<double>& at, double v0, double v1) {
  for (std::size_t k = 0; k + 1 < at.size(); ++k)
    part.add_face(
        std::array{Vec2{at[k], v0}, Vec2{at[k + 1], v0}, Vec2{at[k + 1], v1}, Vec2{at[k], v1}});
}

/// A strip's panel from `u0` at section point `p` to `u1` at `q`, both at `v` = y.
Isometry3d laid_strip(double u0, const Vec3& p, double u1, const Vec3& q) {
  return laid({Vec2{u0, 0.0}, Vec2{u0, 1.0}, Vec2{u1, 0.0}}, {p, at_y(p, 1.0), q});
}

/// Where two bars from `a` and `b`, in a section, meet outward of the fold.
Vec3 meeting(const Vec3& a, double from_a, const Vec3& b, double from_b) {
  const Vec3 to = b - a;
  const double d = norm(to), along = (from_a * from_a - from_b * from_b + d * d) / (2.0 * d);
  const double high = std::sqrt(std::max(0.0, from_a * from_a - along * along));
  const Vec3 up{-to.z() / d, 0.0, to.x() / d};
  return a + along / d * to + high * up;
}

SheetPart& new_part(Structure& card, const std::string& name) {
  card.parts.emplace_back();
  std::string unique = name;
  const auto taken = [&] {
    return std::any_of(card.parts.begin(), card.parts.end(),
                       [&](const SheetPart& part) { return part.name == unique; });
  };
  for (int n = 2; taken(); ++n) unique = fmt::format("{}-{}", name, n);
  card.parts.back().name = std::move(unique);
  return card.parts.back();
}

/// How far from an apex a tab begins that stays on one side of a line through it, at an angle from
/// its fold.
double clear_from_mm(double depth_mm, double angle_rad) {
  constexpr double kClear_mm = 0.5;
  return angle_rad >= 0.5 * kPiRad ? 0.0 : depth_mm / std::tan(angle_rad) - depth_mm + kClear_mm;
}

/// Whether a face is on the left of the fold, on its own sheet.
bool is_left_of(const SeatSide& side) { return cross(side.along, side.away) > 0.0; }

/// A tab on a seat's face along a line parallel to its fold: towards the fold, where the part hides
/// it, if there is room.
///
/// @param taken_mm  of the face, from its fold on
void add_foot(Structure& card, std::size_t part, const FlatLine& fold, const SeatSide& side,
              double out_mm, double from_mm, double to_mm, double taken_mm = 0.0) {
  const bool inward = out_mm - taken_mm > tab_depth_mm(card, to_mm - from_mm);
  add_tab(card, part, fold, side.part, side.face,
          {side.at(out_mm, from_mm), side.at(out_mm, to_mm)}, inward != is_left_of(side));
}

/// The faces of a box's lid, in the axes of the seat.
std::vector<Isometry3d> lid_pose(const BoxElement& e, const SeatFrame& frame) {
  if (e.lid == BoxLid::Pyramid) return PyramidFan(e).pose(e, frame.opening_rad);
  const double a = e.half_mm, h = e.height_mm, s = std::sin(0.5 * frame.opening_rad),
               c = std::cos(0.5 * frame.opening_rad);
  const double slope = slope_mm(e);
  const double wide = e.lid == BoxLid::Roof ? a : e.lid == BoxLid::Gabled ? slope : e.lid_mm;
  const double above = e.lid == BoxLid::Roof     ? 2.0 * a * c
                       : e.lid == BoxLid::Gabled ? a * c + std::sqrt(slope * slope - a * a * s * s)
                                                 : 0.0;
  const Vec3 middle{0.0, 0.0, h + above};
  const auto side = [&](double sign) -> Vec3 {
    if (e.lid != BoxLid::Floating) return {sign * a * s, 0.0, a * c + h};
    return middle + wide * frame.out(sign);
  };
  return {laid_strip(0.0, middle, -wide, side(-1.0)), laid_strip(0.0, middle, wide, side(1.0))};
}

/// A wall between the middles of both ends of part `walls`: a tab on the right half of each.
void add_inner_wall(Structure& card, std::size_t walls, const BoxElement& e) {
  const std::size_t n = card.parts.size();
  const double length = e.to_mm - e.from_mm, half = half_end_mm(e);
  add_strip(new_part(card, e.name + "-inner"), {0.0, length}, 0.0, e.inner_mm);
  const auto line = [&](double u) { return FlatLine{Vec2{u, 0.0}, Vec2{u, e.inner_mm}}; };
  add_tab(card, n, line(0.0), walls, 5, line(2.0 * length + 3.0 * half), false);
  add_tab(card, n, line(length), walls, 1, line(length + half), true);
}

/// The roof of a pyramid, on the walls of part `walls`: two tabs hold it, and one closes it.
void add_pyramid(Structure& card, std::size_t walls, const BoxElement& e) {
  const PyramidFan fan(e);
  const std::size_t n = card.parts.size();
  SheetPart& part = new_part(card, e.name + "-lid");
  const Vec2 top{0.0, 0.0};
  for (std::size_t k = 0; k + 1 < fan.rim.size(); ++k)
    part.add_face(std::array{top, fan.rim[k], fan.rim[k + 1]});
  if (fan.is_closed()) {
    const double depth = tab_depth_mm(card, fan.edge_mm);
    const double from =
        std::max(1.0, clear_from_mm(depth, std::min(2.0 * fan.side_rad, fan.apart_rad())));
    const double to =
        fan.edge_mm - std::max(1.0, clear_from_mm(depth, 0.5 * kPiRad - fan.side_rad));
    const auto along = [&](const Vec2& rim) {
      const Vec2 d = unit(rim);
      return FlatLine{Vec2(from * d), Vec2(to * d)};
    };
    add_tab(card, n, along(fan.rim.back()), n, 0, along(fan.rim.front()), true);
  }
  const double length = e.to_mm - e.from_mm, h = e.height_mm;
  const double begin = std::min(card.tab_mm + 1.0, 0.25 * length),
               left = length + 2.0 * half_end_mm(e);
  const auto edge = [&](const Vec2& first, const Vec2& last) {
    const Vec2 d = (last - first) / length;
    return FlatLine{Vec2(first + begin * d), Vec2(first + (length - begin) * d)};
  };
  // Without slopes at the far end the right slope is the last one.
  const std::size_t right = e.has_hips[1] ? 0 : 6;
  add_tab(card, n, edge(fan.place(right), fan.place(right + 1)), walls, 0,
          {Vec2{begin, h}, Vec2{length - begin, h}}, false);
  add_tab(card, n, edge(fan.place(4), fan.place(3)), walls, 3,
          {Vec2{left + length - begin, h}, Vec2{left + begin, h}}, true);
}

Result<void> needs(bool holds, const char* what, double is, const char* right) {
  if (holds) return {};
  return fail(ErrorKind::OutOfRange, "", fmt::format("{} is {:.6g}; {}", what, is, right));
}

Result<void> check_span(double from_mm, double to_mm) {
  return needs(to_mm - from_mm > 1.0, "its length along the fold", to_mm - from_mm,
               "it must be more than 1 mm");
}

Result<void> check_tent(double left_foot, double left_panel, double right_foot,
                        double right_panel) {
  for (const auto& [mm, what] :
       {std::pair(left_foot, "the left foot"), std::pair(right_foot, "the right foot"),
        std::pair(left_panel, "the left panel"), std::pair(right_panel, "the right panel")})
    if (auto done = needs(mm > 0.0, what, mm, "it must be more than 0 mm"); !done) return done;
  const double left = left_foot + left_panel, right = right_foot + right_panel;
  if (std::abs(left - right) > kAlike * (left + right))
    return fail(ErrorKind::Infeasible, "",
                fmt::format("it does not shut flat: foot and panel are {:.6g} mm on the left and "
                            "{:.6g} mm on the right; make the right panel {:.6g} mm long",
                            left, right, left - right_foot));
  if (left_foot + right_foot >= left_panel + right_panel)
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("the card cannot open flat: the feet are {:.6g} mm apart, and the panels "
                    "{:.6g} mm long together; make the panels longer by more than {:.3g} mm "
                    "each",
                    left_foot + right_foot, left_panel + right_panel,
                    0.5 * (left_foot + right_foot - left_panel - right_panel)));
  return {};
}

}  // namespace

Vec2 hip_foot(const BoxElement& pyramid, double opening_rad) {
  const BoxElement& e = pyramid;
  const double half_length = 0.5 * (e.to_mm - e.from_mm), high = pyramid_top_mm(e, opening_rad),
               end = std::hypot(half_length + e.hip_bend_mm, e.rise_mm);
  // It is as far from the top, and as far from the corners of its wall, as on the sheet.
  const double corner2 =
      std::pow(e.hip_bend_mm, 2) + std::pow(e.half_mm * std::cos(0.5 * opening_rad), 2);
  const Vec2 top{0.0, high}, down = Vec2{half_length, 0.0} - top;
  const double d = norm(down), along = (end * end - corner2 + d * d) / (2.0 * d),
               aside = std::sqrt(std::max(0.0, end * end - along * along));
  return top + along / d * down + aside / d * Vec2{-down.y(), down.x()};
}

double panel_of_tilt(double crease_rad, double tilt_rad) {
  return std::acos(std::cos(crease_rad) * std::cos(tilt_rad));
}

std::pair<double, double> upright_strut(double foot_mm, double strut_at_mm) {
  const double foot = foot_mm * strut_at_mm / (2.0 * foot_mm + strut_at_mm);
  return {foot, foot_mm + strut_at_mm - foot};
}

Result<void> can_move(const VFoldElement& e) {
  for (const auto& [angle, what] : {std::pair(e.left_crease_rad, "the left crease"),
                                    std::pair(e.right_crease_rad, "the right crease"),
                                    std::pair(e.left_panel_rad, "the left panel"),
                                    std::pair(e.right_panel_rad, "the right panel")})
    if (auto done = needs(angle > 0.0 && angle < kPiRad, what, degrees(angle),
                          "it must be between 0 and 180 degrees");
        !done)
      return done;
  const double left = e.left_crease_rad + e.left_panel_rad,
               right = e.right_crease_rad + e.right_panel_rad;
  if (std::abs(left - right) > kAlike)
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("it does not shut flat: crease and panel are {:.6g} degrees on the left "
                    "and {:.6g} on the right; make the right panel {:.6g} degrees",
                    degrees(left), degrees(right), degrees(left - e.right_crease_rad)));
  const double creases = e.left_crease_rad + e.right_crease_rad;
  if (left <= creases)
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("the card cannot open flat: the panels have {:.6g} degrees together, and "
                    "the creases are {:.6g} degrees apart; make each panel wider by more "
                    "than {:.3g} degrees",
                    degrees(2.0 * left - creases), degrees(creases), degrees(creases - left)));
  if (left >= kPiRad)
    return fail(ErrorKind::Infeasible, "",
                fmt::format("shut, its ridge leaves the pages over the spine: crease and panel are "
                            "{:.6g} degrees; make them less than 180",
                            degrees(left)));
  return {};
}

Result<void> can_move(const TentElement& e) {
  if (auto done = check_span(e.from_mm, e.to_mm); !done) return done;
  return check_tent(e.left_foot_mm, e.left_panel_mm, e.right_foot_mm, e.right_panel_mm);
}

Result<void> can_move(const LayerElement& e) {
  if (auto done = check_span(e.from_mm, e.to_mm); !done) return done;
  if (auto done = needs(e.height_mm > e.strut_at_mm, "the layer's height", e.height_mm,
                        "it must be above its strut");
      !done)
    return done;
  return check_tent(e.strut_foot_mm, e.strut_mm, e.foot_mm, e.strut_at_mm);
}

Result<void> can_move(const BoxElement& e) {
  if (auto done = check_span(e.from_mm, e.to_mm); !done) return done;
  for (const auto& [mm, what] :
       {std::pair(e.half_mm, "half of its width"), std::pair(e.height_mm, "its height")})
    if (auto done = needs(mm > 0.0, what, mm, "it must be more than 0 mm"); !done) return done;
  if (e.lid == BoxLid::Floating && e.lid_mm < e.half_mm)
    return fail(ErrorKind::Infeasible, "",
                fmt::format("the floating lid is {:.6g} mm wide on each side, and the walls are "
                            "{:.6g} mm from the middle; make it wider",
                            e.lid_mm, e.half_mm));
  if (e.lid == BoxLid::Floating && !(e.ends_out[0] && e.ends_out[1]))
    return fail(ErrorKind::Infeasible, "",
                "the ends would pass through the floating lid as the card shuts; let them fold "
                "outward");
  if (e.lid == BoxLid::Gabled || e.lid == BoxLid::Pyramid)
    if (auto done =
            needs(e.rise_mm > 0.0, "the rise of its roof", e.rise_mm, "it must be more than 0 mm");
        !done)
      return done;
  if (e.lid == BoxLid::Pyramid && !e.has_hips[0] && !e.has_hips[1])
    return fail(ErrorKind::Infeasible, "",
                "its roof has no slopes at its ends, which would hold the others together; give it "
                "one");
  if (e.lid == BoxLid::Pyramid && PyramidFan(e).is_closed())
    if (const double apart = PyramidFan(e).apart_rad(); apart < kLeastApart_rad)
      return fail(ErrorKind::Infeasible, "",
                  fmt::format("its roof is too flat for the tab that closes it, which has {:.3g} "
                              "degrees; it needs {:g}: make it higher than {:.3g} mm",
                              degrees(apart), degrees(kLeastApart_rad), e.rise_mm));
  if (e.lid == BoxLid::Gabled) {
    for (const auto& [mm, what] :
         {std::pair(e.eaves_mm, "its eaves"), std::pair(e.verge_mm[0], "its verge"),
          std::pair(e.verge_mm[1], "its verge")})
      if (auto done = needs(mm >= 0.0, what, mm, "it must be at least 0 mm"); !done) return done;
    // As the card shuts, slopes turn down along the walls.
    const double p = slope_mm(e), most = e.height_mm * p / (p + e.half_mm);
    if (e.eaves_mm >= most)
      return fail(ErrorKind::Infeasible, "",
                  fmt::format("its eaves would pass through the pages as the card shuts: they are "
                              "{:.6g} mm; make them less than {:.4g} mm",
                              e.eaves_mm, most));
  }
  if (!e.ends_out[0] && !e.ends_out[1] && 2.0 * half_end_mm(e) >= e.to_mm - e.from_mm)
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("the ends meet inside as the card shuts: the box is {:.6g} mm long, and its "
                    "ends are {:.6g} mm wide; make it longer, or let one of the ends fold outward",
                    e.to_mm - e.from_mm, 2.0 * half_end_mm(e)));
  for (const auto& [mm, what] :
       {std::pair(e.bend_mm, "the bend of its ends"),
        std::pair(e.hip_bend_mm, "the bend of its roof"), std::pair(e.inner_mm, "its inner wall")})
    if (auto done = needs(mm >= 0.0, what, mm, "it must be at least 0 mm"); !done) return done;
  if (e.inner_mm > 0.0) {
    if (e.ends_out[0] == e.ends_out[1])
      return fail(ErrorKind::Infeasible, "",
                  "its inner wall stands between ends that fold in opposite directions, and would "
                  "tear; let one end fold outward and the other one inward");
    if (auto done = needs(e.inner_mm <= e.height_mm, "its inner wall", e.inner_mm,
                          "it must be at most as high as its walls");
        !done)
      return done;
  }
  return {};
}

Result<void> can_move(const DoubleCornerElement& e) {
  if (auto done = check_span(e.from_mm, e.to_mm); !done) return done;
  for (const auto& step : e.steps) {
    if (auto done = check_span(step.from_mm, step.to_mm); !done) return done;
    if (step.from_mm < e.from_mm || step.to_mm > e.to_mm || step.up_mm > e.height_mm ||
        !(step.up_mm > 0.0) || !(step.out_mm > 0.0))
      return fail(
          ErrorKind::Infeasible, "",
          fmt::format("a step {:.6g} mm high reaches from {:.6g} to {:.6g} mm; the panel that "
                      "holds it is {:.6g} mm high, from {:.6g} to {:.6g} mm",
                      step.up_mm, step.from_mm, step.to_mm, e.height_mm, e.from_mm, e.to_mm));
  }
  if (e.has_locks)
    return check_tent(e.lock_foot_mm, e.lock_panel_mm, e.lock_foot_mm, e.lock_panel_mm);
  return {};
}

void build(Structure& card, const Seat& seat, const VFoldElement& e) {
  const std::size_t n = card.parts.size();
  SheetPart& part = new_part(card, e.name);
  const auto crease = [](double panel_rad, double side) {
    return Vec2{side * std::sin(panel_rad), std::cos(panel_rad)};
  };
  const Vec2 left = crease(e.left_panel_rad, -1.0), right = crease(e.right_panel_rad, 1.0);
  const auto add_panel = [&](const std::vector<std::vector<Vec2>>& given, const Vec2& along) {
    for (const std::vector<Vec2>& outline : given) part.add_face(outline);
    const Vec2 up{0.0, e.ridge_mm};
    if (given.empty())
      part.add_face(std::array{Vec2{0.0, 0.0}, Vec2(e.crease_mm * along),
                               Vec2(e.crease_mm * along + up), up});
  };
  add_panel(e.left_outlines, left);
  add_panel(e.right_outlines, right);
  // Faces of unlike outlines meet in the same stretches.
  for (const Vec2& at : std::vector<Vec2>(part.vertices)) part.add_corner(at);
  const auto glue = [&](const std::vector<std::pair<double, double>>& given, const Vec2& flat,
                        const SeatSide& side, double angle) {
    const double tabs = tab_depth_mm(card, e.crease_mm);
    const double apart = 2.0 * kPiRad - e.left_panel_rad - e.right_panel_rad;
    double from = std::max(1.0, clear_from_mm(tabs, 0.5 * apart));
    if (!e.tabs_behind) from = std::max(from, clear_from_mm(tabs, angle));
    const std::vector<std::pair<double, double>> whole{
        {std::min(from, 0.8 * e.crease_mm), e.crease_mm}};
    const auto place = [&](double mm) {
      return side.at(mm * std::sin(angle), e.at_mm + mm * std::cos(angle));
    };
    for (const auto& [begin, end] : given.empty() ? whole : given) {
      const FlatLine on{place(begin), place(end)};
      const Vec2 line = on[1] - on[0];
      const bool begins_left = cross(line, Vec2(-side.along)) > 0.0;
      add_tab(card, n, {Vec2(begin * flat), Vec2(end * flat)}, side.part, side.face, on,
              begins_left == e.tabs_behind);
    }
  };
  glue(e.left_tabs, left, seat.left, e.left_crease_rad);
  glue(e.right_tabs, right, seat.right, e.right_crease_rad);
  const auto pose = [e, left, right](const SeatFrame& frame) {
    const Vec3 y{0.0, 1.0, 0.0}, apex = e.at_mm * y;
    const Vec3 l = std::cos(e.left_crease_rad) * y + std::sin(e.left_crease_rad) * frame.out(-1.0),
               r = std::cos(e.right_crease_rad) * y + std::sin(e.right_crease_rad) * frame.out(1.0);
    // ridge = p l + q r + t (r x l), with its angles to both.
    const double c = dot(l, r), a = std::cos(e.left_panel_rad), b = std::cos(e.right_panel_rad);
    const Vec3 normal = cross(r, l);
    const double s2 = dot(normal, normal), p = (a - c * b) / s2, q = (b - c * a) / s2;
    const Vec3 in_plane = p * l + q * r;
    const double up = std::sqrt(std::max(0.0, 1.0 - dot(in_plane, in_plane)) / s2);
    const Vec3 ridge = in_plane + up * normal;
    const Vec2 o{0.0, 0.0}, u{0.0, 1.0};
    const auto faces = [](const std::vector<std::vector<Vec2>>& outlines) {
      return std::max<std::size_t>(1, outlines.size());
    };
    PartPoses out(1);
    out[0].assign(faces(e.left_outlines), laid({o, u, left}, {apex, apex + ridge, apex + l}));
    out[0].resize(out[0].size() + faces(e.right_outlines),
                  laid({o, u, right}, {apex, apex + ridge, apex + r}));
    return out;
  };
  card.elements.push_back({seat, n, 1, pose});
}

void build(Structure& card, const Seat& seat, const TentElement& e) {
  const std::size_t n = card.parts.size();
  SheetPart& part = new_part(card, e.name);
  const double ridge = e.left_panel_mm, end = ridge + e.right_panel_mm;
  add_strip(part, {0.0, ridge, end}, e.from_mm, e.to_mm);
  for (const auto& [from, to] : e.slits) {
    part.slits.push_back({Vec2{ridge, from}, Vec2{ridge, to}});
    part.add_corner({ridge, from});
    part.add_corner({ridge, to});
  }
  add_foot(card, n, {Vec2{0.0, e.from_mm}, Vec2{0.0, e.to_mm}}, seat.left, e.left_foot_mm,
           e.from_mm, e.to_mm);
  add_foot(card, n, {Vec2{end, e.from_mm}, Vec2{end, e.to_mm}}, seat.right, e.right_foot_mm,
           e.from_mm, e.to_mm);
  const auto pose = [e, ridge, end](const SeatFrame& frame) {
    const Vec3 l = e.left_foot_mm * frame.out(-1.0), r = e.right_foot_mm * frame.out(1.0);
    const Vec3 top = meeting(l, e.left_panel_mm, r, e.right_panel_mm);
    return PartPoses{{laid_strip(0.0, l, ridge, top), laid_strip(ridge, top, end, r)}};
  };
  card.elements.push_back({seat, n, 1, pose});
}

void build(Structure& card, const Seat& seat, const LayerElement& e) {
  const std::size_t n = card.parts.size();
  add_strip(new_part(card, e.name), {0.0, e.height_mm}, e.from_mm, e.to_mm);
  add_strip(new_part(card, e.name + "-strut"), {0.0, e.strut_mm}, e.from_mm, e.to_mm);
  const auto line = [&](double u) { return FlatLine{Vec2{u, e.from_mm}, Vec2{u, e.to_mm}}; };
  add_foot(card, n, line(0.0), seat.right, e.foot_mm, e.from_mm, e.to_mm);
  add_foot(card, n + 1, line(0.0), seat.left, e.strut_foot_mm, e.from_mm, e.to_mm);
  // What is up the layer is on the right of the direction of y on its sheet.
  add_tab(card, n + 1, line(e.strut_mm), n, 0, line(e.strut_at_mm), e.tab_down);
  const auto pose = [e](const SeatFrame& frame) {
    const Vec3 l = e.strut_foot_mm * frame.out(-1.0), r = e.foot_mm * frame.out(1.0);
    const Vec3 joint = meeting(l, e.strut_mm, r, e.strut_at_mm);
    return PartPoses{{laid_strip(0.0, r, e.strut_at_mm, joint)},
                     {laid_strip(0.0, l, e.strut_mm, joint)}};
  };
  card.elements.push_back({seat, n, 2, pose});
}

void add_glued_roof(Structure& card, const Seat& seat, std::uint32_t front,
                    const TentSection& section, const std::string& name, double from_mm,
                    double to_mm) {
  LayerElement roof;
  roof.name = name, roof.from_mm = from_mm, roof.to_mm = to_mm;
  roof.foot_mm = section.foot_mm, roof.height_mm = section.roof_mm;
  roof.strut_at_mm = section.strut_at_mm;
  roof.strut_foot_mm = section.strut_foot_mm, roof.strut_mm = section.strut_mm;
  roof.tab_down = true;
  const std::size_t part = card.parts.size(), joint = card.joints.size();
  build(card, seat, roof);
  // Tabs where `TentSection` wants them: on the front below the eave, and above the strut's foot.
  card.joints[joint].b.face = front;
  for (const std::size_t k : {joint, joint + 1}) card.joints[k].turned = !card.joints[k].turned;
  turn_over(card, part);  // its outside is printed
}

void build(Structure& card, const Seat& seat, const BoxElement& e) {
  const std::size_t n = card.parts.size();
  const double a = e.half_mm, h = e.height_mm, length = e.to_mm - e.from_mm;
  const double half = half_end_mm(e), left = length + 2.0 * half, end = 2.0 * length + 4.0 * half;
  const double peak = h + (e.lid == BoxLid::Gabled ? e.rise_mm : 0.0);
  SheetPart& walls = new_part(card, e.name);
  const auto add_wall = [&](double u0, double high0, double u1, double high1) {
    walls.add_face(std::array{Vec2{u0, 0.0}, Vec2{u1, 0.0}, Vec2{u1, high1}, Vec2{u0, high0}});
  };
  for (const double begin : {0.0, left}) {
    add_wall(begin, h, begin + length, h);
    add_wall(begin + length, h, begin + length + half, peak);
    add_wall(begin + length + half, peak, begin + length + 2.0 * half, h);
  }
  add_foot(card, n, {Vec2{0.0, 0.0}, Vec2{length, 0.0}}, seat.right, a, e.from_mm, e.to_mm);
  add_foot(card, n, {Vec2{left + length, 0.0}, Vec2{left, 0.0}}, seat.left, a, e.from_mm, e.to_mm);
  add_tab(card, n, {Vec2{end, 0.0}, Vec2{end, h}}, n, 0, {Vec2{0.0, 0.0}, Vec2{0.0, h}}, false);
  if (e.lid == BoxLid::Pyramid) {
    add_pyramid(card, n, e);
  } else if (e.lid != BoxLid::None) {
    const double wide = e.lid == BoxLid::Roof     ? a
                        : e.lid == BoxLid::Gabled ? slope_mm(e) + e.eaves_mm
                                                  : e.lid_mm;
    const bool is_gabled = e.lid == BoxLid::Gabled;
    add_strip(new_part(card, e.name + "-lid"), {-wide, 0.0, wide},
              e.from_mm - (is_gabled ? e.verge_mm[0] : 0.0),
              e.to_mm + (is_gabled ? e.verge_mm[1] : 0.0));
  }
  // Past the tab that closes the walls.
  const double from = std::min(card.tab_mm + 1.0, 0.25 * length), to = length - from;
  const FlatLine right_top{Vec2{from, h}, Vec2{to, h}},
      left_top{Vec2{left + length - from, h}, Vec2{left + length - to, h}};
  if (e.lid == BoxLid::Roof) {
    const auto edge = [&](double u) {
      return FlatLine{Vec2{u, e.from_mm + from}, Vec2{u, e.from_mm + to}};
    };
    add_tab(card, n + 1, edge(a), n, 0, right_top, false);
    add_tab(card, n + 1, edge(-a), n, 3, left_top, true);
  } else if (e.lid == BoxLid::Gabled || e.lid == BoxLid::Floating) {
    const auto on = [&](double u) {
      return FlatLine{Vec2{u, e.from_mm + from}, Vec2{u, e.from_mm + to}};
    };
    const double wall = e.lid == BoxLid::Gabled ? slope_mm(e) : a;
    add_tab(card, n, right_top, n + 1, 1, on(wall), true);
    add_tab(card, n, left_top, n + 1, 0, on(-wall), false);
  }
  if (e.inner_mm > 0.0) add_inner_wall(card, n, e);
  const auto pose = [=](const SeatFrame& frame) {
    const double s = std::sin(0.5 * frame.opening_rad), c = std::cos(0.5 * frame.opening_rad);
    const double far = std::hypot(e.bend_mm, a * c);
    const auto bend = [&](std::size_t end) { return e.ends_out[end] ? far : -far; };
    const Vec3 up{0.0, 0.0, 1.0};
    const std::array<Vec3, 7> foot{
        Vec3{a * s, e.from_mm, a * c},       Vec3{a * s, e.to_mm, a * c},
        Vec3{0.0, e.to_mm + bend(1), a * c}, Vec3{-a * s, e.to_mm, a * c},
        Vec3{-a * s, e.from_mm, a * c},      Vec3{0.0, e.from_mm - bend(0), a * c},
        Vec3{a * s, e.from_mm, a * c}};
    const std::array<double, 7> at{
        0.0, length, length + half, left, left + length, left + length + half, end};
    PartPoses out(1);
    for (std::size_t k = 0; k < 6; ++k)
      out[0].push_back(laid({Vec2{at[k], 0.0}, Vec2{at[k + 1], 0.0}, Vec2{at[k], 1.0}},
                            {foot[k], foot[k + 1], foot[k] + up}));
    if (e.lid != BoxLid::None) out.push_back(lid_pose(e, frame));
    if (e.inner_mm > 0.0) {
      const Vec3& middle = foot[5];
      out.push_back({laid({Vec2{0.0, 0.0}, Vec2{length, 0.0}, Vec2{0.0, 1.0}},
                          {middle, at_y(middle, length), middle + up})});
    }
    return out;
  };
  card.elements.push_back({seat, n, card.parts.size() - n, pose});
}

void build(Structure& card, const Seat& seat, const DoubleCornerElement& e) {
  constexpr double kGap_mm = 2.0, kBeyond_mm = 5.0;
  const std::size_t n = card.parts.size();
  // 1. The panel in the fold, with a finger for each lock.
  const double low = 0.8 * std::sqrt(std::max(0.0, e.lock_panel_mm * e.lock_panel_mm -
                                                       e.lock_foot_mm * e.lock_foot_mm)),
               high = e.lock_foot_mm + e.lock_panel_mm + kBeyond_mm;
  const double third = e.lock_width_mm / 3.0, slack = 0.5;
  struct Lock {
    double from{}, to{}, finger_from{}, finger_to{};
  };
  std::vector<Lock> locks;
  if (e.has_locks) {
    const double first = e.from_mm - kGap_mm - e.lock_width_mm, last = e.to_mm + kGap_mm;
    for (const double from : {first, last})
      locks.push_back({from, from + e.lock_width_mm, from + third, from + 2.0 * third});
  }
  std::vector<Vec2> outline;
  if (locks.empty()) {
    outline = {{e.from_mm, 0.0}, {e.to_mm, 0.0}, {e.to_mm, e.height_mm}, {e.from_mm, e.height_mm}};
  } else {
    const Lock &a = locks[0], &b = locks[1];
    outline = {{a.finger_from, 0.0},   {b.finger_to, 0.0},       {b.finger_to, high},
               {b.finger_from, high},  {b.finger_from, low},     {e.to_mm, low},
               {e.to_mm, e.height_mm}, {e.from_mm, e.height_mm}, {e.from_mm, low},
               {a.finger_to, low},     {a.finger_to, high},      {a.finger_from, high}};
  }
  SheetPart& middle = new_part(card, e.name);
  middle.add_face(outline);
  add_foot(card, n, {Vec2{e.from_mm, 0.0}, Vec2{e.to_mm, 0.0}}, seat.right, 0.0, e.from_mm,
           e.to_mm);
  // 2. Steps.
  for (const auto& step : e.steps) {
    const std::size_t p = card.parts.size();
    const double end_u = step.up_mm + step.out_mm;
    add_strip(new_part(card, fmt::format("{}-{}", e.name, step.is_right ? "right" : "left")),
              {0.0, step.up_mm, end_u}, step.from_mm, step.to_mm);
    const auto line = [&](double u) {
      return FlatLine{Vec2{u, step.from_mm}, Vec2{u, step.to_mm}};
    };
    add_foot(card, p, line(0.0), step.is_right ? seat.right : seat.left, step.out_mm, step.from_mm,
             step.to_mm, step.is_right ? card.tab_mm : 0.0);
    add_tab(card, p, line(end_u), n, 0,
            {Vec2{step.from_mm, step.up_mm}, Vec2{step.to_mm, step.up_mm}}, false);
  }
  const auto pose = [e](const SeatFrame& frame) {
    const Vec3 zero{0.0, 0.0, 0.0};
    PartPoses out{{laid({Vec2{0.0, 0.0}, Vec2{1.0, 0.0}, Vec2{0.0, 1.0}},
                        {zero, Vec3{0.0, 1.0, 0.0}, Vec3{0.0, 0.0, 1.0}})}};
    for (const auto& step : e.steps) {
      const Vec3 foot = step.out_mm * frame.out(step.is_right ? 1.0 : -1.0),
                 up{0.0, 0.0, step.up_mm};
      out.push_back({laid_strip(0.0, foot, step.up_mm, foot + up),
                     laid_strip(step.up_mm, foot + up, step.up_mm + step.out_mm, up)});
    }
    return out;
  };
  card.elements.push_back({seat, n, 1 + e.steps.size(), pose});
  // 3. Locks.
  for (const Lock& lock : locks) {
    const std::size_t p = card.parts.size();
    TentElement tent{e.name + "-lock", lock.from,       lock.to,         e.lock_foot_mm,
                     e.lock_foot_mm,   e.lock_panel_mm, e.lock_panel_mm, {}};
    tent.slits = {{lock.finger_from - slack, lock.finger_to + slack}};
    build(card, seat, tent);
    const double ridge = e.lock_panel_mm;
    card.joints.push_back(
        {PartJointKind::Slot,
         {p, 0, {Vec2{ridge, lock.finger_from - slack}, Vec2{ridge, lock.finger_to + slack}}},
         {n, 0, {}},
         false});
  }
}

Result<void> shuts_inside(const Structure& card, std::size_t first_part) {
  constexpr double kShut_rad = 1e-5, kSlack_mm = 1e-3;
  const PartPoses pose = posed(card, kShut_rad);
  for (std::size_t p = first_part; p < card.parts.size(); ++p) {
    const SheetPart& part = card.parts[p];
    double far = 0.0, low = 0.0, high = card.length_mm, behind = 0.0;
    for (std::size_t f = 0; f < part.faces.size(); ++f)
      for (const std::uint32_t v : part.faces[f]) {
        const Vec2 flat = part.vertices[v];
        const Vec3 at = pose[p][f] * Vec3{flat.x(), flat.y(), 0.0};
        far = std::max(far, at.x()), behind = std::max(behind, -at.x());
        low = std::min(low, at.y()), high = std::max(high, at.y());
      }
    if (behind > kSlack_mm)
      return fail(ErrorKind::Infeasible, part.name,
                  fmt::format("shut, it sticks out over the spine by {:.3g} mm", behind));
    if (far > card.page_mm + kSlack_mm)
      return fail(ErrorKind::Infeasible, part.name,
                  fmt::format("shut, it sticks out of the open edge by {:.3g} mm; make the pages "
                              "{:.4g} mm wide, or the part smaller",
                              far - card.page_mm, far));
    if (low < -kSlack_mm || high > card.length_mm + kSlack_mm)
      return fail(ErrorKind::Infeasible, part.name,
                  fmt::format("shut, it sticks out of the pages along the spine by {:.3g} mm; make "
                              "them {:.4g} mm long and move it by {:.4g} mm, or make it smaller",
                              std::max(-low, high - card.length_mm), high - low, -low));
  }
  return {};
}

Seat seat_beside(const Structure& card, std::size_t joint) {
  constexpr double kNearlyShut_rad = 0.01;
  const PartJoint& glue = card.joints[joint];
  const SheetPart& part = card.parts[glue.a.part];
  // The panel that shares the tab's fold.
  const auto is_end = [&](std::uint32_t v) {
    return norm(Vec2(part.vertices[v] - glue.a.line[0])) < 1e-7 ||
           norm(Vec2(part.vertices[v] - glue.a.line[1])) < 1e-7;
  };
  std::uint32_t panel = glue.a.face;
  for (std::uint32_t f = 0; f < part.faces.size(); ++f)
    if (f != glue.a.face && std::count_if(part.faces[f].begin(), part.faces[f].end(), is_end) == 2)
      panel = f;
  Vec2 middle{0.0, 0.0};
  for (const std::uint32_t v : part.faces[panel]) middle += part.vertices[v];
  middle /= static_cast<double>(part.faces[panel].size());
  const auto side = [](std::size_t p, std::uint32_t f, const FlatLine& line, bool left) {
    const Vec2 along = unit(Vec2(line[1] - line[0])), across{-along.y(), along.x()};
    return SeatSide{p, f, line[0], along, left ? across : Vec2(-across)};
  };
  const bool panel_left =
      cross(Vec2(glue.a.line[1] - glue.a.line[0]), Vec2(middle - glue.a.line[0])) > 0.0;
  const SeatSide up = side(glue.a.part, panel, glue.a.line, panel_left);
  SeatSide down = side(glue.b.part, glue.b.face, glue.b.line, true);
  const PartPoses shut = posed(card, kNearlyShut_rad), half = posed(card, 1.5);
  const auto direction = [](const PartPoses& pose, const SeatSide& s, Vec2 d) {
    return Vec3(pose[s.part][s.face].linear() * Vec3{d.x(), d.y(), 0.0});
  };
  if (dot(direction(shut, up, up.away), direction(shut, down, down.away)) < 0.0)
    down.away = -down.away;
  const Vec3 r = direction(half, down, down.away), l = direction(half, up, up.away);
  const bool is_right_handed =
      dot(cross(Vec3(r - l), direction(half, down, down.along)), Vec3(r + l)) > 0.0;
  return is_right_handed ? Seat{up, down} : Seat{down, up};
}

}  // namespace popcut
