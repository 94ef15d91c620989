// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace popcut::judge {

/// What holds a part of a card: another part, and of some places where a finger must press, those
/// that further parts keep it from, as bits.
struct GlueContact {
  std::size_t part{}, other{};
  std::uint32_t places{};            ///< how many; at most 32
  std::vector<std::uint32_t> hides;  ///< one a part: the places that it keeps a finger from
};

/// An order of gluing the parts of a card, the first part left out. It is found backwards: of the
/// parts that can be taken off while all others still hang on the first one, that one comes off
/// whose places are least hidden by those that remain; of equal ones the first. Parts only give way
/// as others come off, so an order without hidden places is found if there is one. O(parts^2
/// contacts).
///
/// @param parts  number of parts; all hang together
[[nodiscard]] std::vector<std::size_t> glue_order(std::size_t parts,
                                                  const std::vector<GlueContact>& contacts);

}  // namespace popcut::judge
