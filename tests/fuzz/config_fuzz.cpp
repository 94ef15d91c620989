// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "daemon/config/config.hpp"

using namespace popcut;

// popcutd.toml is refused at a place, or every limit in it is one that popcutd can keep.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto config = daemon::parse_config({reinterpret_cast<const char*>(data), size});
  if (!config) {
    if (config.error().detail.empty() || config.error().place.empty()) std::abort();
    return 0;
  }
  if (config->queue_jobs < 1 || config->sheets_per_job < 1 || config->planner.processes < 1 ||
      !(config->planner.cpu_s > 0) || config->limits.connections < 1)
    std::abort();
  for (const daemon::DeviceConfig& device : config->devices)
    if (device.id.empty() || !(device.time_scale >= 0)) std::abort();
  return 0;
}
