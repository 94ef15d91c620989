// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/design/facets/labels.hpp"
#include "core/design/facets/seen_target.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/kite.hpp"
#include "core/geometry/tent_section.hpp"

namespace popcut {

/// A sloped plane of a target that is parallel to the spine and falls away from the wall, seen
/// along the spine.
struct RoofPlane {
  double slope_rad{};
  KitePoint top, eave;
  double area_mm2{};

  [[nodiscard]] double length_mm() const;
};

/// The largest sloped planes of a target, the largest first. O(triangles log triangles).
[[nodiscard]] std::vector<RoofPlane> roofs_of(const TriangleSoup& target, std::size_t most);

/// What kites must obey, in steps.
struct KiteLimits {
  int least_run{1};  ///< of the two panels, and of those that they hang on
  int most_x{std::numeric_limits<int>::max()}, most_z{std::numeric_limits<int>::max()};
  int most_reach{std::numeric_limits<int>::max()};  ///< x + z, shut
  double dormer_mm{};  ///< what holds a kite is this wide, where the roof leaves room for it
};

/// Why a roof is no kite.
struct RefusedRoof {
  RoofPlane roof;
  bool is_too_long{};  ///< it would cross the wall or the ground; false: it does not fit the card
  std::string no_tent{};  ///< why it is no glued tent; empty: none was asked for
  /// What it says of it: which bound it breaks, and the nearest that works.
  [[nodiscard]] std::string reason() const;
};

/// A kite in a stretch of strips. The first strips go on without it, from its level plane to its
/// upright one: they hold both.
struct KiteRun {
  std::size_t kite{};
  int first{}, end{};
  int dormer{};  ///< how many strips these are

  [[nodiscard]] bool is_dormer(int strip) const { return strip < first + dormer; }
};

/// The kites of a card.
struct KitePlan {
  std::vector<LabelKite> kites;
  std::vector<KiteRun> runs;  ///< no two share a strip
  std::vector<RefusedRoof> refused;
  bool any_roof{};  ///< there is a sloped plane, and it is seen
};

/// A roof that is glued on a stretch of strips. Each has wall, a level panel, an upright panel and
/// ground, and nothing else; the roof's eave is the fold between both panels.
struct TentRun {
  FacetPlane level, front;
  int first{}, end{};
  TentSection section;
};

/// The glued roofs of a card.
struct TentPlan {
  std::vector<TentRun> runs;  ///< no two share a strip
  std::vector<RefusedRoof> refused;
};

/// Lays a tent over each roof that is seen: on the walls that come nearest to the shape, so that
/// eaves beyond them are left out. A tent is given only if the roof never passes through the wall,
/// and its ridge moves by no more than `most_play_mm` in paper.
[[nodiscard]] TentPlan plan_tents(const TriangleSoup& target, const SeenTarget& seen,
                                  const FacetGrid& grid, const KiteLimits& limits,
                                  double most_play_mm);

/// The labels of each strip of a run.
[[nodiscard]] std::vector<Label> tent_labels(const FacetPlanes& planes, const FacetGrid& grid,
                                             const TentRun& run);

/// Lays a kite over each roof that is seen. Of the types whose bound holds, it takes the one nearer
/// to the shape. A strip with a kite has wall, level plane, kite, upright plane and ground, and
/// nothing else. So its bound (`KiteSection::clearance_mm`) is all that it must keep.
[[nodiscard]] KitePlan plan_kites(const TriangleSoup& target, const SeenTarget& seen,
                                  const FacetGrid& grid, const KiteLimits& limits);

/// The labels of a strip of a run.
[[nodiscard]] std::vector<Label> kite_labels(const FacetPlanes& planes, const FacetGrid& grid,
                                             const KiteRun& run, int strip);

}  // namespace popcut
