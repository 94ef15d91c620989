// SPDX-License-Identifier: MIT
#include "core/design/target/curve.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

constexpr int kSplinePieces = 512;
constexpr double kTurn = 0.02;  ///< changes of slope below this are facets or rounding, not turns

/// Knot i of the clamped spline, i from -3 to kSplinePieces + 3.
double spline_knot(int i) { return -1.0 + 2.0 * std::clamp(i, 0, kSplinePieces) / kSplinePieces; }

/// Clenshaw's sum of a Chebyshev series at y in [-1, 1].
double chebyshev(const double* c, int degree, double y) {
  double b1 = 0.0, b2 = 0.0;
  for (int k = degree; k >= 1; --k) {
    const double b = 2.0 * y * b1 - b2 + c[k];
    b2 = b1;
    b1 = b;
  }
  return y * b1 - b2 + c[0];
}

/// Coefficients of the derivative by t of a series on an interval of length `length`.
void derive(const double* c, int degree, double length, double* out) {
  out[degree] = 0.0;
  double next = 0.0, after = 0.0;
  for (int k = degree - 1; k >= 0; --k) {
    const double value = after + 2.0 * (k + 1) * c[k + 1];
    after = next;
    next = value;
    out[k] = (k == 0 ? 0.5 : 1.0) * value * 2.0 / length;
  }
}

}  // namespace

SliceCurve SliceCurve::sampled(double h_mm, double d_mm, const std::function<double(double)>& x_at,
                               double tolerance, int max_depth, const std::vector<double>& knots) {
  SliceCurve curve(h_mm, d_mm);
  const auto n_at = [&](double t) { return 2.0 * x_at(t) / d_mm - t; };  // n = 2 x/d - t
  constexpr double kShortest = 1e-6;
  double begin = -1.0;
  for (const double knot : knots) {
    if (knot < begin + kShortest || knot > 1.0 - kShortest) continue;
    curve.add_pieces(begin, knot, tolerance, max_depth, n_at);
    begin = knot;
  }
  curve.add_pieces(begin, 1.0, tolerance, max_depth, n_at);
  curve.find_inflections();
  return curve;
}

SliceCurve SliceCurve::through(const std::vector<SectionPoint>& points) {
  SliceCurve curve(points.front().z, points.back().x);
  const auto t_of = [&](const SectionPoint& p) { return p.x / curve.d_ - p.z / curve.h_; };
  curve.control_.resize(kSplinePieces + 3);
  std::size_t k = 1;
  for (int i = 0; i < kSplinePieces + 3; ++i) {
    // Greville's abscissa of control point i: the mean of its three inner knots.
    const double t = (spline_knot(i - 2) + spline_knot(i - 1) + spline_knot(i)) / 3.0;
    while (k + 1 < points.size() && t_of(points[k]) < t) ++k;
    const SectionPoint &a = points[k - 1], &b = points[k];
    const double ta = t_of(a), tb = t_of(b);
    const double share = tb > ta ? std::clamp((t - ta) / (tb - ta), 0.0, 1.0) : 0.0;
    const double x = a.x + share * (b.x - a.x), z = a.z + share * (b.z - a.z);
    curve.control_[static_cast<std::size_t>(i)] = x / curve.d_ + z / curve.h_;
  }
  curve.control_.front() = curve.control_.back() = 1.0;
  curve.find_inflections();
  return curve;
}

void SliceCurve::find_inflections() {
  constexpr int kSamples = 128;
  double most = 0.0, least = 0.0;  // of the change of slope since the last turn
  bool up = false, down = false;
  double last = rise(-1.0 + 1e-3).dn;
  for (int k = 1; k <= kSamples; ++k) {
    const double dn = rise((1.0 - 1e-3) * (-1.0 + 2.0 * k / kSamples)).dn;
    most = std::max(0.0, most + dn - last), least = std::min(0.0, least + dn - last);
    last = dn;
    up = up || most > kTurn, down = down || least < -kTurn;
  }
  inflected_ = up && down;
}

void SliceCurve::add_pieces(double t_begin, double t_end, double tolerance, int depth,
                            const std::function<double(double)>& n_at) {
  const int n = kDegree;
  std::array<double, n + 1> sample;
  for (int k = 0; k <= n; ++k)
    sample[k] =
        n_at(t_begin + (t_end - t_begin) * 0.5 * (1.0 + std::cos(kPi * (k + 0.5) / (n + 1))));
  Piece piece;
  piece.t_begin = t_begin;
  piece.t_end = t_end;
  for (int j = 0; j <= n; ++j) {
    double sum = 0.0;
    for (int k = 0; k <= n; ++k) sum += sample[k] * std::cos(kPi * j * (k + 0.5) / (n + 1));
    piece.value[j] = sum * (j == 0 ? 1.0 : 2.0) / (n + 1);
  }
  const double tail = std::max(
      {std::abs(piece.value[n]), std::abs(piece.value[n - 1]), std::abs(piece.value[n - 2])});
  if (tail > tolerance && depth > 0) {
    const double middle = 0.5 * (t_begin + t_end);
    // Kinks and end singularities are met by halving; smooth halves stop at once.
    add_pieces(t_begin, middle, tolerance, depth - 1, n_at);
    add_pieces(middle, t_end, tolerance, depth - 1, n_at);
    return;
  }
  derive(piece.value.data(), n, t_end - t_begin, piece.first.data());
  derive(piece.first.data(), n, t_end - t_begin, piece.second.data());
  pieces_.push_back(piece);
}

SliceCurve::Rise SliceCurve::rise(double t) const {
  if (t < -1.0 || t > 1.0) {  // beyond wall and ground: straight on
    const double end = t < 0.0 ? -1.0 : 1.0;
    const Rise at_end = rise(end);
    return {at_end.n + at_end.dn * (t - end), at_end.dn, 0.0};
  }
  if (is_ellipse()) {
    const double n = std::sqrt(2.0 - t * t);
    const double dn = -t / n;
    return {n, dn, -(1.0 + dn * dn) / n};
  }
  if (!control_.empty()) return spline_rise(t);
  const auto it = std::partition_point(pieces_.begin(), pieces_.end() - 1,
                                       [t](const Piece& p) { return p.t_end < t; });
  const double y =
      std::clamp((2.0 * t - it->t_begin - it->t_end) / (it->t_end - it->t_begin), -1.0, 1.0);
  return {chebyshev(it->value.data(), kDegree, y), chebyshev(it->first.data(), kDegree, y),
          chebyshev(it->second.data(), kDegree, y)};
}

/// De Boor's recursion on the one interval that holds t, with its first two derivatives.
SliceCurve::Rise SliceCurve::spline_rise(double t) const {
  const int at =
      std::clamp(static_cast<int>(0.5 * (t + 1.0) * kSplinePieces), 0, kSplinePieces - 1);
  const double* const c = control_.data() + at;
  std::array<double, 6> knot;
  for (int i = 0; i < 6; ++i) knot[i] = spline_knot(at - 2 + i);
  std::array<double, 3> first;
  std::array<double, 2> second;
  for (int i = 0; i < 3; ++i) first[i] = 3.0 * (c[i + 1] - c[i]) / (knot[i + 3] - knot[i]);
  for (int i = 0; i < 2; ++i)
    second[i] = 2.0 * (first[i + 1] - first[i]) / (knot[i + 3] - knot[i + 1]);
  const double width = knot[3] - knot[2], share = (t - knot[2]) / width;
  const double ddn = second[0] + share * (second[1] - second[0]);
  const auto mix = [&](double a, double b, double from, double to) {
    return a + (t - from) / (to - from) * (b - a);
  };
  const double f0 = mix(first[0], first[1], knot[1], knot[3]);
  const double f1 = mix(first[1], first[2], knot[2], knot[4]);
  const double dn = mix(f0, f1, knot[2], knot[3]);
  std::array<double, 3> v;
  for (int i = 0; i < 3; ++i) v[i] = mix(c[i], c[i + 1], knot[i], knot[i + 3]);
  const double v0 = mix(v[0], v[1], knot[1], knot[3]), v1 = mix(v[1], v[2], knot[2], knot[4]);
  return {mix(v0, v1, knot[2], knot[3]), dn, ddn};
}

CurveJet SliceCurve::at(double t) const {
  const Rise r = rise(t);
  return {0.5 * d_ * (r.n + t),    0.5 * h_ * (r.n - t), 0.5 * d_ * (r.dn + 1.0),
          0.5 * h_ * (r.dn - 1.0), 0.5 * d_ * r.ddn,     0.5 * h_ * r.ddn};
}

CurveDistance SliceCurve::distance(SectionPoint p) const {
  if (is_circle()) {
    const double rho = std::hypot(p.x, p.z);
    return {rho - h_, p.x / rho, p.z / rho};
  }
  const double t = p.x / d_ - p.z / h_;
  const Rise r = rise(t);
  const double f = p.x / d_ + p.z / h_ - r.n;
  const double fx = (1.0 - r.dn) / d_, fz = (1.0 + r.dn) / h_;
  const double slope =
      cosine_ == 0.0
          ? std::hypot(fx, fz)
          : std::sqrt((fx * fx + fz * fz - 2.0 * cosine_ * fx * fz) / (1.0 - cosine_ * cosine_));
  return {f / slope, fx / slope, fz / slope};
}

double SliceCurve::nearest_distance(SectionPoint p) const {
  if (is_circle() && p.x >= 0.0 && p.z >= 0.0) return std::abs(std::hypot(p.x, p.z) - h_);
  const auto product = [&](double ax, double az, double bx, double bz) {
    return ax * bx + az * bz + cosine_ * (ax * bz + az * bx);
  };
  const auto gap2 = [&](double s) {
    const CurveJet c = at(s);
    return product(c.x - p.x, c.z - p.z, c.x - p.x, c.z - p.z);
  };
  const auto least_from = [&](double t) {
    double best = gap2(t);
    for (int step = 0; step < 50; ++step) {
      const CurveJet c = at(t);
      const double g = product(c.x - p.x, c.z - p.z, c.dx, c.dz);
      const double bend = product(c.x - p.x, c.z - p.z, c.ddx, c.ddz);
      const double speed2 = product(c.dx, c.dz, c.dx, c.dz);
      const double h = speed2 + bend > 0.1 * speed2 ? speed2 + bend : speed2;
      double move = -g / h;
      double next = best;
      for (; std::abs(move) > 1e-15; move *= 0.5) {
        next = gap2(std::clamp(t + move, -1.0, 1.0));
        if (next <= best) break;
      }
      if (!(next <= best) || std::abs(move) <= 1e-15) break;
      t = std::clamp(t + move, -1.0, 1.0);
      best = next;
    }
    return best;
  };
  double best = least_from(std::clamp(p.x / d_ - p.z / h_, -1.0, 1.0));
  // Far from a curve that turns both ways there may be a nearer stretch than the one at hand.
  constexpr double kFar = 0.02;
  if (inflected_ && best > std::pow(kFar * (h_ + d_), 2)) {
    constexpr int kPlaces = 32;
    double nearest = 0.0, gap = best;
    for (int k = 0; k <= kPlaces; ++k) {
      const double t = -1.0 + 2.0 * k / kPlaces;
      if (const double here = gap2(t); here < gap) nearest = t, gap = here;
    }
    if (gap < best) best = std::min(best, least_from(nearest));
  }
  return std::sqrt(std::max(0.0, best));
}

std::vector<double> SliceCurve::equal_arcs(int count) const {
  std::vector<double> t(static_cast<std::size_t>(count) + 1);
  if (is_circle()) {
    // x = sin a, z = cos a: t = sin a - cos a.
    for (int i = 0; i <= count; ++i) {
      const double a = 0.5 * kPi * i / count;
      t[static_cast<std::size_t>(i)] = std::sin(a) - std::cos(a);
    }
  } else {
    const int samples = std::max(64, 4 * count);
    std::vector<double> length(static_cast<std::size_t>(samples) + 1, 0.0);
    CurveJet last = at(-1.0);
    for (int k = 1; k <= samples; ++k) {
      const CurveJet here = at(-1.0 + 2.0 * k / samples);
      length[static_cast<std::size_t>(k)] =
          length[static_cast<std::size_t>(k) - 1] + std::hypot(here.x - last.x, here.z - last.z);
      last = here;
    }
    std::size_t k = 0;
    for (int i = 0; i <= count; ++i) {
      const double want = length.back() * i / count;
      while (k + 2 < length.size() && length[k + 1] < want) ++k;
      const double share = (want - length[k]) / (length[k + 1] - length[k]);
      t[static_cast<std::size_t>(i)] = -1.0 + 2.0 * (static_cast<double>(k) + share) / samples;
    }
  }
  t.front() = -1.0;
  t.back() = 1.0;
  return t;
}

}  // namespace popcut
