// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "core/verify/verify.hpp"

namespace popcut {

/// The members of `verify_json`, for documents that contain a report.
[[nodiscard]] nlohmann::ordered_json verify_report_json(const VerifyReport& report);

/// The `checks` of a report.
[[nodiscard]] nlohmann::ordered_json checks_json(const std::vector<VerifyCheck>& checks);

}  // namespace popcut
