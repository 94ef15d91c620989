// SPDX-License-Identifier: MIT
#include "daemon/planning/make/make_ways.hpp"

#include <algorithm>
#include <array>

namespace popcut::planning {

std::span<const MakeWay> make_ways() {
  static constexpr std::array<MakeWay, 4> kWays{{
      {"hand", "none", "", "pdf"},
      {"cricut", "cricut-maker", "", "cricut"},
      {"silhouette", "cameo3", "", "dxf,svg", "perforate"},
      {"laser", "", "A4", "laser", "perforate"},
  }};
  return kWays;
}

const MakeWay* find_make_way(std::string_view name) {
  const auto ways = make_ways();
  const auto found =
      std::find_if(ways.begin(), ways.end(), [&](const MakeWay& way) { return way.name == name; });
  return found == ways.end() ? nullptr : &*found;
}

}  // namespace popcut::planning
