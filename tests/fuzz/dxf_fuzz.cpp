// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/formats/dxf/dxf_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  popcut::DxfOptions options;
  options.most_points = 100'000;
  options.most_lines = 100'000;
  options.colours = popcut::DxfColours::OrigamiSim;
  const auto work = popcut::linework_from_dxf(text, options);
  if (!work) {
    if (work.error().detail.empty()) std::abort();
    return 0;
  }
  if (work->points.size() > options.most_points) std::abort();
  for (const popcut::PagePoint& p : work->points)
    if (!(std::abs(p.x) <= popcut::kMaxCoordinate && std::abs(p.y) <= popcut::kMaxCoordinate))
      std::abort();
  for (const popcut::DrawnLine& line : work->lines)
    if (line.count < 2 || line.first + line.count > work->points.size()) std::abort();
  return 0;
}
