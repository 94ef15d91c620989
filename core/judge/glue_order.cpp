// SPDX-License-Identifier: MIT
#include "core/judge/glue_order.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace popcut::judge {
namespace {

/// Whether all parts that are there, but `without`, hang on the first one.
bool hang_together(const std::vector<bool>& there, std::size_t without,
                   const std::vector<std::vector<std::size_t>>& beside) {
  std::vector<bool> seen(there.size(), false);
  std::vector<std::size_t> open{0};
  seen[0] = true;
  for (std::size_t k = 0; k < open.size(); ++k)
    for (const std::size_t other : beside[open[k]]) {
      if (seen[other] || !there[other] || other == without) continue;
      seen[other] = true;
      open.push_back(other);
    }
  const auto left = static_cast<std::size_t>(std::count(there.begin(), there.end(), true));
  return open.size() + 1 == left;
}

/// The share of the places of a part, at the contact where it is largest, that others hide.
double hidden_share(const std::vector<bool>& there, std::size_t part,
                    const std::vector<GlueContact>& contacts) {
  double most = 0.0;
  for (const GlueContact& contact : contacts) {
    if (contact.part != part && contact.other != part) continue;
    if (!there[contact.part] || !there[contact.other]) continue;
    std::uint32_t hidden = 0;
    for (std::size_t q = 0; q < there.size(); ++q)
      if (there[q] && q != part) hidden |= contact.hides[q];
    if (contact.places > 0)
      most = std::max(
          most, static_cast<double>(std::popcount(hidden)) / static_cast<double>(contact.places));
  }
  return most;
}

}  // namespace

std::vector<std::size_t> glue_order(std::size_t parts, const std::vector<GlueContact>& contacts) {
  std::vector<std::vector<std::size_t>> beside(parts);
  for (const GlueContact& contact : contacts) {
    beside[contact.part].push_back(contact.other);
    beside[contact.other].push_back(contact.part);
  }
  std::vector<bool> there(parts, true);
  std::vector<std::size_t> order;
  while (order.size() + 1 < parts) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t p = 1; p < parts; ++p) {
      if (!there[p]) continue;
      const double hidden = hidden_share(there, p, contacts);
      if (hidden < least && hang_together(there, p, beside)) least = hidden, best = p;
    }
    if (best == 0) break;  // they do not hang together
    there[best] = false;
    order.push_back(best);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace popcut::judge
