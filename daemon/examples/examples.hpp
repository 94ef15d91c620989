// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string_view>

namespace popcut {

/// A design spec that ships with popcut: `examples/NAME.json`, embedded when popcut is built.
struct Example {
  std::string_view name;
  std::string_view json;
};

/// All of them, in the order in which they are listed.
[[nodiscard]] std::span<const Example> examples();

}  // namespace popcut
