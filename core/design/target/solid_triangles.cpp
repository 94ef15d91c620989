// SPDX-License-Identifier: MIT
#include "core/design/target/solid_triangles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <boost/math/tools/minima.hpp>

namespace popcut {
namespace {

using Value = std::function<double(const Vec3&)>;

/// One slab of the grid after another, from `from_mm` to `to_mm` along the spine.
class TetrahedraMarch {
 public:
  TetrahedraMarch(const Value& value, const TargetStretch& stretch)
      : value_(value), reach_{stretch.reach_x_mm, stretch.reach_z_mm}, stretch_(stretch) {}

  TriangleSoup run() {
    if (!(stretch_.to_mm > stretch_.from_mm) || !(reach_[0] > 0.0) || !(reach_[1] > 0.0)) return {};
    widen();
    choose_cells();
    fill(0, low_);
    for (std::size_t j = 0; j < cells_[1]; ++j) {
      fill(j + 1, high_);
      std::fill(known_.begin(), known_.end(), std::uint8_t{0});
      for (std::size_t k = 0; k < cells_[2]; ++k)
        for (std::size_t i = 0; i < cells_[0]; ++i) add_cell(i, j, k);
      low_.swap(high_);
    }
    return std::move(out_);
  }

 private:
  static constexpr std::size_t kProbes = 24;  ///< along each side of a face of the box

  /// The solid leaves no face of the box that it could go on behind.
  void widen() {
    for (double& reach : reach_) reach *= 1.05;
    for (int round = 0; round < 40; ++round) {
      const bool leaves_x = leaves(true), leaves_z = leaves(false);
      if (!leaves_x && !leaves_z) return;
      if (leaves_x) reach_[0] *= 1.1;
      if (leaves_z) reach_[1] *= 1.1;
    }
  }

  [[nodiscard]] bool leaves(bool at_x) const {
    for (std::size_t j = 0; j <= kProbes; ++j)
      for (std::size_t k = 0; k <= kProbes; ++k) {
        const double v = stretch_.from_mm +
                         (stretch_.to_mm - stretch_.from_mm) * static_cast<double>(j) / kProbes;
        const double along = reach_[at_x ? 1 : 0] * static_cast<double>(k) / kProbes;
        if (value_(at_x ? Vec3(reach_[0], v, along) : Vec3(along, v, reach_[1])) < 0.0) return true;
      }
    return false;
  }

  void choose_cells() {
    constexpr double kLeast = 64.0, kMost = 128.0, kThin = 8.0;
    const std::array sides{reach_[0], stretch_.to_mm - stretch_.from_mm, reach_[1]};
    const double longest = std::max({sides[0], sides[1], sides[2]});
    const double round = std::max(reach_[0], reach_[1]);  // as if that were its radius
    const double wanted = longest / std::sqrt(8.0 * stretch_.finest_mm * round);
    const double count = std::clamp(std::ceil(wanted), kLeast, kMost);
    for (std::size_t i = 0; i < 3; ++i) {
      cells_[i] = static_cast<std::size_t>(std::max(kThin, std::ceil(count * sides[i] / longest)));
      step_[i] = sides[i] / static_cast<double>(cells_[i]);
    }
    row_ = cells_[0] + 1;
    const std::size_t plane = row_ * (cells_[2] + 1);
    low_.resize(plane), high_.resize(plane);
    crossing_.resize(2 * plane * kWays), known_.resize(crossing_.size());
  }

  [[nodiscard]] Vec3 point(std::size_t i, std::size_t j, std::size_t k) const {
    return {step_[0] * static_cast<double>(i), stretch_.from_mm + step_[1] * static_cast<double>(j),
            step_[2] * static_cast<double>(k)};
  }

  void fill(std::size_t j, std::vector<double>& plane) const {
    for (std::size_t k = 0; k <= cells_[2]; ++k)
      for (std::size_t i = 0; i < row_; ++i) plane[k * row_ + i] = value_(point(i, j, k));
  }

  /// A corner of the cell by its bits: 1 along x, 2 along v, 4 along z.
  [[nodiscard]] double corner(std::size_t i, std::size_t k, unsigned bits) const {
    const std::size_t at = (k + (bits >> 2)) * row_ + i + (bits & 1u);
    return (bits & 2u) != 0 ? high_[at] : low_[at];
  }

  void add_cell(std::size_t i, std::size_t j, std::size_t k) {
    unsigned inside = 0;
    for (unsigned bits = 0; bits < 8; ++bits)
      if (corner(i, k, bits) < 0.0) inside |= 1u << bits;
    if (inside == 0 || inside == 255) return;
    // Kuhn's six tetrahedra: the ways from corner 0 to corner 7 along the edges.
    constexpr std::array<std::array<unsigned, 4>, 6> kTetrahedra{
        {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};
    for (const auto& tetrahedron : kTetrahedra) {
      std::array<unsigned, 4> in{}, out{};
      std::size_t ins = 0, outs = 0;
      for (const unsigned c : tetrahedron)
        ((inside >> c) & 1u) != 0 ? in[ins++] = c : out[outs++] = c;
      const auto at = [&](unsigned a, unsigned b) { return crossing(i, j, k, a, b); };
      const Vec3 outward = point(out[0] & 1u, (out[0] >> 1) & 1u, out[0] >> 2) -
                           point(in[0] & 1u, (in[0] >> 1) & 1u, in[0] >> 2);
      const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 ab = b - a, ac = c - a;
        dot(cross(ab, ac), outward) < 0.0 ? out_.add(a, c, b) : out_.add(a, b, c);
      };
      if (ins == 1) add(at(in[0], out[0]), at(in[0], out[1]), at(in[0], out[2]));
      if (ins == 3) add(at(in[0], out[0]), at(in[1], out[0]), at(in[2], out[0]));
      if (ins == 2) {
        add(at(in[0], out[0]), at(in[0], out[1]), at(in[1], out[1]));
        add(at(in[0], out[0]), at(in[1], out[1]), at(in[1], out[0]));
      }
    }
  }

  /// Where the boundary crosses between an inner and an outer corner, found once in a slab:
  /// halving, then a secant.
  const Vec3& crossing(std::size_t i, std::size_t j, std::size_t k, unsigned inner,
                       unsigned outer) {
    const unsigned from = inner & outer, way = inner ^ outer;  // one is the other and more
    const std::size_t at =
        (((from & 2u) != 0 ? cells_[2] + 1 : 0) + k + (from >> 2)) * row_ + i + (from & 1u);
    const std::size_t edge = at * kWays + way;
    if (known_[edge] != 0) return crossing_[edge];
    known_[edge] = 1;
    const auto place = [&](unsigned bits) {
      return point(i + (bits & 1u), j + ((bits >> 1) & 1u), k + (bits >> 2));
    };
    Vec3 in = place(inner), out = place(outer);
    double value_in = corner(i, k, inner), value_out = corner(i, k, outer);
    for (int n = 0; n < kHalvings; ++n) {
      const Vec3 middle = 0.5 * (in + out);
      const double here = value_(middle);
      if (here < 0.0)
        in = middle, value_in = here;
      else
        out = middle, value_out = here;
    }
    double share = value_in / (value_in - value_out);
    if (!(share >= 0.0 && share <= 1.0)) share = 0.5;  // not a number outside
    return crossing_[edge] = in + share * (out - in);
  }

  static constexpr std::size_t kWays = 8;  ///< an edge's direction by its bits
  static constexpr int kHalvings = 6;
  const Value& value_;
  std::array<double, 2> reach_;
  const TargetStretch& stretch_;
  std::array<std::size_t, 3> cells_{};
  std::array<double, 3> step_{};
  std::size_t row_{};
  std::vector<double> low_, high_;
  std::vector<Vec3> crossing_;
  std::vector<std::uint8_t> known_;
  TriangleSoup out_;
};

}  // namespace

TriangleSoup solid_triangles(const Value& value, const TargetStretch& stretch) {
  return TetrahedraMarch(value, stretch).run();
}

bool dips_below_zero(const std::function<double(double)>& value, double reach, int samples) {
  const double step = reach / samples;
  std::vector<double> at(static_cast<std::size_t>(samples) + 1);
  for (std::size_t k = 0; k < at.size(); ++k)
    if ((at[k] = value(step * static_cast<double>(k))) < 0.0) return true;
  constexpr int kBits = 26;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, at.size() - 1);
    if (!std::isfinite(at[k]) || at[k] > at[before] || at[k] > at[after]) continue;
    std::uintmax_t most = 60;
    const auto least = boost::math::tools::brent_find_minima(
        value, step * static_cast<double>(before), step * static_cast<double>(after), kBits, most);
    if (least.second < 0.0) return true;
  }
  return false;
}

}  // namespace popcut
