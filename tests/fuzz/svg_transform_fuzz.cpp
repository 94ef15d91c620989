// SPDX-License-Identifier: MIT
#include <cstdint>
#include <string_view>

#include "core/formats/svg/syntax/svg_transform.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto transform = popcut::parse_svg_transform(text)) {
    (void)transform->largest_scale();
    (void)(*transform)({1.0, -1.0});
  }
  return 0;
}
