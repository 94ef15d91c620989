// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/formats/csv/segments_reader.hpp"

using namespace popcut;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const auto convention : {SegmentConvention::Popcut, SegmentConvention::Paper}) {
    const auto panels = read_segments_csv(text, convention);
    if (!panels) {
      if (panels.error().detail.empty()) std::abort();
      continue;
    }
    if (panels->empty() || panels->size() > kMaxSegments) std::abort();
    for (const SegmentPanel& panel : *panels) {
      if (!(panel.width > 0 && std::isfinite(panel.width))) std::abort();
      for (const double place : {panel.x0, panel.z0, panel.x1, panel.z1, panel.v})
        if (!std::isfinite(place)) std::abort();
    }
  }
  return 0;
}
