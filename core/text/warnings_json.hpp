// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"
#include "core/warning.hpp"

namespace popcut {

/// The `warnings` of a report: code and message of each.
[[nodiscard]] inline nlohmann::ordered_json warnings_json(const std::vector<Warning>& warnings) {
  return json_list(warnings, [](const Warning& warning) {
    return nlohmann::ordered_json{{"code", warning.code}, {"message", warning.message}};
  });
}

}  // namespace popcut
