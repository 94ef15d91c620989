// SPDX-License-Identifier: MIT
#include "device/compare/fold_chains.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/drawing/linework.hpp"

namespace popcut {
namespace {

constexpr double kSamePlaceMm = 1e-4;
constexpr double kStraight = 0.9999;         // cosine: within 0.8 degrees
constexpr std::size_t kMostAtOnePlace = 64;  // with more parts, a star, nothing is chained
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// One end of a part: 2 i is the a of part i, 2 i + 1 its b.
struct End {
  std::int64_t x{}, y{};
  std::uint32_t index{};
};

PagePoint direction_out(const FoldPart& part, bool from_b) {
  const PagePoint from = from_b ? part.segment.b : part.segment.a;
  const PagePoint to = from_b ? part.segment.a : part.segment.b;
  const double l = distance(from, to);
  return {(to.x - from.x) / l, (to.y - from.y) / l};
}

/// For each end, the end of the part that continues it in a straight line.
std::vector<std::uint32_t> partners(std::span<const FoldPart> parts) {
  std::vector<End> ends;
  ends.reserve(2 * parts.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i)
    for (const bool b : {false, true}) {
      const PagePoint p = b ? parts[i].segment.b : parts[i].segment.a;
      ends.push_back({std::llround(p.x / kSamePlaceMm), std::llround(p.y / kSamePlaceMm),
                      2 * i + (b ? 1u : 0u)});
    }
  std::sort(ends.begin(), ends.end(), [](const End& p, const End& q) {
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.index < q.index;
  });
  std::vector<std::uint32_t> partner(ends.size(), kNone);
  for (std::size_t first = 0; first < ends.size();) {
    std::size_t last = first;
    while (last < ends.size() && ends[last].x == ends[first].x && ends[last].y == ends[first].y)
      ++last;
    if (last - first <= kMostAtOnePlace)
      for (std::size_t i = first; i < last; ++i)
        for (std::size_t j = i + 1; j < last; ++j) {
          const std::uint32_t p = ends[i].index;
          const std::uint32_t q = ends[j].index;
          if (partner[p] != kNone || partner[q] != kNone || p / 2 == q / 2) continue;
          if (parts[p / 2].kind != parts[q / 2].kind) continue;
          const PagePoint u = direction_out(parts[p / 2], p % 2 == 1);
          const PagePoint v = direction_out(parts[q / 2], q % 2 == 1);
          if (u.x * v.x + u.y * v.y > -kStraight) continue;
          partner[p] = q;
          partner[q] = p;
        }
    first = last;
  }
  return partner;
}

}  // namespace

std::vector<FoldChain> chain_folds(std::span<const FoldPart> parts) {
  const std::vector<std::uint32_t> partner = partners(parts);
  std::vector<bool> used(parts.size(), false);
  std::vector<FoldChain> chains;
  const auto follow = [&](std::uint32_t entry) {
    FoldChain chain;
    for (std::uint32_t end = entry; end != kNone && !used[end / 2]; end = partner[end ^ 1u]) {
      used[end / 2] = true;
      chain.parts.push_back(end / 2);
      chain.turned.push_back(end % 2 == 1);
    }
    chains.push_back(std::move(chain));
  };
  // A straight chain is never a ring, but rounding may close one: the second loop handles it.
  for (std::uint32_t end = 0; end < partner.size(); ++end)
    if (partner[end] == kNone && !used[end / 2]) follow(end);
  for (std::uint32_t part = 0; part < parts.size(); ++part)
    if (!used[part]) follow(2 * part);
  return chains;
}

}  // namespace popcut
