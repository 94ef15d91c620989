// SPDX-License-Identifier: MIT
#include <cstdint>

#include "protocol/command_reader.hpp"
#include "tests/fuzz/program_checks.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  popcut::fuzzing::read_both_ways<popcut::HpglReader>(std::as_bytes(std::span(data, size)));
  return 0;
}
