// SPDX-License-Identifier: MIT
#include "core/compare/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace popcut::likeness {
namespace {

/// The value that 95 % of all are not above; 0 of none.
double p95_of(std::vector<float>& values) {
  if (values.empty()) return 0.0;
  const std::size_t at = std::min(values.size() - 1, values.size() * 19 / 20);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return static_cast<double>(values[at]);
}

}  // namespace

Target::Target(Triangles triangles, const Scene& scene)
    : scene_(scene), box_(box_of(triangles)), diagonal_mm_(box_.diagonal()) {
  scene_.pixels = std::clamp(scene_.pixels, kLeastPixels, kMostPixels);
  if (box_.empty() || !(diagonal_mm_ > 0.0) || !std::isfinite(diagonal_mm_)) return;
  seen_.resize(scene_.views.size());
  for (std::size_t k = 0; k < seen_.size(); ++k) {
    Seen& seen = seen_[k];
    if (scene_.corner) draw(frame(k), *scene_.corner, seen.backdrop);
    draw_view(k, triangles, seen.image);
    for (std::size_t p = 0; p < seen.image.depth.size(); ++p)
      seen.pixels += seen.image.depth[p] != kNothing ? 1 : 0;
    find_contours(seen.image, static_cast<float>(kWithin * diagonal_mm_), seen.contours);
    seen.distances.measure(scene_.pixels, seen.contours);
    seen_pixels_ += seen.pixels;
  }
}

Frame Target::frame(std::size_t k) const {
  return {scene_.views[k], box_.centre(), kSide * diagonal_mm_, scene_.pixels};
}

void Target::draw_view(std::size_t k, Triangles structure, DepthImage& image) const {
  draw(frame(k), structure, image);
  hide_behind(seen_[k].backdrop, kTouch * diagonal_mm_, image);
}

ViewFigures Target::measure_view(std::size_t k, Triangles structure, Buffers& buffers,
                                 std::size_t& covered, std::size_t& beyond) const {
  const Seen& seen = seen_[k];
  ViewFigures out;
  out.toward = scene_.views[k].toward;
  out.target_pixels = seen.pixels;
  draw_view(k, structure, buffers.image);
  const float* const target = seen.image.depth.data();
  const float* const own = buffers.image.depth.data();
  const auto within = static_cast<float>(kWithin * diagonal_mm_);
  buffers.of_view.clear();
  double sum = 0.0;
  std::size_t near = 0, alone = 0;
  for (std::size_t p = 0; p < seen.image.depth.size(); ++p) {
    if (own[p] == kNothing) continue;
    if (target[p] == kNothing) {
      ++alone;
      continue;
    }
    const float off = std::abs(target[p] - own[p]);
    buffers.of_view.push_back(off);
    sum += static_cast<double>(off);
    near += off <= within ? 1 : 0;
  }
  covered += near, beyond += alone;
  out.common_pixels = buffers.of_view.size();
  buffers.differences.insert(buffers.differences.end(), buffers.of_view.begin(),
                             buffers.of_view.end());
  if (out.common_pixels > 0) out.mean_mm = sum / static_cast<double>(out.common_pixels);
  out.p95_mm = p95_of(buffers.of_view);
  if (seen.pixels > 0) {
    out.cover = static_cast<double>(near) / static_cast<double>(seen.pixels);
    out.excess = static_cast<double>(alone) / static_cast<double>(seen.pixels);
  }

  find_contours(buffers.image, within, buffers.contours);
  const double pitch = frame(k).pitch_mm(), most = diagonal_mm_ / pitch;
  const bool none = seen.contours.pixels.empty(), none_own = buffers.contours.pixels.empty();
  if (none != none_own) out.contour_mm = diagonal_mm_;
  if (none || none_own) return out;
  buffers.distances.measure(scene_.pixels, buffers.contours);
  const double there = mean_distance(seen.contours, buffers.distances, most);
  const double back = mean_distance(buffers.contours, seen.distances, most);
  out.contour_mm = 0.5 * (there + back) * pitch;
  return out;
}

Figures Target::measure(Triangles structure, Buffers& buffers) const {
  Figures out;
  out.diagonal_mm = diagonal_mm_;
  buffers.differences.clear();
  std::size_t covered = 0, beyond = 0;
  for (std::size_t k = 0; k < seen_.size(); ++k)
    out.views.push_back(measure_view(k, structure, buffers, covered, beyond));
  for (const ViewFigures& view : out.views)
    out.contour_mm += view.contour_mm / static_cast<double>(out.views.size());
  if (seen_pixels_ > 0) {
    out.cover = static_cast<double>(covered) / static_cast<double>(seen_pixels_);
    out.excess = static_cast<double>(beyond) / static_cast<double>(seen_pixels_);
  }
  if (buffers.differences.empty()) {
    out.mean_mm = out.p95_mm = diagonal_mm_;
    return out;
  }
  double sum = 0.0;
  for (const ViewFigures& view : out.views)
    sum += view.mean_mm * static_cast<double>(view.common_pixels);
  out.mean_mm = sum / static_cast<double>(buffers.differences.size());
  out.p95_mm = p95_of(buffers.differences);
  return out;
}

std::vector<float> without_card(Triangles triangles, const Corner& corner, double touch_mm) {
  std::vector<float> out;
  for (std::size_t k = 0; k + 8 < triangles.size(); k += 9) {
    bool on_ground = true, on_wall = true;
    const double sine = std::sin(corner.opening_rad), cosine = std::cos(corner.opening_rad);
    for (std::size_t i = k; i < k + 9; i += 3) {
      const auto x = static_cast<double>(triangles[i]), z = static_cast<double>(triangles[i + 2]);
      on_ground = on_ground && z <= touch_mm;
      on_wall = on_wall && sine * x - cosine * z <= touch_mm;
    }
    if (on_ground || on_wall) continue;
    out.insert(out.end(), triangles.begin() + static_cast<std::ptrdiff_t>(k),
               triangles.begin() + static_cast<std::ptrdiff_t>(k + 9));
  }
  return out;
}

}  // namespace popcut::likeness
