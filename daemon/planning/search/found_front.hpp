// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "core/search/candidate.hpp"
#include "daemon/model/model.hpp"
#include "daemon/planning/search/card_search.hpp"
#include "daemon/planning/search/glued_card.hpp"

namespace popcut::planning {

/// The settings of a candidate in words: "facets in strips of 2 mm, planes 1 mm apart".
[[nodiscard]] std::string settings_words(const Candidate& candidate);

/// The figures of what a search found, without its designs.
///
/// @param glued  beside it
[[nodiscard]] daemon::SearchFront figures_of(const FoundCards& found,
                                             std::span<const FoundGlued> glued);

}  // namespace popcut::planning
