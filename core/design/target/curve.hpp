// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/geometry/design_angle.hpp"

namespace popcut {

/// A point of a slice's section: x from the wall, z above the ground, mm.
struct SectionPoint {
  double x{};
  double z{};
};

/// Point and derivatives of a slice curve by its parameter.
struct CurveJet {
  double x{}, z{};
  double dx{}, dz{};
  double ddx{}, ddz{};
};

/// Distance of a point from a slice curve within the slice's plane, mm, positive outside, and its
/// gradient.
struct CurveDistance {
  double e{};
  double de_dx{}, de_dz{};
};

/// The target cut by one plane v = const: a curve that falls from `(0, h)` on the wall to `(d, 0)`
/// on the ground.
///
/// It is held as a graph over its chord: with `t = x/d - z/h` in [-1, 1], `n(t) = x/d + z/h`. Every
/// falling curve has such an `n` with |n'| <= 1, so that walls and grounds met at a right angle,
/// where z(x) has an infinite slope, are nothing special. Without pieces `n = sqrt(2 - t^2)`, the
/// quarter ellipse (a quarter circle for h = d).
class SliceCurve {
 public:
  /// Quarter ellipse with half axes `d_mm` (x) and `h_mm` (z).
  SliceCurve(double h_mm, double d_mm) : h_(h_mm), d_(d_mm) {}

  /// Interpolates `x_at`, which gives the x of the point with a given t. It is sampled at Chebyshev
  /// points of as many pieces as an error of about ten `tolerance` of the size needs, each at least
  /// 2^-max_depth of the whole.
  ///
  /// @param knots  values of t, growing, at which it is known not to be smooth: pieces end there
  static SliceCurve sampled(double h_mm, double d_mm, const std::function<double(double)>& x_at,
                            double tolerance = 1e-14, int max_depth = 12,
                            const std::vector<double>& knots = {});

  /// A smooth curve along a polyline that falls from (0, h) to (d, 0): a cubic B-spline over the
  /// chord with the polyline's own n as control points. Its slopes are averages of the polyline's,
  /// so that it falls wherever that does; it keeps both ends, and strays by a sixth of the squared
  /// knot distance times n'' (2.5e-6 n'' of the size), or at a corner by a third of that distance
  /// times half the corner's change of slope.
  static SliceCurve through(const std::vector<SectionPoint>& points);

  [[nodiscard]] double h() const { return h_; }
  [[nodiscard]] double d() const { return d_; }
  /// Where (x, z) are oblique coordinates, lengths and distances in space follow from the angle.
  void set_opening(const DesignAngle& opening) { cosine_ = opening.cosine; }
  [[nodiscard]] double cosine() const { return cosine_; }
  [[nodiscard]] bool is_ellipse() const { return pieces_.empty() && control_.empty(); }
  [[nodiscard]] bool is_circle() const { return is_ellipse() && h_ == d_ && cosine_ == 0.0; }

  /// Whether it turns both ways: its chain may then have several minima.
  [[nodiscard]] bool has_inflections() const { return inflected_; }

  [[nodiscard]] CurveJet at(double t) const;
  /// Signed distance in space to first order, exact for a circle: what the conformal lattice drives
  /// to zero.
  [[nodiscard]] CurveDistance distance(SectionPoint p) const;
  /// Distance of `p` from the nearest point of the curve in space, mm, by Newton on t.
  [[nodiscard]] double nearest_distance(SectionPoint p) const;
  /// `count + 1` parameters from -1 to 1 at equal arc lengths (equal angles for a circle).
  [[nodiscard]] std::vector<double> equal_arcs(int count) const;

 private:
  static constexpr int kDegree = 24;
  struct Piece {
    double t_begin{}, t_end{};
    std::array<double, kDegree + 1> value{};   ///< Chebyshev coefficients of n
    std::array<double, kDegree + 1> first{};   ///< of dn/dt
    std::array<double, kDegree + 1> second{};  ///< of d2n/dt2
  };
  struct Rise {
    double n{}, dn{}, ddn{};
  };
  [[nodiscard]] Rise rise(double t) const;
  [[nodiscard]] Rise spline_rise(double t) const;
  void find_inflections();
  void add_pieces(double t_begin, double t_end, double tolerance, int depth,
                  const std::function<double(double)>& n_at);

  double h_{}, d_{};
  double cosine_{};  ///< of the angle between the axes of x and z
  bool inflected_{false};
  std::vector<Piece> pieces_;
  std::vector<double> control_;  ///< of a uniform cubic B-spline on [-1, 1], clamped at both ends
};

}  // namespace popcut
