// SPDX-License-Identifier: MIT
#include "core/verify/target_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <muParser.h>

namespace popcut::verify {
namespace {

/// An expression of x and y.
class Expression {
 public:
  explicit Expression(const std::string& text) {
    parser_.DefineVar("x", &x_);
    parser_.DefineVar("y", &y_);
    parser_.DefineConst("pi", std::numbers::pi);
    parser_.SetExpr(text);
    (void)parser_.Eval();  // throws on what it cannot read
  }
  Expression(const Expression&) = delete;
  Expression& operator=(const Expression&) = delete;

  [[nodiscard]] double operator()(double x, double y) const {
    x_ = x;
    y_ = y;
    return parser_.Eval();
  }

 private:
  mutable double x_{0.25}, y_{0.25};
  mu::Parser parser_;
};

/// Quarter circles about the spine.
class Revolution : public TargetSurface {
 public:
  Revolution(const std::string& radius, double scale_mm) : radius_(radius), scale_(scale_mm) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const double r_mm = scale_ * radius_(0.0, s_mm / scale_);
    return r_mm > 0.0 ? std::abs(std::hypot(x_mm, z_mm) - r_mm) : -1.0;
  }
  [[nodiscard]] CurveEnds ends_mm(double s_mm) const override {
    const double r_mm = scale_ * radius_(0.0, s_mm / scale_);
    return {r_mm, r_mm};
  }

 private:
  Expression radius_;
  double scale_;
};

/// A profile z(x, y), for x from 0 to where it comes down to 0.
class Profile : public TargetSurface {
 public:
  Profile(const std::string& z, double scale_mm) : z_(z), scale_(scale_mm) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const double y = s_mm / scale_;
    const auto away = [&](double x) {
      return std::hypot(x - x_mm / scale_, z_(x, y) - z_mm / scale_);
    };
    const double end = ground_end(y);
    if (!(end > 0.0)) return -1.0;
    // Sampled, then narrowed about the nearest sample. Near the ground the curve can be steep, so
    // samples thicken towards both ends.
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
    const double y = s_mm / scale_;
    return {scale_ * z_(0.0, y), scale_ * ground_end(y)};
  }

 private:
  /// Smallest x > 0 at which the profile is down at 0; negative if it never is.
  [[nodiscard]] double ground_end(double y) const {
    const double height = z_(0.0, y);
    if (!(height > 0.0)) return -1.0;
    double step = height / 256.0;
    double above = 0.0;
    double below = step;
    for (int k = 0; k < 8192 && z_(below, y) > 0.0; ++k) {
      above = below;
      below += step;
      if (k % 1024 == 1023) step *= 2.0;
    }
    if (z_(below, y) > 0.0) return -1.0;
    for (int k = 0; k < 80; ++k) {
      const double middle = 0.5 * (above + below);
      (z_(middle, y) > 0.0 ? above : below) = middle;
    }
    return above;
  }

  Expression z_;
  double scale_;
};

}  // namespace

Result<std::unique_ptr<TargetSurface>> make_surface(TargetKind kind, const std::string& expression,
                                                    double scale_mm) {
  try {
    if (kind == TargetKind::Revolution) return std::make_unique<Revolution>(expression, scale_mm);
    return std::make_unique<Profile>(expression, scale_mm);
  } catch (const mu::Parser::exception_type& why) {
    return fail(ErrorKind::Malformed, "", "the expression cannot be read: " + why.GetMsg());
  }
}

}  // namespace popcut::verify
