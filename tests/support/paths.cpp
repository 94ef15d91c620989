// SPDX-License-Identifier: MIT
// The only source of the tests that CMake tells where things are: all others are compiled alike
// wherever they lie.
#include "tests/support/paths.hpp"

namespace popcut::testing {

std::string source_file(const std::string& name) {
  return std::string(POPCUT_SOURCE_DIR) + "/" + name;
}

const char* popcut_program() { return POPCUT_PROGRAM; }
const char* popcutd_program() { return POPCUTD_PROGRAM; }
const char* worker_program() { return POPCUT_WORKER; }
const char* probe_program() { return POPCUT_PROBE; }
const char* fault_shim() { return POPCUT_FAULT_SHIM; }
const char* popcut_version() { return POPCUT_VERSION; }

}  // namespace popcut::testing
