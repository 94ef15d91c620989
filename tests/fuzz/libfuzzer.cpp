// SPDX-License-Identifier: MIT
// Runs one fuzz target with libFuzzer: popcut_fuzz TARGET OPTIONS OF LIBFUZZER ... Without TARGET,
// as libFuzzer starts itself again, it is the one that POPCUT_FUZZ_TARGET names. popcut_fuzz
// --targets prints the names of all targets.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/fuzz/targets.hpp"

namespace {

void (*chosen)(std::string_view bytes) = nullptr;

bool choose(std::string_view name) {
  for (const auto& target : popcut::fuzzing::all_targets())
    if (target.name == name) chosen = target.run;
  return chosen != nullptr;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const std::string_view word = *argc > 1 ? (*argv)[1] : "";
  if (word == "--targets") {
    for (const auto& target : popcut::fuzzing::all_targets())
      std::printf("%s\n", std::string(target.name).c_str());
    std::exit(0);
  }
  if (choose(word)) {
    ::setenv("POPCUT_FUZZ_TARGET", (*argv)[1], 1);
    for (int i = 1; i < *argc; ++i) (*argv)[i] = (*argv)[i + 1];
    --*argc;
  } else if (const char* const name = std::getenv("POPCUT_FUZZ_TARGET"); !name || !choose(name)) {
    std::fprintf(stderr, "usage: %s --targets, or %s TARGET [OPTION | FOLDER | FILE ...]\n",
                 (*argv)[0], (*argv)[0]);
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen({reinterpret_cast<const char*>(data), size});
  return 0;
}
