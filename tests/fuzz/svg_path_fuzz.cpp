// SPDX-License-Identifier: MIT
#include <cstdint>
#include <string_view>

#include "core/formats/svg/syntax/svg_path.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  popcut::SvgLines lines;
  (void)popcut::read_svg_path(text, 0.02, 100'000, lines);
  return 0;
}
