// SPDX-License-Identifier: MIT
// What popcutd does with --worker, and nothing else.
#include <string>

#include "daemon/planning/worker/worker.hpp"

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3 || std::string(argv[1]) != "--worker") return 2;
  return popcut::planning::run_worker(0, 1, argc == 3 ? argv[2] : "");
}
