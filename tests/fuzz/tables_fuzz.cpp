// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/machines/machine.hpp"
#include "device/sim/sim_faults.hpp"

using namespace popcut;

// A user's own table of machines and materials, and a fault script: refused with a reason, or with
// figures that a plan can be made of.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto machines = all_machines({text});
  if (!machines && machines.error().detail.empty()) std::abort();
  const auto materials = all_materials({text});
  if (!materials && materials.error().detail.empty()) std::abort();
  if (materials)
    for (const Material& one : *materials)
      if (one.name.empty() ||
          !(one.blade_offset_mm >= 0 && one.overcut_mm >= 0 && std::isfinite(one.blade_offset_mm) &&
            std::isfinite(one.overcut_mm)))
        std::abort();
  const auto faults = parse_faults(text);
  if (faults && faults->size() > 1000) std::abort();
  if (!faults && faults.error().detail.empty()) std::abort();
  return 0;
}
