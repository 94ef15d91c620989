// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut {

/// The built-in tables core/data/*.json, embedded when the library is built.
extern const std::string_view kMachinesJson;
extern const std::string_view kMaterialsJson;
extern const std::string_view kSvgProfilesJson;

}  // namespace popcut
