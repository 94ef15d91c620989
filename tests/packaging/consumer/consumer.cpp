// SPDX-License-Identifier: MIT
// From a spec to a program that a Cameo 3 understands, with the installed libraries alone.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include <core/design/design.hpp>
#include <core/design/spec/spec.hpp>
#include <core/plan/plan.hpp>
#include <device/port/device_id.hpp>

#ifndef EIGEN_INITIALIZE_MATRICES_BY_ZERO
#error "Vec2 p; is zero in the libraries, and must be zero here"
#endif

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ifstream file(argv[1]);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto spec = popcut::parse_design_spec(text);
  if (!spec) return 3;
  const auto design = popcut::design(*spec, {});
  if (!design) return 4;
  const auto device = popcut::parse_device_id("sim:cameo3");
  if (!device) return 5;
  std::printf("%zu folds on %s\n", design->pattern.edges.size(), device->text.c_str());
  return 0;
}
