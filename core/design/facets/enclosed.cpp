// SPDX-License-Identifier: MIT
#include "core/design/facets/enclosed.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "core/design/facets/strip_moves.hpp"
#include "core/geometry/disjoint_sets.hpp"

namespace popcut {
namespace {

constexpr int kReach = 8;            ///< steps from the end of a stretch
constexpr double kWorthStrut = 4.0;  ///< times the estimated cost of a strut
constexpr double kAside = 0.2;       ///< of its cost, what a strip at the side costs more

/// A level plane reaches from a stretch back to the wall: its first one, or one that meets the
/// first in a fold. False: none does.
bool go_on_to_wall(const Labelling& labelling, const EnclosedPiece::Stretch& stretch,
                   std::vector<Label>& labels) {
  const FacetPlanes& planes = labelling.planes();
  const FacetGrid& grid = labelling.image().grid;
  const Label first = labels[static_cast<std::size_t>(stretch.begin)];
  for (int line = stretch.begin; line < std::min(stretch.begin + kReach + 1, stretch.end); ++line) {
    if (labels[static_cast<std::size_t>(line)] != first) return false;
    const Label level = planes[first].upright ? planes.partner(first, grid.across(line)) : first;
    if (level == kNoLabel || level == kGroundLabel) continue;
    const int wall = grid.wall - planes[level].offset;
    if (wall < 1 || wall >= line || labels[static_cast<std::size_t>(wall - 1)] != kWallLabel)
      continue;
    std::fill(labels.begin() + wall, labels.begin() + line, level);
    return true;
  }
  return false;
}

/// An upright plane reaches from a stretch down to the ground, likewise.
bool go_on_to_ground(const Labelling& labelling, const EnclosedPiece::Stretch& stretch,
                     std::vector<Label>& labels) {
  const FacetPlanes& planes = labelling.planes();
  const FacetGrid& grid = labelling.image().grid;
  const Label last = labels[static_cast<std::size_t>(stretch.end - 1)];
  for (int line = stretch.end; line > std::max(stretch.end - kReach - 1, stretch.begin); --line) {
    if (labels[static_cast<std::size_t>(line - 1)] != last) return false;
    const Label upright = planes[last].upright ? last : planes.partner(last, grid.across(line));
    if (upright == kNoLabel || upright == kWallLabel) continue;
    const int ground = grid.wall + planes[upright].offset;
    if (ground <= line || ground >= grid.columns ||
        labels[static_cast<std::size_t>(ground)] != kGroundLabel)
      continue;
    std::fill(labels.begin() + line, labels.begin() + ground, upright);
    return true;
  }
  return false;
}

/// The strips of a piece without it.
NewStrips without_piece(const LabelImage& image, const EnclosedPiece& piece,
                        const LabelImage& filled) {
  NewStrips out;
  for (const EnclosedPiece::Stretch& stretch : piece.stretches) {
    if (out.empty() || out.back().strip != stretch.strip)
      out.push_back({stretch.strip, labels_of(image, stretch.strip)});
    const auto then = filled.strip(stretch.strip);
    std::copy(then.begin() + stretch.begin, then.begin() + stretch.end,
              out.back().labels.begin() + stretch.begin);
  }
  return out;
}

/// Whether to do without a piece costs far more than a strut for it.
bool is_worth_a_strut(Labelling& labelling, const EnclosedPiece& piece, const LabelImage& filled) {
  const int wall = filled.grid.wall;
  double loss = 0.0, strut = std::numeric_limits<double>::infinity();
  bool any = false;
  for (const auto& [s, paper] : without_piece(labelling.image(), piece, filled)) {
    const std::vector<Label> now = labels_of(labelling.image(), s);
    std::vector<Label> open = now;
    for (const EnclosedPiece::Stretch& stretch : piece.stretches)
      for (int i = stretch.begin; stretch.strip == s && i < stretch.end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        open[at] = i < wall ? kWallLabel : kGroundLabel;
        any = any || !is_card(now[at]);
      }
    loss += std::min(labelling.distance(s, paper), labelling.distance(s, open)) -
            labelling.distance(s, now);
    strut = std::min(strut, labelling.cost(s, labelling.best(s, false)) - labelling.cost(s, now));
  }
  return any && loss > kWorthStrut * strut;
}

}  // namespace

std::vector<EnclosedPiece> enclosed_pieces(const LabelImage& image, const LabelImage& filled,
                                           bool by_card) {
  std::vector<EnclosedPiece::Stretch> all;
  const FacetGrid& grid = image.grid;
  for (int s = 0; s < grid.strips; ++s) {
    const auto now = image.strip(s), then = filled.strip(s);
    const auto is_free = [&](int i) {
      const auto at = static_cast<std::size_t>(i);
      return now[at] != then[at] && is_card(then[at]) == by_card;
    };
    for (int i = 0; i < grid.columns; ++i) {
      if (!is_free(i)) continue;
      const int begin = i;
      while (i < grid.columns && is_free(i)) ++i;
      all.push_back({s, begin, i});
    }
  }
  DisjointSets sets(all.size());
  for (std::uint32_t a = 0; a < all.size(); ++a)
    for (std::uint32_t b = a + 1; b < all.size() && all[b].strip <= all[a].strip + 1; ++b)
      if (all[b].strip == all[a].strip + 1 && all[a].begin < all[b].end &&
          all[b].begin < all[a].end)
        sets.join(a, b);
  std::vector<std::uint32_t> number;
  std::vector<EnclosedPiece> out(sets.number(number));
  for (std::size_t k = 0; k < all.size(); ++k) out[number[k]].stretches.push_back(all[k]);
  return out;
}

std::optional<NewStrip> bridge(Labelling& labelling, const EnclosedPiece& piece,
                               const LabelImage& filled) {
  const double most = extra_cost(labelling, without_piece(labelling.image(), piece, filled));
  double least = 0.0;
  std::optional<NewStrip> best;
  // A strip in the middle carries better than one at the side.
  const int first = piece.stretches.front().strip, last = piece.stretches.back().strip;
  for (const EnclosedPiece::Stretch& stretch : piece.stretches) {
    NewStrip strip{stretch.strip, labels_of(labelling.image(), stretch.strip)};
    if (!go_on_to_wall(labelling, stretch, strip.labels) ||
        !go_on_to_ground(labelling, stretch, strip.labels) ||
        !is_wide(strip.labels, labelling.limits().least_run))
      continue;
    const double cost = extra_cost(labelling, {strip});
    const double aside = std::abs(2 * stretch.strip - first - last) /
                         std::max(1.0, static_cast<double>(last - first));
    const double price = cost + kAside * aside * std::abs(cost);
    if (cost < most && (!best || price < least)) least = price, best = std::move(strip);
  }
  return best;
}

LabelImage with_worthy_pieces(Labelling& labelling, const LabelImage& filled) {
  LabelImage out = filled;
  for (const EnclosedPiece& piece : enclosed_pieces(labelling.image(), filled, false))
    if (is_worth_a_strut(labelling, piece, filled))
      for (const EnclosedPiece::Stretch& stretch : piece.stretches) {
        const auto now = std::as_const(labelling).image().strip(stretch.strip);
        std::copy(now.begin() + stretch.begin, now.begin() + stretch.end,
                  out.strip(stretch.strip).begin() + stretch.begin);
      }
  return out;
}

}  // namespace popcut
