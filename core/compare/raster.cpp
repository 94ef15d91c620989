// SPDX-License-Identifier: MIT
#include "core/compare/raster.hpp"

namespace popcut::likeness {

Raster::Raster(const Frame& frame) : pixels_(frame.pixels) {
  const double scale = 1.0 / frame.pitch_mm(), middle = 0.5 * frame.pixels;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    right_[i] = scale * frame.view.right[k];
    up_[i] = scale * frame.view.up[k];
    toward_[i] = frame.view.toward[k];
  }
  right_[3] = middle - scale * dot(frame.view.right, frame.centre);
  up_[3] = middle - scale * dot(frame.view.up, frame.centre);
  toward_[3] = -dot(frame.view.toward, frame.centre);
}

Raster::Corner Raster::seen(const float* p) const {
  const auto x = static_cast<double>(p[0]), v = static_cast<double>(p[1]),
             z = static_cast<double>(p[2]);
  const auto along = [&](const std::array<double, 4>& f) {
    return f[0] * x + f[1] * v + f[2] * z + f[3];
  };
  return {along(right_), along(up_), along(toward_)};
}

// Sutherland and Hodgman, Reentrant Polygon Clipping, 1974.
int Raster::clipped(std::array<Corner, 8>& polygon, double low, double high) {
  int count = 3;
  std::array<Corner, 8> next{};
  for (int border = 0; border < 4; ++border) {
    const auto ahead = [&](const Corner& p) {
      const double at = border < 2 ? p.x : p.y;
      return border % 2 == 0 ? at - low : high - at;
    };
    int made = 0;
    for (int k = 0; k < count; ++k) {
      const Corner &a = polygon[static_cast<std::size_t>(k)],
                   &b = polygon[static_cast<std::size_t>((k + 1) % count)];
      const double p = ahead(a), q = ahead(b);
      if (p >= 0) next[static_cast<std::size_t>(made++)] = a;
      if ((p >= 0) == (q >= 0)) continue;
      const double s = p / (p - q);
      next[static_cast<std::size_t>(made++)] = {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y),
                                                a.t + s * (b.t - a.t)};
    }
    polygon = next, count = made;
    if (count < 3) return 0;
  }
  return count;
}

}  // namespace popcut::likeness
