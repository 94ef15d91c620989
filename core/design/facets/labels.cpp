// SPDX-License-Identifier: MIT
#include "core/design/facets/labels.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace popcut {
namespace {

/// Offsets of planes: multiples of `pitch` from `least` to `most`, and the peaks of `weight`.
std::vector<int> offsets(const std::map<int, double>& weight, int least, int most, int pitch) {
  std::vector<int> out;
  for (int at = -((-least) / pitch) * pitch; at <= most; at += pitch) out.push_back(at);
  double whole = 0.0;
  for (const auto& [offset, points] : weight) whole += points;
  const auto of = [&](int offset) {
    const auto found = weight.find(offset);
    return found == weight.end() ? 0.0 : found->second;
  };
  constexpr double kPeak = 0.01;  // of all that face that way
  for (const auto& [offset, points] : weight)
    if (offset >= least && offset <= most && points >= kPeak * whole && points >= of(offset - 1) &&
        points > of(offset + 1))
      out.push_back(offset);
  return out;
}

}  // namespace

FacetPlanes::FacetPlanes(const std::vector<int>& upright, const std::vector<int>& level) {
  planes_ = {{true, 0}, {false, 0}};
  for (const bool is_upright : {true, false}) {
    std::vector<int> sorted = is_upright ? upright : level;
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    for (const int offset : sorted)
      if (offset != 0 && planes_.size() < kMostLabels) planes_.push_back({is_upright, offset});
  }
  int most = 0;
  for (const FacetPlane& p : planes_)
    least_ = std::min(least_, p.offset), most = std::max(most, p.offset);
  for (std::vector<Label>* table : {&upright_, &level_})
    table->assign(static_cast<std::size_t>(most - least_ + 1), kNoLabel);
  for (std::size_t k = 0; k < planes_.size(); ++k)
    (planes_[k].upright ? upright_ : level_)[static_cast<std::size_t>(planes_[k].offset - least_)] =
        static_cast<Label>(k);
}

FacetPlanes every_step(const FacetPlanes& planes) {
  std::vector<int> offsets[2];
  for (const bool upright : {false, true}) {
    int least = 0, most = 0;
    for (std::size_t l = 0; l < planes.size(); ++l) {
      const FacetPlane& plane = planes[static_cast<Label>(l)];
      if (plane.upright != upright) continue;
      least = std::min(least, plane.offset), most = std::max(most, plane.offset);
    }
    for (int at = least; at <= most; ++at) offsets[upright ? 1 : 0].push_back(at);
  }
  if (offsets[0].size() + offsets[1].size() > kMostLabels) return planes;
  return {offsets[1], offsets[0]};
}

std::vector<LabelRun> runs_of(std::span<const Label> strip, const FacetPlanes& planes,
                              const FacetGrid& grid) {
  std::vector<LabelRun> out;
  for (int i = 0; i < static_cast<int>(strip.size()); ++i) {
    const Label label = strip[static_cast<std::size_t>(i)];
    if (!out.empty() && out.back().label == label) {
      out.back().end = i + 1;
      continue;
    }
    const bool folds = !out.empty() && out.back().label != kNoLabel && label != kNoLabel &&
                       planes.partner(out.back().label, grid.across(i)) == label;
    out.push_back({i, i + 1, label, folds});
  }
  return out;
}

FacetPlanes planes_for(const SeenTarget& target, const FacetGrid& grid, int pitch, int most_x,
                       int most_z, bool inward) {
  std::map<int, double> upright, level;
  int least_x = 0, least_z = 0, reach_x = 0, reach_z = 0;
  const auto step_of = [&](double mm) { return static_cast<int>(std::llround(mm / grid.step_mm)); };
  for (std::size_t r = 0; r < target.raster.rows; ++r)
    for (std::size_t c = 0; c < target.raster.columns; ++c) {
      const Facing facing = target.facing[r * target.raster.columns + c];
      if (facing == Facing::Card) continue;
      const int x = step_of(target.x_mm(r, c)), z = step_of(target.z_mm(r, c));
      least_x = std::min(least_x, x), least_z = std::min(least_z, z);
      reach_x = std::max(reach_x, x), reach_z = std::max(reach_z, z);
      if (facing == Facing::Wall) upright[x] += 1.0;
      if (facing == Facing::Ground) level[z] += 1.0;
    }
  if (!inward) least_x = least_z = 0;
  return {offsets(upright, least_x, std::min(most_x, reach_x + pitch), pitch),
          offsets(level, least_z, std::min(most_z, reach_z + pitch), pitch)};
}

}  // namespace popcut
