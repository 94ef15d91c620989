// SPDX-License-Identifier: MIT
#include "core/design/facets/label_holding.hpp"

#include <algorithm>
#include <limits>

#include "core/geometry/buckets.hpp"

namespace popcut {
namespace {

/// One of the two systems: patches of one direction are lines, the others are nodes. A fold lies
/// along a line at the offset of the node's plane.
class Propagation {
 public:
  Propagation(const Buckets<std::uint32_t>& folds, const std::vector<int>& offset)
      : folds_(folds), offset_(offset), held_(offset.size(), 0), one_(offset.size(), kNone) {}

  /// Holds what follows from `first`, a line.
  void run(std::uint32_t first) {
    work_.push_back(first);
    while (!work_.empty()) {
      const std::uint32_t line = work_.back();
      work_.pop_back();
      if (held_[line] != 0) continue;
      held_[line] = 1;
      for (const std::uint32_t node : folds_[line]) {
        if (held_[node] != 0) continue;
        held_[node] = 1;
        for (const std::uint32_t other : folds_[node]) reach(other, offset_[node]);
      }
    }
  }
  [[nodiscard]] bool is_held(std::size_t k) const { return held_[k] != 0; }

  /// Holds a line that nothing holds, by as many pins as it takes, with what follows: first the
  /// lines of which one place is held, since they take one.
  int pin(std::uint32_t line) {
    int pins = 0;
    while (!near_.empty()) {
      const std::uint32_t next = near_.back();
      near_.pop_back();
      if (held_[next] != 0) continue;
      ++pins;
      run(next);
    }
    if (held_[line] != 0) return pins;
    run(line);
    return pins + 2;
  }

 private:
  static constexpr int kNone = std::numeric_limits<int>::min();

  /// A node of a line is held, whose plane meets it at `place`: two at different places hold it.
  void reach(std::uint32_t line, int place) {
    if (held_[line] != 0) return;
    if (one_[line] == kNone)
      one_[line] = place, near_.push_back(line);
    else if (one_[line] != place)
      work_.push_back(line);
  }

  const Buckets<std::uint32_t>& folds_;
  const std::vector<int>& offset_;
  std::vector<std::uint8_t> held_;
  std::vector<int> one_;  ///< place of the first held node of a line
  std::vector<std::uint32_t> work_, near_;
};

}  // namespace

LabelHolding holding_of(const LabelImage& image, const FacetPlanes& planes, double min_panel_mm) {
  return holding_of(strip_runs(image, planes), planes, image.grid, min_panel_mm);
}

LabelHolding holding_of(const StripRuns& runs, const FacetPlanes& planes, const FacetGrid& grid,
                        double min_panel_mm) {
  LabelHolding out;
  out.patches = patches_of(runs, grid, min_panel_mm);
  const LabelPatches& p = out.patches;
  std::vector<int> offset(p.count);
  std::vector<std::uint8_t> upright(p.count);
  for (std::size_t r = 0; r < p.runs.size(); ++r) {
    offset[p.patch[r]] = planes[p.runs[r].label].offset;
    upright[p.patch[r]] = planes[p.runs[r].label].upright ? 1 : 0;
  }
  // Patches that meet in a fold: those of a greater number, each once, by growing number.
  Buckets<std::uint32_t> greater(p.count, [&](auto&& put) {
    for (std::size_t r = 1; r < p.runs.size(); ++r)
      if (p.runs[r].folds_on) {
        const auto [a, b] = std::minmax(p.patch[r - 1], p.patch[r]);
        put(a, b);
      }
  });
  for (std::uint32_t a = 0; a < p.count; ++a) std::sort(greater[a].begin(), greater[a].end());
  const Buckets<std::uint32_t> folds(p.count, [&](auto&& put) {
    for (std::uint32_t a = 0; a < p.count; ++a) {
      std::uint32_t before = a;
      for (const std::uint32_t b : greater[a]) {
        if (b == before) continue;
        before = b;
        put(a, b);
        put(b, a);
      }
    }
  });
  out.loose.assign(p.count, 0);
  for (const std::size_t first : {0U, 1U}) {  // the wall and the ground of the margin
    Propagation propagation(folds, offset);
    propagation.run(p.patch[first]);
    for (std::size_t k = 0; k < p.count; ++k)
      if (!propagation.is_held(k)) out.loose[k] = 1, ++out.open;
    if (out.open == 0) continue;
    for (std::uint32_t k = 0; k < p.count; ++k)
      if (upright[k] == (first == 0 ? 1 : 0)) out.pins += propagation.pin(k);
    for (std::uint32_t k = 0; k < p.count; ++k) out.pins += propagation.is_held(k) ? 0 : 1;
  }
  return out;
}

}  // namespace popcut
