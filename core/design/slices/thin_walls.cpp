// SPDX-License-Identifier: MIT
#include "core/design/slices/thin_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace popcut {
namespace {

/// Looks along the walls of slots, a level line after the other.
class WallRule {
 public:
  WallRule(double slot_mm, double least_mm, double length_mm)
      : half_mm_(0.5 * slot_mm), least_mm_(least_mm), length_mm_(length_mm) {}

  /// @param levels  the piece, asked for its paper on level lines
  /// @param at_mm   the middle of the slot, and `from`..`to` its ends
  /// @param next    middles of all slots of the family
  [[nodiscard]] std::optional<ThinWall> look(const UprightLines& levels, double at_mm,
                                             PaperSpan slot,
                                             const std::vector<double>& next) const {
    std::optional<ThinWall> worst;
    for (const double side : {-1.0, 1.0}) {
      const auto steps =
          static_cast<int>(std::clamp(std::ceil(slot.length() / kStep_mm), 1.0, kMostSteps));
      const double wall = at_mm + side * half_mm_;
      double sum = 0.0, end = 0.0;
      int thin = 0;
      for (int k = 0; k < steps; ++k) {
        const double z = slot.from + (k + 0.5) / steps * slot.length();
        // Paper from the slot on; none where the slot is open at its side.
        double thick = std::numeric_limits<double>::infinity();
        bool begins = false;
        for (const double u : levels.passages_at(z)) {
          const double off = side * (u - wall);
          if (std::abs(off) < kTouch_mm)
            begins = true;
          else if (off > 0.0)
            thick = std::min(thick, off);
        }
        if (!begins || thick >= least_mm_) continue;
        ++thin, sum += thick, end = wall + side * thick;
      }
      const double thin_mm = slot.length() * thin / steps, mean = thin > 0 ? sum / thin : 0.0;
      if (thin_mm <= length_mm_ || (worst && worst->thick_mm <= mean)) continue;
      const bool is_between = std::any_of(next.begin(), next.end(), [&](double other) {
        return other != at_mm && std::abs(other - side * half_mm_ - end) < kTouch_mm;
      });
      worst = ThinWall{0, 0, mean, thin_mm, is_between};
    }
    return worst;
  }

 private:
  static constexpr double kStep_mm = 0.5, kMostSteps = 40.0, kTouch_mm = 0.02;
  double half_mm_, least_mm_, length_mm_;
};

}  // namespace

std::vector<ThinWall> thin_walls(const std::vector<Slice>& slices, const SliceLattice& lattice,
                                 double slot_mm, double least_mm, double length_mm) {
  std::vector<UprightLines> levels;
  for (const SlicePiece& piece : lattice.pieces) {
    FlatRings turned = piece.paper;
    for (std::vector<Vec2>& ring : turned)
      for (Vec2& p : ring) std::swap(p.x(), p.y());
    levels.emplace_back(turned);
  }
  const auto at_mm = [&](std::size_t piece) { return slices[lattice.pieces[piece].slice].at_mm; };
  // Slots are at all slices of the other family, also at those that hold nothing there.
  std::array<std::vector<double>, 2> slots;
  for (const Slice& slice : slices)
    slots[slice.family == SliceFamily::X ? 0 : 1].push_back(slice.at_mm);
  const WallRule rule(slot_mm, least_mm, length_mm);
  std::vector<std::optional<ThinWall>> worst(lattice.pieces.size());
  for (const SliceCrossing& one : lattice.crossings) {
    const bool x_first = lattice.pieces[one.x_piece].step < lattice.pieces[one.y_piece].step;
    for (const auto& [piece, other, is_first] : {std::tuple(one.x_piece, one.y_piece, x_first),
                                                 std::tuple(one.y_piece, one.x_piece, !x_first)}) {
      const PaperSpan slot =
          is_first ? PaperSpan{one.split_mm, one.to_mm} : PaperSpan{one.from_mm, one.split_mm};
      auto wall =
          rule.look(levels[piece], at_mm(other), slot,
                    slots[slices[lattice.pieces[other].slice].family == SliceFamily::X ? 0 : 1]);
      if (!wall || (worst[piece] && worst[piece]->thick_mm <= wall->thick_mm)) continue;
      wall->piece = piece, wall->other = other;
      worst[piece] = wall;
    }
  }
  std::vector<ThinWall> out;
  for (const auto& one : worst)
    if (one) out.push_back(*one);
  return out;
}

}  // namespace popcut
