// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

extern const std::string_view kHandsJson;  ///< core/data/hands.json

namespace hands {

/// How long a person takes for each thing that is done by hand (docs/hands.md, section 2).
struct Hands {
  /// Folds of at least this length.
  struct FoldTime {
    double from_mm{};
    double fold_s{};
  };
  /// A card is so hard if it has no more folds, and none that is shorter.
  struct Grade {
    std::string label;
    std::size_t most_folds{};
    double shortest_mm{};
  };
  std::vector<FoldTime> folds;  ///< longest first; the last one is for all lengths
  double waste_s{};             ///< to take out a piece of waste
  double tab_s{};               ///< to glue a tab
  std::vector<Grade> grades;    ///< easiest first; a card of none of them is "hard"
};

/// Reads a table like core/data/hands.json.
///
/// @retval Malformed, OutOfRange  place is a JSON pointer
[[nodiscard]] Result<Hands> read_hands(std::string_view json);

/// The table that popcut comes with.
[[nodiscard]] const Hands& built_in_hands();

/// The last `hands` among users' tables, as `popcut calibrate --hands` writes it: what it leaves
/// out is as in popcut's own. Without any, popcut's own.
///
/// @retval Malformed, OutOfRange  place is "table N: " and a JSON pointer
[[nodiscard]] Result<Hands> hands_of(const std::vector<std::string>& user_tables);

}  // namespace hands
}  // namespace popcut
