// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/formats/svg/svg_reader.hpp"

namespace {

const popcut::SvgReadOptions& options(bool colours) {
  const auto make = [](const char* name) {
    popcut::SvgReadOptions how;
    how.profile = *popcut::find_stroke_profile(name);
    how.limits = {100'000, 8u << 20, 20'000, 2'000'000, 100};
    return how;
  };
  static const popcut::SvgReadOptions plain = make("popcut"), rules = make("rabbit-ear");
  return colours ? rules : plain;
}

void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const popcut::SvgReadOptions& how = options(size % 2 == 0);
  const auto work = popcut::linework_from_svg(text, how);
  if (!work) {
    demand(!work.error().detail.empty());
    return 0;
  }
  demand(work->points.size() <= how.limits.points);
  std::size_t points = 0;
  for (const popcut::DrawnLine& line : work->lines) {
    demand(line.count >= 2 && line.first == points);
    points += line.count;
  }
  demand(points == work->points.size());
  for (const popcut::PagePoint& p : work->points)
    demand(std::abs(p.x) <= popcut::kMaxCoordinate && std::abs(p.y) <= popcut::kMaxCoordinate);
  return 0;
}
