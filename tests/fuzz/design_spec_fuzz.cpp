// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/design/spec/spec.hpp"

using namespace popcut;

namespace {

void check(const DesignSpec& spec) {
  long slices = 0;
  for (const DesignSpec& patch : spec.patches) check(patch);
  if (!spec.patches.empty()) {
    if (spec.joins.size() + 1 != spec.patches.size()) std::abort();
    return;
  }
  for (const RegionSpec& region : spec.regions) {
    if (region.units_per_slice < 1 || region.units_per_slice > kMaxUnitsPerSlice) std::abort();
    slices += region.slices;
  }
  if (slices > kMaxSlices) std::abort();
  for (const double width : spec.widths_mm)
    if (!(width > 0 && std::isfinite(width))) std::abort();
}

}  // namespace

// A spec is refused with a reason and a place, or all of it is within its limits.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto spec = parse_design_spec({reinterpret_cast<const char*>(data), size});
  if (spec) {
    check(*spec);
  } else if (spec.error().detail.empty() || spec.error().place.empty()) {
    std::abort();
  }
  return 0;
}
