// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/search/candidate.hpp"
#include "daemon/model/model.hpp"
#include "daemon/planning/search/card_search.hpp"
#include "daemon/planning/search/layers_card.hpp"

namespace popcut::planning {

/// The settings of a candidate in words: "facets in strips of 2 mm, planes 1 mm apart".
[[nodiscard]] std::string settings_words(const Candidate& candidate);

/// The figures of what a search found, without its designs.
///
/// @param layers  beside it
[[nodiscard]] daemon::SearchFront figures_of(const FoundCards& found,
                                             const std::optional<FoundLayers>& layers);

}  // namespace popcut::planning
