// SPDX-License-Identifier: MIT
#include "daemon/planning/views/book_animation.hpp"

#include <vector>

#include "core/deploy/glb.hpp"
#include "core/deploy/pose_table.hpp"

namespace popcut::planning {

Result<std::string> book_animation_glb(std::span<const Pattern* const> cards,
                                       const std::string& name, double thickness_mm) {
  constexpr int kKeys = 25;  // the last cards turn by almost a whole turn
  const auto angles = opening_angles(0.0, cards.front()->design_psi_rad, kKeys);
  if (!angles) return tl::unexpected(angles.error());
  std::vector<PoseTable> tables;
  tables.reserve(cards.size());
  std::vector<GlbCard> scene;
  for (const Pattern* card : cards) {
    auto table = pose_table(*card, *angles);
    if (!table) return tl::unexpected(table.error());
    tables.push_back(std::move(*table));
    scene.push_back({card, &tables.back()});
  }
  return book_glb(scene, name, {.creator = "popcut " POPCUT_VERSION, .thickness_mm = thickness_mm});
}

}  // namespace popcut::planning
