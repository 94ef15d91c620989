// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/geometry/buckets.hpp"
#include "core/verify/target/target_surface.hpp"

namespace popcut::verify {
namespace {

/// A straight piece of a section, (x, z) in mm.
struct Piece {
  std::array<double, 2> a{}, b{};
};

double distance(const Piece& piece, double x, double z) {
  const double ux = piece.b[0] - piece.a[0], uz = piece.b[1] - piece.a[1];
  const double vx = x - piece.a[0], vz = z - piece.a[1];
  const double square = ux * ux + uz * uz;
  const double t = square > 0.0 ? std::clamp((ux * vx + uz * vz) / square, 0.0, 1.0) : 0.0;
  return std::hypot(vx - t * ux, vz - t * uz);
}

/// The pieces of one section, in columns of equal width by their x.
class SectionIndex {
 public:
  SectionIndex() = default;
  explicit SectionIndex(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
    if (pieces_.empty()) return;
    low_ = std::numeric_limits<double>::infinity();
    double high = -low_, sum = 0.0;
    for (const Piece& p : pieces_) {
      low_ = std::min({low_, p.a[0], p.b[0]});
      high = std::max({high, p.a[0], p.b[0]});
      sum += std::abs(p.b[0] - p.a[0]);
    }
    // Columns are as wide as the mean piece, so a piece is in at most three columns on average.
    const auto count = static_cast<double>(pieces_.size());
    width_ = std::max({sum / count, (high - low_) / count, 1e-12});
    count_ = 1 + static_cast<std::size_t>((high - low_) / width_);
    columns_ = Buckets<std::uint32_t>(count_, [&](auto&& put) {
      for (std::uint32_t k = 0; k < pieces_.size(); ++k) {
        const auto [from, to] = std::minmax(pieces_[k].a[0], pieces_[k].b[0]);
        for (std::size_t c = column(from); c <= column(to); ++c) put(c, k);
      }
    });
  }

  /// Distance of the nearest piece; negative without pieces.
  [[nodiscard]] double nearest(double x, double z) const {
    if (pieces_.empty()) return -1.0;
    const std::size_t at = column(x);
    double best = std::numeric_limits<double>::infinity();
    const auto look = [&](std::size_t c) {
      for (const std::uint32_t k : columns_[c]) best = std::min(best, distance(pieces_[k], x, z));
    };
    look(at);
    for (std::size_t c = at; c-- > 0 && x - edge(c + 1) < best;) look(c);
    for (std::size_t c = at + 1; c < count_ && edge(c) - x < best; ++c) look(c);
    return best;
  }

  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  [[nodiscard]] double edge(std::size_t c) const { return low_ + width_ * static_cast<double>(c); }
  [[nodiscard]] std::size_t column(double x) const {
    const double offset = (x - low_) / width_;
    return offset <= 0.0 ? 0 : std::min(count_ - 1, static_cast<std::size_t>(offset));
  }

  std::vector<Piece> pieces_;
  double low_{}, width_{1.0};
  std::size_t count_{};
  Buckets<std::uint32_t> columns_;
};

/// Keeps the part of a piece inside the corner; false if there is none or it lies on wall or
/// ground.
bool clip(const TargetWall& wall, Piece& piece, double touch_mm) {
  for (const bool at_wall : {true, false}) {
    const auto ahead = [&](const std::array<double, 2>& at) {
      return at_wall ? wall.ahead(at[0], at[1]) : at[1];
    };
    const double p = ahead(piece.a), q = ahead(piece.b);
    if (p <= touch_mm && q <= touch_mm) return false;
    if (p >= 0.0 && q >= 0.0) continue;
    const double t = p / (p - q);
    auto& outside = p < 0.0 ? piece.a : piece.b;
    const double z = at_wall ? piece.a[1] + t * (piece.b[1] - piece.a[1]) : 0.0;
    outside = {at_wall ? z * wall.cosine / wall.sine : piece.a[0] + t * (piece.b[0] - piece.a[0]),
               z};
  }
  return true;
}

class Mesh : public TargetSurface {
 public:
  Mesh(TriangleMesh triangles, const TargetPlacement& placement)
      : triangles_(std::move(triangles)), frame_(placement), wall_(placement.wall) {
    const std::size_t count = triangles_.size();
    low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
    double sum = 0.0;
    for (std::size_t t = 0; t < count; ++t) {
      const auto [from, to] = extent(t);
      low_ = std::min(low_, from), high_ = std::max(high_, to), sum += to - from;
    }
    const auto n = static_cast<double>(count);
    slab_ = std::max({sum / n, (high_ - low_) / n, 1e-12});
    slab_count_ = 1 + static_cast<std::size_t>((high_ - low_) / slab_);
    slabs_ = Buckets<std::uint32_t>(slab_count_, [&](auto&& put) {
      for (std::uint32_t t = 0; t < count; ++t) {
        const auto [from, to] = extent(t);
        for (std::size_t c = slab(from); c <= slab(to); ++c) put(c, t);
      }
    });
  }

  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    return section(s_mm).nearest(x_mm, z_mm);
  }

  [[nodiscard]] CurveEnds ends_mm(double s_mm) const override {
    CurveEnds ends{-1.0, -1.0};
    const double touch = 1e-6 * (high_ - low_);
    for (const Piece& piece : section(s_mm).pieces()) {
      for (const auto& p : {piece.a, piece.b}) {
        if (wall_.ahead(p[0], p[1]) <= touch) ends.wall = std::max(ends.wall, p[1] / wall_.sine);
        if (p[1] <= touch) ends.ground = std::max(ends.ground, p[0]);
      }
    }
    return ends;
  }

  void add_triangles(const TargetReach&, TriangleMesh& out) const override {
    out.corners.reserve(out.corners.size() + triangles_.corners.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        for (const double value : corner(t, k)) out.corners.push_back(static_cast<float>(value));
  }

 private:
  [[nodiscard]] std::array<double, 3> corner(std::size_t triangle, std::size_t k) const {
    const float* const p = triangles_.corners.data() + 9 * triangle + 3 * k;
    return frame_.to_corner(
        {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
  }
  [[nodiscard]] std::array<double, 2> extent(std::size_t triangle) const {
    const double a = corner(triangle, 0)[1], b = corner(triangle, 1)[1], c = corner(triangle, 2)[1];
    return {std::min({a, b, c}), std::max({a, b, c})};
  }
  [[nodiscard]] std::size_t slab(double s) const {
    const double offset = (s - low_) / slab_;
    return offset <= 0.0 ? 0 : std::min(slab_count_ - 1, static_cast<std::size_t>(offset));
  }

  /// The section at `s_mm`, cached until another one is needed. The surface's own first and last
  /// plane are cut a billionth of its length inside.
  [[nodiscard]] const SectionIndex& section(double s_mm) const {
    if (s_mm == last_s_) return last_;
    last_s_ = s_mm;
    const double length = high_ - low_, touch = 1e-6 * length;
    std::vector<Piece> pieces;
    if (s_mm >= low_ - touch && s_mm <= high_ + touch) {
      const double s = std::clamp(s_mm, low_ + 1e-9 * length, high_ - 1e-9 * length);
      for (const std::uint32_t triangle : slabs_[slab(s)]) {
        Piece piece;
        if (cut(triangle, s, piece) && clip(wall_, piece, 1e-9 * length)) pieces.push_back(piece);
      }
    }
    last_ = SectionIndex(std::move(pieces));
    return last_;
  }

  [[nodiscard]] bool cut(std::size_t triangle, double s, Piece& piece) const {
    const std::array<std::array<double, 3>, 3> p{corner(triangle, 0), corner(triangle, 1),
                                                 corner(triangle, 2)};
    std::size_t found = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &from = p[k], &to = p[(k + 1) % 3];
      if ((from[1] < s) == (to[1] < s)) continue;
      const double t = (s - from[1]) / (to[1] - from[1]);
      auto& end = found++ == 0 ? piece.a : piece.b;
      end = {from[0] + t * (to[0] - from[0]), from[2] + t * (to[2] - from[2])};
    }
    return found == 2;
  }

  TriangleMesh triangles_;
  PlacedFrame frame_;
  TargetWall wall_;
  double low_{}, high_{}, slab_{1.0};
  std::size_t slab_count_{};
  Buckets<std::uint32_t> slabs_;
  mutable double last_s_{std::numeric_limits<double>::quiet_NaN()};
  mutable SectionIndex last_;
};

}  // namespace

std::unique_ptr<TargetSurface> mesh_target(TriangleMesh triangles,
                                           const TargetPlacement& placement) {
  return std::make_unique<Mesh>(std::move(triangles), placement);
}

}  // namespace popcut::verify
