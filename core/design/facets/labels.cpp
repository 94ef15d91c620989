// SPDX-License-Identifier: MIT
#include "core/design/facets/labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

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

FacetPlanes::FacetPlanes(const std::vector<int>& upright, const std::vector<int>& level,
                         std::vector<LabelKite> kites, std::vector<FacetPlane> carriers)
    : kites_(std::move(kites)), carriers_(std::move(carriers)) {
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
  first_of_kites_ = static_cast<int>(planes_.size());
  for (int k = 0; k < static_cast<int>(kites_.size()); ++k) {
    const LabelKite& kite = kites_[static_cast<std::size_t>(k)];
    planes_.push_back({true, kite.qx, k});
    planes_.push_back({false, kite.ez, k});
  }
}

bool FacetPlanes::carries_roof(Label label) const {
  const FacetPlane& plane = (*this)[label];
  if (std::find(carriers_.begin(), carriers_.end(), plane) != carriers_.end()) return true;
  return plane.kite < 0 && std::any_of(kites_.begin(), kites_.end(), [&](const LabelKite& kite) {
           return plane.offset == (plane.upright ? kite.ex : kite.qz);
         });
}

bool FacetPlanes::is_at_kite(const FacetPlane& panel, int across) const {
  const LabelKite& kite = kites_[static_cast<std::size_t>(panel.kite)];
  const int fold = kite.qx - kite.ez;
  return panel.upright ? across >= kite.qx - kite.qz && across < fold
                       : across >= fold && across < kite.ex - kite.ez;
}

bool FacetPlanes::meet_at_kite(Label before, Label after, int across) const {
  const FacetPlane &a = (*this)[before], &b = (*this)[after];
  const LabelKite& kite = kites_[static_cast<std::size_t>(std::max(a.kite, b.kite))];
  if (a.kite < 0)
    return b.upright && before == find({false, kite.qz}) && across == kite.qx - kite.qz;
  if (b.kite < 0)
    return !a.upright && after == find({true, kite.ex}) && across == kite.ex - kite.ez;
  return a.kite == b.kite && a.upright && !b.upright && across == kite.qx - kite.ez;
}

FacetPlanes every_step(const FacetPlanes& planes) {
  std::array<std::vector<int>, 2> offsets;
  for (const bool upright : {false, true}) {
    int least = 0, most = 0;
    for (std::size_t l = 0; l < planes.size(); ++l) {
      const FacetPlane& plane = planes[static_cast<Label>(l)];
      if (plane.upright != upright || plane.kite >= 0) continue;
      least = std::min(least, plane.offset), most = std::max(most, plane.offset);
    }
    for (int at = least; at <= most; ++at) offsets[upright ? 1 : 0].push_back(at);
  }
  if (offsets[0].size() + offsets[1].size() > kMostLabels) return planes;
  return {offsets[1], offsets[0], planes.kites(), planes.carriers()};
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
                       planes.meet(out.back().label, label, grid.across(i));
    out.push_back({i, i + 1, label, folds});
  }
  return out;
}

FacetPlanes planes_for(const SeenTarget& target, const FacetGrid& grid, int pitch, int most_x,
                       int most_z, bool inward, const std::vector<LabelKite>& kites,
                       const std::vector<FacetPlane>& carriers) {
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
  std::vector<int> x = offsets(upright, least_x, std::min(most_x, reach_x + pitch), pitch),
                   z = offsets(level, least_z, std::min(most_z, reach_z + pitch), pitch);
  for (const LabelKite& kite : kites) x.push_back(kite.ex), z.push_back(kite.qz);
  for (const FacetPlane& plane : carriers) (plane.upright ? x : z).push_back(plane.offset);
  return {x, z, kites, carriers};
}

}  // namespace popcut
