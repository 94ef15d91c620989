// SPDX-License-Identifier: MIT
#include "core/formats/dxf/dxf_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr double kMostChords = 20'000;  // of one arc
constexpr int kMostHalvings = 14;       // of one knot span

constexpr std::size_t kMostSplineWork = 200'000'000;  // limit of control points times order cubed

/// A control point of a rational curve: (w x, w y, w).
struct Weighted {
  double x{}, y{}, w{1};
};

using Bezier = std::array<Weighted, kMostSplineDegree + 1>;

PagePoint plain(const Weighted& p) { return {p.x / p.w, p.y / p.w}; }

Weighted between(const Weighted& a, const Weighted& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.w + t * (b.w - a.w)};
}

double off_chord(const PagePoint& p, const PagePoint& a, const PagePoint& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double t =
      squared > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/// Receives the points of halved Bezier curves, except the first.
struct Sink {
  double tolerance;
  std::size_t most;
  std::vector<PagePoint>& line;
};

void halve(const Bezier& curve, std::size_t degree, int depth, const Sink& sink) {
  if (sink.line.size() > sink.most) return;
  const PagePoint a = plain(curve[0]), b = plain(curve[degree]);
  double off = 0.0;
  for (std::size_t i = 1; i < degree; ++i) off = std::max(off, off_chord(plain(curve[i]), a, b));
  if (!(off > sink.tolerance) || depth >= kMostHalvings) {
    sink.line.push_back(b);
    return;
  }
  Bezier left{}, right = curve;  // de Casteljau at the middle
  for (std::size_t r = 0; r <= degree; ++r) {
    left[r] = right[0];
    for (std::size_t i = 0; i + r < degree; ++i) right[i] = between(right[i], right[i + 1], 0.5);
  }
  // The last pass leaves the right half reversed in place: right[i] is already its i-th point.
  halve(left, degree, depth + 1, sink);
  halve(right, degree, depth + 1, sink);
}

/// The value of the polar form of the spline's span `i` at the knots u_i (degree - j times) and
/// u_{i+1} (j times): the j-th Bezier point of that span.
Weighted polar(const DxfSpline& spline, std::size_t i, std::size_t j) {
  const auto p = static_cast<std::size_t>(spline.degree);
  Bezier d{};
  for (std::size_t k = 0; k <= p; ++k) {
    const PagePoint& c = spline.control[i - p + k];
    const double w = spline.weights.empty() ? 1.0 : spline.weights[i - p + k];
    d[k] = {w * c.x, w * c.y, w};
  }
  for (std::size_t r = 1; r <= p; ++r) {
    const double t = spline.knots[r <= p - j ? i : i + 1];
    for (std::size_t k = p; k >= r; --k) {
      const double low = spline.knots[i - p + k], high = spline.knots[i + k - r + 1];
      d[k] = between(d[k - 1], d[k], (t - low) / (high - low));
    }
  }
  return d[p];
}

void add_cubic(const PagePoint& a, const PagePoint& da, const PagePoint& b, const PagePoint& db,
               double h, const Sink& sink) {
  Bezier curve{};
  curve[0] = {a.x, a.y, 1};
  curve[1] = {a.x + da.x * h / 3, a.y + da.y * h / 3, 1};
  curve[2] = {b.x - db.x * h / 3, b.y - db.y * h / 3, 1};
  curve[3] = {b.x, b.y, 1};
  halve(curve, 3, 0, sink);
}

/// Tangents at all points of the cubic spline through them; `h` are the parameters between them.
std::vector<PagePoint> tangents(const std::vector<PagePoint>& p, const std::vector<double>& h,
                                std::optional<PagePoint> first, std::optional<PagePoint> last) {
  const std::size_t n = p.size();
  // Rows: low t[i-1] + mid t[i] + high t[i+1] = right, solved by elimination (Thomas).
  std::vector<double> high(n);
  std::vector<PagePoint> t(n);
  const auto slope = [&](std::size_t i) {
    return PagePoint{(p[i + 1].x - p[i].x) / h[i], (p[i + 1].y - p[i].y) / h[i]};
  };
  double mid = first ? 1.0 : 2.0;
  high[0] = first ? 0.0 : 1.0 / mid;
  t[0] = first ? *first : PagePoint{3 * slope(0).x / mid, 3 * slope(0).y / mid};
  for (std::size_t i = 1; i < n; ++i) {
    double low = 0.0, up = 0.0;
    PagePoint right;
    if (i + 1 < n) {
      const PagePoint s0 = slope(i - 1), s1 = slope(i);
      low = h[i];
      up = h[i - 1];
      mid = 2 * (h[i - 1] + h[i]);
      right = {3 * (h[i] * s0.x + h[i - 1] * s1.x), 3 * (h[i] * s0.y + h[i - 1] * s1.y)};
    } else if (last) {
      mid = 1.0;
      right = *last;
    } else {
      low = 1.0;
      mid = 2.0;
      right = {3 * slope(n - 2).x, 3 * slope(n - 2).y};
    }
    mid -= low * high[i - 1];
    high[i] = up / mid;
    t[i] = {(right.x - low * t[i - 1].x) / mid, (right.y - low * t[i - 1].y) / mid};
  }
  for (std::size_t i = n - 1; i-- > 0;) {
    t[i].x -= high[i] * t[i + 1].x;
    t[i].y -= high[i] * t[i + 1].y;
  }
  return t;
}

}  // namespace

std::optional<Vec3> dxf_unit(const Vec3& a) {
  const double l = std::hypot(a.x(), a.y(), a.z());
  if (!(l > 0.0) || !std::isfinite(l)) return std::nullopt;
  return Vec3(a / l);
}

DxfFrame dxf_object_frame(const Vec3& extrusion) {
  const auto n = dxf_unit(extrusion);
  if (!n) return {};
  constexpr double kNear = 1.0 / 64;
  const bool near_z = std::abs(n->x()) < kNear && std::abs(n->y()) < kNear;
  const auto ax = dxf_unit(cross(near_z ? Vec3{0, 1, 0} : Vec3{0, 0, 1}, *n));
  if (!ax) return {};
  return {*ax, cross(*n, *ax), *n, {}};
}

void flatten_turn(const PagePoint& c, const PagePoint& a, const PagePoint& b, double from,
                  double span, double tolerance, bool with_first, std::vector<PagePoint>& line) {
  // The longest semi-axis: the larger singular value of (a b).
  const double sum = a.x * a.x + a.y * a.y + b.x * b.x + b.y * b.y;
  const double area = a.x * b.y - a.y * b.x;
  const double r =
      std::sqrt((sum + std::sqrt(std::max(0.0, (sum - 2 * area) * (sum + 2 * area)))) / 2);
  const double step = 2 * std::acos(1 - std::min(tolerance / r, 1.0));
  double n = std::ceil(std::abs(span) / step);
  const bool full = std::abs(span) >= 2 * std::numbers::pi - 1e-12;
  n = n >= (full ? 3.0 : 1.0) ? std::min(n, kMostChords) : full ? 3.0 : 1.0;
  const auto at = [&](double t) {
    return PagePoint{c.x + a.x * std::cos(t) + b.x * std::sin(t),
                     c.y + a.y * std::cos(t) + b.y * std::sin(t)};
  };
  const PagePoint first = at(from);
  if (with_first) line.push_back(first);
  const int count = static_cast<int>(n);
  for (int i = 1; i < count; ++i) line.push_back(at(from + span * i / count));
  line.push_back(full ? first : at(from + span));
}

std::optional<Vec3> bulge_centre(const Vec3& p, const Vec3& q, double bulge) {
  constexpr double kStraight = 1e-9;  // error below 0.1 um on a chord of 100 m
  if (!(std::abs(bulge) > kStraight) || (p.x() == q.x() && p.y() == q.y())) return std::nullopt;
  const double f = (1 / bulge - bulge) / 4;
  return Vec3{(p.x() + q.x()) / 2 - f * (q.y() - p.y()), (p.y() + q.y()) / 2 + f * (q.x() - p.x()),
              p.z()};
}

std::string check_spline(DxfSpline& spline) {
  const std::size_t n = spline.control.size();
  if (spline.degree < 1 || spline.degree > kMostSplineDegree)
    return fmt::format("the spline has degree {}; use 1 to {}", spline.degree, kMostSplineDegree);
  const auto p = static_cast<std::size_t>(spline.degree);
  if (n < p + 1)
    return fmt::format("the spline has {} control points; degree {} needs at least {}", n, p,
                       p + 1);
  if (n * (p + 1) * (p + 1) * (p + 1) > kMostSplineWork)
    return fmt::format("the spline has {} control points of degree {}; split it", n, p);
  if (spline.knots.empty())
    for (std::size_t i = 0; i < n + p + 1; ++i)
      spline.knots.push_back(static_cast<double>(std::clamp(i, p, n) - p));
  if (spline.knots.size() != n + p + 1)
    return fmt::format("the spline has {} knots; {} control points of degree {} need {}",
                       spline.knots.size(), n, p, n + p + 1);
  if (!std::is_sorted(spline.knots.begin(), spline.knots.end()))
    return "the spline's knots decrease; they must not";
  if (!(spline.knots[n] > spline.knots[p]))
    return "the spline's knots are all equal; they must increase";
  if (!spline.weights.empty() && spline.weights.size() != n)
    return fmt::format("the spline has {} weights; {} control points need as many",
                       spline.weights.size(), n);
  for (const double w : spline.weights)
    if (!(w >= 1e-9 && w <= 1e9))
      return fmt::format("the spline has a weight of {:g}; weights must be above 0", w);
  return {};
}

void flatten_spline(const DxfSpline& spline, double tolerance, std::size_t most,
                    std::vector<PagePoint>& line) {
  const auto p = static_cast<std::size_t>(spline.degree);
  const Sink sink{tolerance, most, line};
  bool first = true;
  for (std::size_t i = p; i < spline.control.size() && line.size() <= most; ++i) {
    if (!(spline.knots[i + 1] > spline.knots[i])) continue;
    Bezier curve{};
    for (std::size_t j = 0; j <= p; ++j) curve[j] = polar(spline, i, j);
    if (first) line.push_back(plain(curve[0]));
    first = false;
    halve(curve, p, 0, sink);
  }
}

void flatten_fit(std::vector<PagePoint> fit, std::optional<PagePoint> from_tangent,
                 std::optional<PagePoint> to_tangent, bool closed, double tolerance,
                 std::size_t most, std::vector<PagePoint>& line) {
  fit.erase(std::unique(fit.begin(), fit.end()), fit.end());
  if (closed && fit.size() > 2 && fit.front() == fit.back()) fit.pop_back();
  const std::size_t n = fit.size();
  if (n < 2) return;
  const bool round = closed && n > 2;
  // A closed curve is repeated around itself a few times: the influence of an end decays by 0.27
  // per point.
  constexpr std::size_t kAround = 24;
  std::vector<PagePoint> p;
  if (round)
    for (std::size_t i = 0; i < n + 1 + 2 * kAround; ++i)
      p.push_back(fit[(i + n * kAround - kAround) % n]);
  else
    p = std::move(fit);
  std::vector<double> h(p.size() - 1);
  for (std::size_t i = 0; i < h.size(); ++i)
    h[i] = std::hypot(p[i + 1].x - p[i].x, p[i + 1].y - p[i].y);
  const auto t = round ? tangents(p, h, {}, {}) : tangents(p, h, from_tangent, to_tangent);
  const std::size_t begin = round ? kAround : 0, end = round ? kAround + n : h.size();
  line.push_back(p[begin]);
  const Sink sink{tolerance, most, line};
  for (std::size_t i = begin; i < end; ++i) add_cubic(p[i], t[i], p[i + 1], t[i + 1], h[i], sink);
}

DxfDashes dxf_dashes(std::span<const double> elements) {
  DxfDashes out;
  bool dash = false, gap = false;
  for (const double e : elements) {
    dash = dash || e > 0.0;
    gap = gap || e < 0.0;
    out.period += std::abs(e);
  }
  if (!dash || !gap || !std::isfinite(out.period)) return {};
  double at = elements.back() < 0.0 ? -elements.back() / 2 : 0.0;
  for (const double e : elements) {
    if (e > 0.0) out.dashes.push_back({at / out.period, (at + e) / out.period});
    at += std::abs(e);
  }
  return out;
}

double dxf_periods(double length, double period) {
  return std::max(1.0, std::round(length / period));
}

}  // namespace popcut
