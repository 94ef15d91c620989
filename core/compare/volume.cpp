// SPDX-License-Identifier: MIT
#include "core/compare/volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "core/compare/raster.hpp"

namespace popcut::likeness {
namespace {

constexpr std::size_t kMostCrossings = 64'000'000;  ///< of rays and triangles: half a gigabyte
constexpr double kLeaks = 1e-3;                     ///< of the rays that meet the mesh

Frame frame_around(const Box& box, const View& view, int pixels) {
  constexpr double kAround = 1.001;
  return {view, box.centre(), kAround * box.diagonal(), pixels};
}

/// Where rays cross a mesh: for each pixel a run of depths.
struct Crossings {
  struct Crossing {
    float depth{};
    std::int32_t side{};  ///< +1 where the outside is seen
  };
  std::vector<std::uint32_t> first;  ///< pixels + 1
  std::vector<Crossing> list;        ///< the nearest last
};

/// @return false: there are too many
bool find(const Frame& frame, Triangles triangles, Crossings& out) {
  const auto width = static_cast<std::size_t>(frame.pixels);
  const Raster raster(frame);
  out.first.assign(width * width + 1, 0);
  std::size_t sum = 0;
  raster.each_span(triangles, [&](std::size_t row, std::size_t first, std::size_t last, float,
                                  float, float, float, int) {
    sum += last - first + 1;
    if (sum > kMostCrossings) return;
    for (std::size_t x = first; x <= last; ++x) ++out.first[row * width + x];
  });
  if (sum > kMostCrossings) return false;
  std::uint32_t before = 0;
  for (std::uint32_t& count : out.first) {
    const std::uint32_t own = count;
    count = before, before += own;
  }
  out.list.resize(sum);
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  raster.each_span(triangles, [&](std::size_t row, std::size_t first, std::size_t last, float at,
                                  float slope, float low, float high, int side) {
    for (std::size_t x = first; x <= last; ++x) {
      const float here = at + slope * static_cast<float>(static_cast<int>(x - first));
      out.list[next[row * width + x]++] = {std::clamp(here, low, high), side};
    }
  });
  for (std::size_t p = 0; p + 1 < out.first.size(); ++p)
    std::sort(out.list.begin() + out.first[p], out.list.begin() + out.first[p + 1],
              [](const auto& a, const auto& b) { return a.depth < b.depth; });
  return true;
}

/// How many rays meet a mesh, and how many of them do not leave it as often as they enter it.
struct Balance {
  std::size_t met{}, odd{}, turned{};  ///< `turned`: by the sides that are seen
  [[nodiscard]] bool is_few(std::size_t leaks) const {
    return static_cast<double>(leaks) <= kLeaks * static_cast<double>(met);
  }
};

Balance balance_of(const Crossings& crossings) {
  Balance out;
  for (std::size_t p = 0; p + 1 < crossings.first.size(); ++p) {
    const std::uint32_t from = crossings.first[p], to = crossings.first[p + 1];
    if (from == to) continue;
    ++out.met;
    std::int32_t turns = 0;
    for (std::uint32_t k = from; k < to; ++k) turns += crossings.list[k].side;
    out.odd += (to - from) % 2;
    out.turned += turns != 0 ? 1 : 0;
  }
  return out;
}

/// The length inside along each ray, in front of the corner; rays that leak are left out.
double length_inside(const Crossings& crossings, const DepthImage& corner, bool by_winding) {
  double sum = 0.0;
  for (std::size_t p = 0; p + 1 < crossings.first.size(); ++p) {
    const std::uint32_t from = crossings.first[p], to = crossings.first[p + 1];
    std::int32_t winding = 0, end = 0;
    for (std::uint32_t k = from; k < to; ++k) end += by_winding ? crossings.list[k].side : 1;
    if (by_winding ? end != 0 : end % 2 != 0) continue;
    for (std::uint32_t k = from; k + 1 < to; ++k) {
      winding += by_winding ? crossings.list[k].side : 1;
      const bool inside = by_winding ? winding != 0 : winding % 2 != 0;
      if (!inside) continue;
      const float a = std::max(crossings.list[k].depth, corner.depth[p]);
      sum += static_cast<double>(std::max(0.0f, crossings.list[k + 1].depth - a));
    }
  }
  return sum;
}

}  // namespace

Volume solid_volume(Triangles triangles, const Corner& corner, int pixels) {
  Volume out;
  const Box box = box_of(triangles);
  if (box.empty() || !(box.diagonal() > 0.0)) {
    out.why = "the model has no size";
    return out;
  }
  const std::vector<View> views = cone_views(corner.opening_rad);
  Crossings crossings;
  bool by_winding = true, by_count = true;
  double leaks = 0.0;
  // The diagonal last: its crossings are used.
  for (const std::size_t k : {std::size_t{2}, std::size_t{5}, std::size_t{0}}) {
    if (!find(frame_around(box, views[k], pixels), triangles, crossings)) {
      out.why = fmt::format("its rays cross the model more than {} million times",
                            kMostCrossings / 1'000'000);
      return out;
    }
    const Balance balance = balance_of(crossings);
    if (balance.met == 0) continue;
    by_winding = by_winding && balance.is_few(balance.turned);
    by_count = by_count && balance.is_few(balance.odd);
    leaks = std::max(leaks, static_cast<double>(balance.odd) / static_cast<double>(balance.met));
  }
  if (!by_winding && !by_count) {
    out.why = fmt::format(
        "the model is not closed: {:.2g} % of all rays enter it and do not leave it; close its "
        "holes",
        100.0 * leaks);
    return out;
  }
  const Frame frame = frame_around(box, views[0], pixels);
  DepthImage behind;
  draw(frame, corner, behind);
  out.by_winding = by_winding;
  out.mm3 = length_inside(crossings, behind, by_winding) * frame.pitch_mm() * frame.pitch_mm();
  out.ran = out.mm3 > 1e-9 * std::pow(box.diagonal(), 3);
  if (!out.ran) out.why = "the model is flat, or does not stand in the corner";
  return out;
}

double volume_before(Triangles surface, const Corner& corner, int pixels) {
  const Box box = box_of(surface);
  if (box.empty() || !(box.diagonal() > 0.0)) return 0.0;
  const Frame frame = frame_around(box, cone_views(corner.opening_rad)[0], pixels);
  DepthImage image, behind;
  draw(frame, surface, image);
  draw(frame, corner, behind);
  double sum = 0.0;
  for (std::size_t p = 0; p < image.depth.size(); ++p)
    if (image.depth[p] > behind.depth[p])
      sum += static_cast<double>(image.depth[p] - behind.depth[p]);
  return sum * frame.pitch_mm() * frame.pitch_mm();
}

}  // namespace popcut::likeness
