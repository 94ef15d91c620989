// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "core/result.hpp"
#include "daemon/planning/plan_words.hpp"

namespace popcut::planning {

/// The words of `popcut plan`, as a request to popcutd gives them: by the option's name without
/// dashes ("mat", "seam-x", "no-split"; "split": "false" is the same as the last). Flags are "true"
/// or "false", lists have commas between.
///
/// @retval OutOfRange  no such option (place "/options/NAME"), or a value that is not lawful
[[nodiscard]] Result<PlanWords> words_of_options(const std::map<std::string, std::string>& options);

/// An error about a word of the command line ("--mat") as one about a request ("/options/mat").
[[nodiscard]] Error in_request(Error error);

}  // namespace popcut::planning
