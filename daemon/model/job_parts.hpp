// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include "daemon/model/json_object.hpp"
#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// {material, machine, mat, width_mm, length_mm, side}: as it is stored and shown. An empty text is
/// null.
[[nodiscard]] JsonObject json_of(const LoadedSheet& load);
/// Nothing for what is no such object.
[[nodiscard]] std::optional<LoadedSheet> loaded_sheet_from_json(std::string_view json);

/// {folds, shortest_fold_mm, waste, tabs, fold_s, label}: as it is stored and shown.
[[nodiscard]] JsonObject json_of(const Handwork& work);
/// Nothing for what is no such object.
[[nodiscard]] std::optional<Handwork> handwork_from_json(std::string_view json);

}  // namespace popcut::daemon
