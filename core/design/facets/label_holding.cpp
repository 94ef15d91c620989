// SPDX-License-Identifier: MIT
#include "core/design/facets/label_holding.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/rigid/mobility.hpp"

namespace popcut {
namespace {

/// How far apart the folds of each patch must lie, in steps: never farther than it is long.
std::vector<double> least_apart(const LabelPatches& p, const FacetGrid& grid,
                                const HoldRule& rule) {
  constexpr double kMostOfLength = 0.9;
  struct Columns {
    int begin{std::numeric_limits<int>::max()}, end{std::numeric_limits<int>::min()};
  };
  std::vector<Columns> columns(p.count);
  for (std::size_t r = 0; r < p.runs.size(); ++r) {
    Columns& c = columns[p.patch[r]];
    c = {std::min(c.begin, p.runs[r].begin), std::max(c.end, p.runs[r].end)};
  }
  std::vector<double> out;
  for (const Columns& c : columns) {
    const double length = c.end - c.begin;
    out.push_back(std::min(kMostOfLength * length,
                           std::max(rule.apart_mm / grid.step_mm, rule.apart_share * length)));
  }
  return out;
}

/// The numbers of two patches, the smaller one first.
using Meeting = std::pair<std::uint32_t, std::uint32_t>;

/// The pairs of patches that meet in folds, in order, each once.
/// @param holds  says of a pair that meets in so many strips whether that holds
template <typename Holds>
std::vector<Meeting> folds_of(const LabelPatches& p, const Holds& holds) {
  const Buckets<std::uint32_t> by_greater(p.count, [&](auto&& put) {
    for (std::size_t r = 1; r < p.runs.size(); ++r)
      if (p.runs[r].folds_on) {
        const auto [a, b] = std::minmax(p.patch[r - 1], p.patch[r]);
        put(b, a);
      }
  });
  const Buckets<std::uint32_t> by_less(p.count, [&](auto&& put) {
    for (std::uint32_t b = 0; b < p.count; ++b)
      for (const std::uint32_t a : by_greater[b]) put(a, b);
  });
  std::vector<Meeting> out;
  for (std::uint32_t a = 0; a < p.count; ++a) {
    const auto strips = by_less[a];
    for (std::size_t first = 0, last = 0; first < strips.size(); first = last) {
      while (last < strips.size() && strips[last] == strips[first]) ++last;
      if (const Meeting pair(a, strips[first]); holds(pair, last - first)) out.push_back(pair);
    }
  }
  return out;
}

/// The patches seen along the spine; neighbours by growing number, each once.
rigid::Section section_of(const LabelPatches& p, const FacetPlanes& planes, const FacetGrid& grid,
                          const HoldRule& rule) {
  rigid::Section out{std::vector<std::uint8_t>(p.count), std::vector<double>(p.count), {}};
  if (rule.apart_mm > 0.0) out.apart = least_apart(p, grid, rule);
  for (std::size_t r = 0; r < p.runs.size(); ++r) {
    const FacetPlane& plane = planes[p.runs[r].label];
    out.upright[p.patch[r]] = plane.upright ? 1 : 0;
    out.offset[p.patch[r]] = plane.offset;
  }
  const auto spine = std::minmax(p.patch[0], p.patch[1]);
  const std::vector<Meeting> folds = folds_of(p, [&](const Meeting& pair, std::size_t strips) {
    // The spine goes on in the margins.
    return pair == Meeting(spine) ||
           is_joint(static_cast<double>(strips) * grid.strip_mm, rule.min_fold_mm);
  });
  out.folds = Buckets<std::uint32_t>(p.count, [&](auto&& put) {
    for (const auto& [a, b] : folds) {
      put(a, b);
      put(b, a);
    }
  });
  return out;
}

}  // namespace

LabelHolding holding_of(const LabelImage& image, const FacetPlanes& planes, const HoldRule& rule) {
  return holding_of(strip_runs(image, planes), planes, image.grid, rule);
}

LabelHolding holding_of(const StripRuns& runs, const FacetPlanes& planes, const FacetGrid& grid,
                        const HoldRule& rule) {
  LabelHolding out;
  out.patches = patches_of(runs, grid, rule.min_panel_mm);
  const rigid::Section section = section_of(out.patches, planes, grid, rule);
  out.loose.assign(section.panels(), 0);
  for (const std::size_t first : {0U, 1U}) {  // the wall and the ground of the margin
    rigid::Propagation propagation(section);
    propagation.hold(out.patches.patch[first]);
    for (std::size_t k = 0; k < section.panels(); ++k)
      if (!propagation.is_held(k)) out.loose[k] = 1, ++out.open;
    if (out.open == 0) continue;
    for (std::uint32_t k = 0; k < section.panels(); ++k)
      if (section.upright[k] == (first == 0 ? 1 : 0)) out.pins += propagation.pin(k);
    for (std::uint32_t k = 0; k < section.panels(); ++k) out.pins += propagation.is_held(k) ? 0 : 1;
  }
  return out;
}

}  // namespace popcut
