// SPDX-License-Identifier: MIT
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

// Called by main of support/main.cpp.
int run_cases(int argc, char** argv) { return Catch::Session().run(argc, argv); }
