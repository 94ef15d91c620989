// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// The settings and figures of a card that a search found, its members by their names and in their
/// units, without `warnings` and `spec`: the worker, the store and the API have these as they need
/// them.
[[nodiscard]] nlohmann::ordered_json figures_json(const FoundCardRecord& card);

}  // namespace popcut::daemon
