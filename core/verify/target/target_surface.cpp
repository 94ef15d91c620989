// SPDX-License-Identifier: MIT
#include "core/verify/target/target_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include <muParser.h>

namespace popcut::verify {
namespace {

constexpr int kSectionSteps = 96;

/// An expression of x, y, z and perhaps L.
class Expression {
 public:
  Expression(const std::string& text, std::optional<double> length) : length_(length.value_or(0)) {
    parser_.DefineVar("x", &x_);
    parser_.DefineVar("y", &y_);
    parser_.DefineVar("z", &z_);
    if (length) parser_.DefineVar("L", &length_);
    parser_.DefineFun("floor", [](double a) { return std::floor(a); });
    parser_.DefineFun("ceil", [](double a) { return std::ceil(a); });
    parser_.DefineFun("round", [](double a) { return std::round(a); });
    parser_.DefineFun("mod", [](double a, double b) { return a - b * std::floor(a / b); });
    parser_.DefineConst("pi", std::numbers::pi);
    parser_.DefineConst("e", std::numbers::e);
    parser_.SetExpr(text);
    (void)parser_.Eval();  // throws if it cannot parse the expression
  }
  Expression(const Expression&) = delete;
  Expression& operator=(const Expression&) = delete;

  [[nodiscard]] double operator()(double x, double y, double z) {
    x_ = x;
    y_ = y;
    z_ = z;
    try {
      return parser_.Eval();
    } catch (const mu::Parser::exception_type&) {  // some functions throw outside their domain
      return std::numeric_limits<double>::quiet_NaN();
    }
  }

 private:
  double x_{0.25}, y_{0.25}, z_{0.25}, length_;
  mu::Parser parser_;
};

/// The surface's y at a position along the spine, for an upright placement.
double upright_y(const TargetPlacement& placement, double s_mm) {
  return (s_mm - placement.translate_mm[1]) / placement.scale_mm;
}

/// Quarter circles about the spine.
class Revolution : public TargetSurface {
 public:
  Revolution(TargetFormula radius, const TargetPlacement& placement)
      : radius_(std::move(radius)), placement_(placement) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const double r_mm = radius_mm(s_mm);
    return r_mm > 0.0 ? std::abs(std::hypot(x_mm, z_mm) - r_mm) : -1.0;
  }
  [[nodiscard]] CurveEnds ends_mm(double s_mm) const override {
    const double r_mm = radius_mm(s_mm);
    return {r_mm, r_mm};
  }
  void add_triangles(const TargetReach& reach, TriangleMesh& out) const override {
    const double opening = std::atan2(placement_.wall.sine, placement_.wall.cosine);
    const auto section = [&](double s_mm) {
      TargetPoints points;
      const double r_mm = radius_mm(s_mm);
      if (!(r_mm > 0.0)) return points;
      for (int k = 0; k <= kSectionSteps; ++k) {
        const double angle = opening * (1.0 - static_cast<double>(k) / kSectionSteps);
        points.push_back({r_mm * std::cos(angle), r_mm * std::sin(angle)});
      }
      return points;
    };
    add_sections(reach, section, out);
  }

 private:
  [[nodiscard]] double radius_mm(double s_mm) const {
    return placement_.scale_mm * radius_(0.0, upright_y(placement_, s_mm), 0.0);
  }

  TargetFormula radius_;
  TargetPlacement placement_;
};

/// A profile z(x, y), for x from 0 to where it reaches 0.
class Profile : public TargetSurface {
 public:
  Profile(TargetFormula z, const TargetPlacement& placement)
      : z_(std::move(z)), placement_(placement), scale_(placement.scale_mm) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const double y = upright_y(placement_, s_mm);
    const auto away = [&](double x) {
      return std::hypot(x - x_mm / scale_, z_(x, y, 0.0) - z_mm / scale_);
    };
    const double end = ground_end(y);
    if (!(end > 0.0)) return -1.0;
    // Sampled, then narrowed around the nearest sample. The curve can be steep near the ground, so
    // samples are denser towards both ends.
    constexpr int kSamples = 400;
    const auto at = [&](double t) { return end * 0.5 * (1.0 - std::cos(std::numbers::pi * t)); };
    int nearest = 0;
    for (int k = 1; k <= kSamples; ++k) {
      const double candidate = away(at(static_cast<double>(k) / kSamples));
      if (candidate < away(at(static_cast<double>(nearest) / kSamples))) nearest = k;
    }
    double low = static_cast<double>(std::max(0, nearest - 1)) / kSamples;
    double high = static_cast<double>(std::min(kSamples, nearest + 1)) / kSamples;
    for (int step = 0; step < 100; ++step) {
      const double a = low + (high - low) / 3.0;
      const double b = high - (high - low) / 3.0;
      away(at(a)) < away(at(b)) ? high = b : low = a;
    }
    const double found = scale_ * away(at(0.5 * (low + high)));
    return std::isfinite(found) ? found : -1.0;
  }
  [[nodiscard]] CurveEnds ends_mm(double s_mm) const override {
    const double y = upright_y(placement_, s_mm);
    return {scale_ * z_(0.0, y, 0.0), scale_ * ground_end(y)};
  }
  void add_triangles(const TargetReach& reach, TriangleMesh& out) const override {
    const auto section = [&](double s_mm) {
      TargetPoints points;
      const double y = upright_y(placement_, s_mm), end = ground_end(y);
      if (!(end > 0.0)) return points;
      for (int k = 0; k <= kSectionSteps; ++k) {
        // Denser towards both ends, where the curve can be steep.
        const double x =
            end * 0.5 * (1.0 - std::cos(std::numbers::pi * k / static_cast<double>(kSectionSteps)));
        const double z = k == kSectionSteps ? 0.0 : z_(x, y, 0.0);
        if (!std::isfinite(z)) return TargetPoints();
        points.push_back({scale_ * x, scale_ * z});
      }
      return points;
    };
    add_sections(reach, section, out);
  }

 private:
  /// The smallest x > 0 at which the profile reaches 0 or touches it; negative if it never does.
  [[nodiscard]] double ground_end(double y) const {
    const double height = z_(0.0, y, 0.0);
    if (!(height > 0.0)) return -1.0;
    double step = height / 256.0;
    double before = 0.0, above = 0.0, below = step;
    double last = height, here = z_(below, y, 0.0);
    for (int k = 0; k < 8192 && here > 0.0; ++k) {
      if (here > last) {
        const double x = lowest(before, below, y);
        if (z_(x, y, 0.0) < 1e-9 * height) return touching(x, height, y);
      }
      before = above;
      above = below;
      below += step;
      if (k % 1024 == 1023) step *= 2.0;
      last = here, here = z_(below, y, 0.0);
    }
    if (here > 0.0) return -1.0;
    for (int k = 0; k < 80; ++k) {
      const double middle = 0.5 * (above + below);
      (z_(middle, y, 0.0) > 0.0 ? above : below) = middle;
    }
    return above;
  }

  /// Where the profile is lowest between two places around a minimum.
  [[nodiscard]] double lowest(double low, double high, double y) const {
    for (int k = 0; k < 100; ++k) {
      const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
      z_(a, y, 0.0) < z_(b, y, 0.0) ? high = b : low = a;
    }
    return 0.5 * (low + high);
  }

  /// The place of a minimum near x, by the sign of the slope: the value itself is flat there, so it
  /// shows the place to half the digits only.
  [[nodiscard]] double touching(double x, double height, double y) const {
    const double reach = 1e-3 * height;
    const auto rises = [&](double p) { return z_(p + reach, y, 0.0) > z_(p - reach, y, 0.0); };
    double low = x - 1e-4 * height, high = x + 1e-4 * height;
    if (rises(low) || !rises(high)) return x;
    for (int k = 0; k < 80; ++k) {
      const double middle = 0.5 * (low + high);
      (rises(middle) ? high : low) = middle;
    }
    return 0.5 * (low + high);
  }

  TargetFormula z_;
  TargetPlacement placement_;
  double scale_;
};

/// Several surfaces, one after the other along the spine.
class Stretched : public TargetSurface {
 public:
  explicit Stretched(std::vector<TargetStretch> stretches) : stretches_(std::move(stretches)) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const TargetStretch& here = at(s_mm);
    return here.surface->distance_mm(s_mm - here.origin_mm, x_mm, z_mm);
  }
  [[nodiscard]] CurveEnds ends_mm(double s_mm) const override {
    const TargetStretch& here = at(s_mm);
    return here.surface->ends_mm(s_mm - here.origin_mm);
  }
  void add_triangles(const TargetReach& reach, TriangleMesh& out) const override {
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      TargetReach own = reach;
      if (k > 0) own.begin_mm = std::max(reach.begin_mm, stretches_[k].begin_mm);
      if (k + 1 < stretches_.size())
        own.end_mm = std::min(reach.end_mm, stretches_[k + 1].begin_mm);
      if (!(own.end_mm > own.begin_mm)) continue;
      own.begin_mm -= stretches_[k].origin_mm, own.end_mm -= stretches_[k].origin_mm;
      const std::size_t first = out.corners.size();
      stretches_[k].surface->add_triangles(own, out);
      for (std::size_t i = first + 1; i < out.corners.size(); i += 3)
        out.corners[i] += static_cast<float>(stretches_[k].origin_mm);
    }
  }

 private:
  [[nodiscard]] const TargetStretch& at(double s_mm) const {
    const auto after = std::upper_bound(
        stretches_.begin(), stretches_.end(), s_mm,
        [](double s, const TargetStretch& stretch) { return s < stretch.begin_mm; });
    return after == stretches_.begin() ? stretches_.front() : *(after - 1);
  }

  std::vector<TargetStretch> stretches_;
};

}  // namespace

TargetWall TargetWall::at_deg(double angle_deg) {
  if (angle_deg == 90.0) return {};
  const double angle = std::numbers::pi * angle_deg / 180.0;
  return {std::cos(angle), std::sin(angle)};
}

bool TargetPlacement::upright() const {
  return rotate_deg == std::array<double, 3>{} && translate_mm[0] == 0.0 && translate_mm[2] == 0.0;
}

PlacedFrame::PlacedFrame(const TargetPlacement& placement)
    : scale_(placement.scale_mm), shift_(placement.translate_mm) {
  for (std::size_t i = 0; i < 3; ++i) turn_[i][i] = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {  // x first, z last
    const double turns = std::remainder(placement.rotate_deg[axis], 360.0) / 90.0;
    const bool right = turns == std::round(turns);
    const double angle = 0.5 * std::numbers::pi * turns;
    const double c = right ? std::round(std::cos(angle)) : std::cos(angle);
    const double s = right ? std::round(std::sin(angle)) : std::sin(angle);
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const double p = turn_[a][k], q = turn_[b][k];
      turn_[a][k] = c * p - s * q;
      turn_[b][k] = s * p + c * q;
    }
  }
}

std::array<double, 3> PlacedFrame::to_corner(const std::array<double, 3>& q) const {
  std::array<double, 3> p = shift_;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) p[i] += scale_ * turn_[i][k] * q[k];
  return p;
}

std::array<double, 3> PlacedFrame::to_surface(const std::array<double, 3>& p) const {
  std::array<double, 3> q{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) q[k] += turn_[i][k] * (p[i] - shift_[i]) / scale_;
  return q;
}

namespace {

/// Whether there is a "=" that is not part of ==, !=, <= or >=: the parser would set a variable.
bool assigns(const std::string& text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] != '=') continue;
    if (k + 1 < text.size() && text[k + 1] == '=') {
      ++k;
    } else if (k == 0 || std::string_view("<>!").find(text[k - 1]) == std::string_view::npos) {
      return true;
    }
  }
  return false;
}

}  // namespace

Result<TargetFormula> read_formula(const std::string& expression, std::optional<double> length) {
  if (assigns(expression))
    return fail(ErrorKind::Malformed, "",
                "the expression sets a variable with \"=\"; remove it, or use == to compare");
  try {
    auto shared = std::make_shared<Expression>(expression, length);
    return [shared](double x, double y, double z) { return (*shared)(x, y, z); };
  } catch (const mu::Parser::exception_type& why) {
    return fail(ErrorKind::Malformed, "", "the expression cannot be read: " + why.GetMsg());
  }
}

std::unique_ptr<TargetSurface> revolution_target(TargetFormula radius,
                                                 const TargetPlacement& placement) {
  if (placement.upright()) return std::make_unique<Revolution>(std::move(radius), placement);
  return solid_target(
      [radius = std::move(radius)](double x, double y, double z) {
        const double r = radius(0.0, y, 0.0);
        return r > 0.0 ? std::hypot(x, z) - r : 1.0;
      },
      placement);
}

std::unique_ptr<TargetSurface> profile_target(TargetFormula z, const TargetPlacement& placement) {
  if (placement.upright() && placement.wall.cosine == 0.0)
    return std::make_unique<Profile>(std::move(z), placement);
  return solid_target(
      [z = std::move(z)](double x, double y, double height) { return height - z(x, y, 0.0); },
      placement);
}

void add_sections(const TargetReach& reach, const SectionPoints& section, TriangleMesh& out) {
  constexpr int kSections = 160, kHalvings = 40;
  struct Station {
    double s_mm{};
    TargetPoints points;
  };
  const auto between = [&](const Station& there, double s_mm) {  // the last place with a section
    Station found = there;
    double in = there.s_mm, outside = s_mm;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (in + outside);
      TargetPoints points = section(middle);
      if (points.empty())
        outside = middle;
      else
        in = middle, found = {middle, std::move(points)};
    }
    return found;
  };
  const auto join = [&](const Station& a, const Station& b) {
    const auto add = [&](const Station& at, std::size_t k) {
      out.corners.insert(out.corners.end(),
                         {static_cast<float>(at.points[k][0]), static_cast<float>(at.s_mm),
                          static_cast<float>(at.points[k][1])});
    };
    for (std::size_t k = 0; k + 1 < a.points.size(); ++k) {
      add(a, k), add(a, k + 1), add(b, k + 1);
      add(a, k), add(b, k + 1), add(b, k);
    }
  };
  Station last{reach.begin_mm, section(reach.begin_mm)};
  for (int k = 1; k <= kSections; ++k) {
    const double s_mm = reach.begin_mm + (reach.end_mm - reach.begin_mm) * k / kSections;
    Station next{s_mm, section(s_mm)};
    if (!last.points.empty() && !next.points.empty())
      join(last, next);
    else if (!last.points.empty())
      join(last, between(last, s_mm));
    else if (!next.points.empty())
      join(between(next, last.s_mm), next);
    last = std::move(next);
  }
}

std::unique_ptr<TargetSurface> stretched_target(std::vector<TargetStretch> stretches) {
  return std::make_unique<Stretched>(std::move(stretches));
}

}  // namespace popcut::verify
