// SPDX-License-Identifier: MIT
// Part of core/formats/dxf/dxf_entity.hpp.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/formats/dxf/dxf_entity.hpp"
#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

/// Seen from above, with y down.
PagePoint seen(const Vec3& p) { return {p.x(), -p.y()}; }

/// Appends to a line, in a frame.
class Pen {
 public:
  Pen(const DxfFrame& frame, double tolerance, std::vector<PagePoint>& line)
      : frame_(frame), tolerance_(tolerance), line_(line) {}

  void to(const Vec3& p) { line_.push_back(seen(frame_(p))); }

  /// Whether these points lie in one height.
  template <typename Points, typename At>
  [[nodiscard]] bool level(const Points& points, const At& at) const {
    return std::all_of(points.begin(), points.end(), [&](const auto& p) {
      return !(std::abs(frame_.direction(at(p) - at(points.front())).z()) > tolerance_);
    });
  }
  /// Whether the plane of x and y lies flat.
  [[nodiscard]] bool flat() const {
    const auto lies = [](const Vec3& a) { return std::abs(a.z()) <= 1e-6 * a.norm(); };
    return lies(frame_.ax) && lies(frame_.ay);
  }

  /// From `p`, which is drawn already, to `q` with a bulge.
  void bulge_to(const Vec3& p, const Vec3& q, double bulge) {
    if (const auto c = bulge_centre(p, q, bulge)) {
      const Vec3 a{p.x() - c->x(), p.y() - c->y(), 0}, b{-a.y(), a.x(), 0};
      turn(*c, a, b, 0.0, 4 * std::atan(bulge), false);
      line_.back() = seen(frame_(q));
    } else {
      to(q);
    }
  }

  void turn(const Vec3& c, const Vec3& a, const Vec3& b, double from, double span,
            bool with_first) {
    flatten_turn(seen(frame_(c)), seen(frame_.direction(a)), seen(frame_.direction(b)), from, span,
                 tolerance_, with_first, line_);
  }

 private:
  DxfFrame frame_;
  double tolerance_;
  std::vector<PagePoint>& line_;
};

/// The angle from one to the other: above 0 and at most a full turn.
double span_of(double from, double to) {
  double span = std::fmod(to - from, 2 * kPi);
  if (span <= 1e-12) span += 2 * kPi;
  return span;
}

/// Whether an entity lies flat, as `pen` draws it.
bool upright(const DxfEntity& entity, bool world, const Pen& pen) {
  const auto self = [](const Vec3& p) { return p; };
  if (!world) return pen.flat();
  if (entity.type == "LINE") return pen.level(std::array{entity.p10, entity.p11}, self);
  if (entity.type == "SPLINE")
    return pen.level(entity.control, self) && pen.level(entity.fit, self);
  if (entity.type == "POLYLINE")
    return pen.level(entity.vertices, [](const auto& vertex) { return vertex.at; });
  const auto n = dxf_unit(entity.extrusion.value_or(Vec3{0, 0, 1})).value_or(Vec3{0, 0, 1});
  const Vec3 minor = cross(n, entity.p11);
  return pen.level(std::array{Vec3{0, 0, 0}, entity.p11, minor}, self);
}

void polyline(const DxfEntity& entity, Pen& pen, std::size_t most, std::vector<PagePoint>& line) {
  const bool old = entity.type == "POLYLINE";
  const bool spatial = old && (entity.flag[0] & 8) != 0;
  const double z = old ? entity.p10.z() : entity.elevation;
  const auto corner = [&](std::size_t i) {
    Vec3 p = entity.vertices[i].at;
    if (!spatial) p.z() = z;
    return p;
  };
  const std::size_t n = entity.vertices.size();
  if (n < 2) return;
  pen.to(corner(0));
  const auto side = [&](std::size_t from, std::size_t to) {
    pen.bulge_to(corner(from), corner(to), spatial ? 0.0 : entity.vertices[from].bulge);
  };
  for (std::size_t i = 1; i < n && line.size() <= most; ++i) side(i - 1, i);
  const bool round = (entity.flag[0] & 1) != 0;
  if (!round) return;
  if (line.front() != line.back() || entity.vertices[n - 1].bulge != 0.0) side(n - 1, 0);
  line.back() = line.front();
}

void circle(const DxfEntity& entity, Pen& pen, std::string& wrong) {
  const double r = entity.real_or(40, 0.0);
  if (r < 0.0) {
    wrong = fmt::format("the {} has a radius of {:g}; it must be above 0", entity.type, r);
    return;
  }
  if (r == 0.0) return;
  const bool arc = entity.type == "ARC";
  const double from = arc ? radians(std::fmod(entity.from_deg, 360.0)) : 0.0;
  const double to = arc ? radians(std::fmod(entity.to_deg, 360.0)) : 0.0;
  pen.turn(entity.p10, {r, 0, 0}, {0, r, 0}, from, span_of(from, to), true);
}

void ellipse(const DxfEntity& entity, Pen& pen, std::string& wrong) {
  const double ratio = entity.real_or(40, 1.0);
  if (!(std::abs(ratio) <= 1e6)) {
    wrong = fmt::format("the ELLIPSE has an axis ratio of {:g}; it must be above 0 and at most 1",
                        ratio);
    return;
  }
  const Vec3& major = entity.p11;
  const auto n = dxf_unit(entity.extrusion.value_or(Vec3{0, 0, 1}));
  const Vec3 minor = ratio * cross(n.value_or(Vec3{0, 0, 1}), major);
  if (!dxf_unit(major)) return;
  const double from = entity.real_or(41, 0.0), to = entity.real_or(42, 2 * kPi);
  if (!(std::abs(from) < 1e6 && std::abs(to) < 1e6)) {
    wrong = "the ELLIPSE begins or ends at an invalid angle; use radians from 0 to 2 pi";
    return;
  }
  const bool full = std::abs(std::abs(to - from) - 2 * kPi) < 1e-9;
  pen.turn(entity.p10, major, minor, from, full ? 2 * kPi : span_of(from, to), true);
}

void spline(const DxfEntity& entity, const DxfFrame& frame, double tolerance, std::size_t most,
            std::vector<PagePoint>& line, std::string& wrong) {
  const bool round = (entity.flag[0] & 1) != 0;
  if (!entity.control.empty()) {
    DxfSpline curve{entity.flag[1] == 0 ? 3 : entity.flag[1], entity.knots, entity.weights, {}};
    for (const Vec3& p : entity.control) curve.control.push_back(seen(frame(p)));
    wrong = check_spline(curve);
    if (wrong.empty()) flatten_spline(curve, tolerance, most, line);
  } else if (entity.fit.size() >= 2) {
    std::vector<PagePoint> fit;
    for (const Vec3& p : entity.fit) fit.push_back(seen(frame(p)));
    const auto tangent = [&](bool given, const Vec3& d) -> std::optional<PagePoint> {
      const PagePoint t = seen(frame.direction(d));
      const double l = std::hypot(t.x, t.y);
      if (!given || !(l > 0.0) || !std::isfinite(l)) return std::nullopt;
      return PagePoint{t.x / l, t.y / l};
    };
    flatten_fit(std::move(fit), tangent(entity.tangent_from, entity.p12),
                tangent(entity.tangent_to, entity.p13), round, tolerance, most, line);
  } else {
    wrong = "the SPLINE needs control points or at least two fit points";
  }
  const double gap = line.empty() ? 0.0 : distance(line.front(), line.back());
  if (round && gap > 0.0 && gap <= tolerance && line.size() > 3) line.back() = line.front();
}

}  // namespace

DxfFrame insert_frame(const DxfEntity& insert, const Vec3& base, double across, double up) {
  const double sx = insert.real_or(41, 1.0), sy = insert.real_or(42, 1.0),
               sz = insert.real_or(43, 1.0);
  const double turn = radians(std::fmod(insert.from_deg, 360.0));
  const double c = std::cos(turn), s = std::sin(turn);
  const DxfFrame place{{c, s, 0}, {-s, c, 0}, {0, 0, 1}, insert.p10};
  const DxfFrame own{{sx, 0, 0},
                     {0, sy, 0},
                     {0, 0, sz},
                     {across - sx * base.x(), up - sy * base.y(), -sz * base.z()}};
  return dxf_object_frame(insert.extrusion.value_or(Vec3{0, 0, 1})) * (place * own);
}

DxfShape outline_of(const DxfEntity& entity, const DxfFrame& frame, double tolerance,
                    std::size_t most, std::vector<PagePoint>& line, std::string& wrong) {
  constexpr int kMesh = 16 | 64, kSpatial = 8;
  if (entity.type == "POLYLINE" && (entity.flag[0] & kMesh) != 0) return DxfShape::Mesh;
  const bool world = entity.type == "LINE" || entity.type == "ELLIPSE" || entity.type == "SPLINE" ||
                     (entity.type == "POLYLINE" && (entity.flag[0] & kSpatial) != 0);
  const DxfFrame own =
      world || !entity.extrusion ? frame : frame * dxf_object_frame(*entity.extrusion);
  Pen pen(own, tolerance, line);
  if (entity.type == "LINE") {
    pen.to(entity.p10);
    pen.to(entity.p11);
  } else if (entity.type == "ELLIPSE") {
    ellipse(entity, pen, wrong);
  } else if (entity.type == "SPLINE") {
    spline(entity, own, tolerance, most, line, wrong);
  } else if (entity.type == "CIRCLE" || entity.type == "ARC") {
    circle(entity, pen, wrong);
  } else {
    polyline(entity, pen, most, line);
  }
  return upright(entity, world, pen) ? DxfShape::Flat : DxfShape::Tilted;
}

}  // namespace popcut
