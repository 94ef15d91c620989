// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/hands/hands.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut::hands {

/// What a person has before them.
struct Handwork {
  std::size_t folds{};
  double shortest_mm{};  ///< fold; 0 if there is none
  std::size_t waste{};   ///< pieces to take out
  std::size_t tabs{};    ///< to glue
  double time_s{};       ///< to fold, by a table of hands
  std::string label;     ///< "easy", "medium" or "hard"
};

/// Counts and adds up what it takes to fold a card.
///
/// @param fold_lengths_mm  one a fold; pieces of one line that a cut parts are folds of their own
[[nodiscard]] Handwork handwork(std::span<const double> fold_lengths_mm, std::size_t waste,
                                std::size_t tabs, const Hands& hands = built_in_hands());

/// The same of a whole pattern: its folds, of which pieces that touch in one line count as one, and
/// the pieces that fall out of it. O(edges log edges).
[[nodiscard]] Handwork handwork(const Pattern& pattern, const Hands& hands = built_in_hands());

/// What it takes to fold several patterns, such as the cards of a book.
[[nodiscard]] Handwork handwork(std::span<const Pattern* const> patterns, const Hands& hands);

/// "19 folds, the shortest 6 mm; about 10 minutes to fold (easy)".
[[nodiscard]] std::string handwork_words(const Handwork& work);
/// "about 10 minutes", "under a minute".
[[nodiscard]] std::string minutes_words(double time_s);

}  // namespace popcut::hands
