// SPDX-License-Identifier: MIT
#include "core/search/choices.hpp"

#include <fmt/format.h>

#include "core/search/candidate.hpp"
#include "core/search/standing.hpp"

namespace popcut {

std::vector<std::string> label_words() { return {"any", "medium", "easy"}; }

Result<void> check_choices(const std::string& style, int cards, const std::string& up,
                           const std::string& front) {
  if (cards != 1 && (cards < kLeastCards || cards > kMostCards))
    return fail(
        ErrorKind::Usage, "/cards",
        fmt::format("is {}: give 1, or {} to {} cards of a book", cards, kLeastCards, kMostCards));
  const StyleChoice left = styles_for_cards(style_choice(style), cards);
  if (!left.facets && left.lattices.empty() && !left.silhouettes)
    return fail(ErrorKind::Usage, "/style",
                style == "facets"
                    ? fmt::format("facets make books of 4 cards only, and you ask for {}", cards)
                    : fmt::format("is \"{}\", which makes no books, and you ask for {} cards",
                                  style, cards));
  const FrontSide faces = up_side(front);
  if (cards > 1 && faces)
    return fail(ErrorKind::Usage, "/front",
                "is for cards; a book shows the model from all sides, so leave it out");
  if (upright_turns(up_side(up), faces).empty())
    return fail(ErrorKind::Usage, "/front",
                fmt::format("is \"{}\", along the axis that `up` says; give another axis", front));
  return {};
}

}  // namespace popcut
