// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "daemon/cli/search/model_search.hpp"

namespace popcut::cli {

/// `front.json`: each card of the front with its figures, by growing time of folding, which one is
/// the best, and what each style makes with its usual settings. Without the time of day or of the
/// computer: the same search gives the same bytes.
[[nodiscard]] std::string front_json(const ModelSearchOptions& options, const SearchedModel& model);

/// The same in words, a line a card.
[[nodiscard]] std::string front_text(const ModelSearchOptions& options, const SearchedModel& model,
                                     const std::string& folder);

}  // namespace popcut::cli
