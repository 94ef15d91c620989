// SPDX-License-Identifier: MIT
#include "core/judge/rectangular_motion.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/rigid/mobility.hpp"

namespace popcut::judge {
namespace {

/// The faces seen along the spine, without their folds; none if one is not rectangular.
std::optional<rigid::Section> faces_of(const Pattern& pattern) {
  rigid::Section out{
      std::vector<std::uint8_t>(pattern.faces()), std::vector<double>(pattern.faces()), {}};
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto corners = pattern.face(f);
    const PatternVertex& first = pattern.vertices[corners.front()];
    const auto all = [&](double PatternVertex::*coordinate) {
      return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
        return pattern.vertices[corner].*coordinate == first.*coordinate;
      });
    };
    const bool upright = all(&PatternVertex::x);
    if (upright == all(&PatternVertex::z)) return std::nullopt;
    out.upright[f] = upright ? 1 : 0;
    out.offset[f] = upright ? first.x : first.z;
  }
  return out;
}

/// Whether a fold is drawn as it turns.
bool turns_as_drawn(const Pattern& pattern, const std::vector<std::uint8_t>& upright,
                    const verify::Hinge& hinge) {
  if (upright[hinge.left] == upright[hinge.right]) return false;
  // Left of the way to larger v, u is smaller.
  const bool along_v = pattern.vertices[hinge.to].v > pattern.vertices[hinge.from].v;
  const bool valley = upright[along_v ? hinge.left : hinge.right] != 0;
  return pattern.edges[hinge.edge].role == (valley ? EdgeRole::Valley : EdgeRole::Mountain);
}

}  // namespace

bool has_rectangular_motion(const Pattern& pattern, const verify::Sheet& sheet,
                            std::optional<int> freedoms) {
  if (!pattern.v_folds.empty() || !pattern.kites.empty() || sheet.panels != pattern.faces())
    return false;
  auto section = faces_of(pattern);
  if (!section || !std::all_of(sheet.hinges.begin(), sheet.hinges.end(), [&](const auto& hinge) {
        return turns_as_drawn(pattern, section->upright, hinge);
      }))
    return false;
  if (!freedoms) return true;
  section->folds = Buckets<std::uint32_t>(pattern.faces(), [&](auto&& put) {
    for (const verify::Hinge& hinge : sheet.hinges) {
      put(hinge.left, hinge.right);
      put(hinge.right, hinge.left);
    }
  });
  return rigid::mobility(*section).degrees_of_freedom == *freedoms;
}

}  // namespace popcut::judge
