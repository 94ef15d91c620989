// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <span>

#include "device/sim/simulate.hpp"
#include "tests/fuzz/program_checks.hpp"

// The simulated cutter behind both languages: it must come to rest and draw nothing twice as long.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace popcut;
  static const Machine gpgl = *find_machine("cameo3");
  static const Machine hpgl = *find_machine("hpgl-generic");
  if (size == 0) return 0;
  Machine machine = data[0] % 2 == 0 ? gpgl : hpgl;
  machine.buffer_bytes = 1U + data[0];
  const auto trace = simulate(std::as_bytes(std::span(data, size)), machine);
  if (!trace) return 0;
  fuzzing::demand(std::isfinite(trace->seconds) && trace->seconds >= 0);
  fuzzing::demand(trace->clipped_mm <= trace->cut_mm * (1 + 1e-9) + 1e-6);
  fuzzing::demand(trace->points.size() <= 2 * size);
  return 0;
}
