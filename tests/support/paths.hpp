// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut::testing {

/// The path of a file of the repository: source_file("examples/sphere.json").
[[nodiscard]] std::string source_file(const std::string& name);

/// The programs of this build that tests start.
[[nodiscard]] const char* popcut_program();
[[nodiscard]] const char* popcutd_program();
[[nodiscard]] const char* worker_program();  ///< popcutd's planner worker alone
[[nodiscard]] const char* probe_program();   ///< a worker that misbehaves as it is asked to
/// The library that counts and fails system calls of the program it is loaded into.
[[nodiscard]] const char* fault_shim();

/// The version that CMakeLists.txt names.
[[nodiscard]] const char* popcut_version();

}  // namespace popcut::testing
