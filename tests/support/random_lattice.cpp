// SPDX-License-Identifier: MIT
#include "tests/support/random_lattice.hpp"

#include <fmt/format.h>

namespace popcut::testing {

std::string random_lattice_spec(std::mt19937& random, double scale) {
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto whole = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const int units = whole(1, 9), slices = whole(1, 9);
  const double size = scale * real(25, 120);
  std::string surface;
  if (whole(0, 3) > 0)
    surface = fmt::format(
        R"j("type":"revolution","radius":"{:.4f}*(1 + {:.3f}*sin({:.4f}*y + {:.3f}))")j", size,
        real(0, 0.6), real(0, 0.1) / scale, real(0, 6));
  else
    surface = fmt::format(
        R"j("type":"profile","z":"{:.4f}*(1 - (x/{:.4f})^{:.3f})*(1 + {:.3f}*cos(y/{:.1f}))")j",
        size, scale * real(25, 120), real(1, 4), real(0, 0.3), 40 * scale);
  std::string widths;
  if (whole(0, 1) == 0) {
    widths = fmt::format("{:.3f}", scale * real(1, 20));
  } else {
    for (int j = 0; j < slices; ++j)
      widths += fmt::format("{}{:.3f}", j == 0 ? "[" : ",", scale * real(1, 20));
    widths += "]";
  }
  const char* lattices[] = {"branching", "slices", "conformal", "levels", "direct"};
  return fmt::format(
      R"({{"popcut":1,"surface":{{{}}},"units_per_slice":{},"slices":{},"widths_mm":{},"lattice":"{}",
          "min_panel_mm":{:.3f}}})",
      surface, units, slices, widths, lattices[whole(0, 4)], real(0.05, 0.8));
}

}  // namespace popcut::testing
