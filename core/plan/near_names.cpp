// SPDX-License-Identifier: MIT
#include "core/plan/near_names.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include <fmt/format.h>

namespace popcut {

int edit_distance(std::string_view a, std::string_view b) {
  constexpr std::size_t kLongest = 64;
  a = a.substr(0, kLongest);
  b = b.substr(0, kLongest);
  std::array<int, kLongest + 1> row{};
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i) + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (a[i] == b[j] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::string suggestion(std::string_view wrong, const std::vector<std::string>& names) {
  int nearest = std::max<int>(2, static_cast<int>(wrong.size()) / 3) + 1;
  std::string best;
  for (const std::string& name : names) {
    const int distance = edit_distance(wrong, name);
    if (distance < nearest) {
      nearest = distance;
      best = name;
    }
  }
  if (!best.empty()) return fmt::format("did you mean {}?", best);
  return fmt::format("one of {}", fmt::join(names, ", "));
}

}  // namespace popcut
