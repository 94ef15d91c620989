// SPDX-License-Identifier: MIT
#include "core/geometry/interval_medians.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace popcut {

std::vector<int> interval_medians(const std::map<int, double>& weight, int count) {
  std::vector<int> value;
  std::vector<double> sum{0.0}, moment{0.0};
  for (const auto& [at, points] : weight) {
    value.push_back(at);
    sum.push_back(sum.back() + points), moment.push_back(moment.back() + points * at);
  }
  const std::size_t n = value.size();
  const auto middle = [&](std::size_t a, std::size_t b) {
    const double half = 0.5 * (sum[a] + sum[b]);
    const auto above = std::lower_bound(sum.begin() + static_cast<std::ptrdiff_t>(a) + 1,
                                        sum.begin() + static_cast<std::ptrdiff_t>(b), half);
    return static_cast<std::size_t>(above - sum.begin()) - 1;
  };
  const auto cost = [&](std::size_t a, std::size_t b) {
    const std::size_t m = middle(a, b);
    return value[m] * (2.0 * sum[m] - sum[a] - sum[b]) + moment[a] + moment[b] - 2.0 * moment[m];
  };
  const std::size_t k = std::min(n, static_cast<std::size_t>(count));
  std::vector<std::vector<double>> least(
      k + 1, std::vector<double>(n + 1, std::numeric_limits<double>::infinity()));
  std::vector<std::vector<std::size_t>> from(k + 1, std::vector<std::size_t>(n + 1, 0));
  least[0][0] = 0.0;
  for (std::size_t parts = 1; parts <= k; ++parts)
    for (std::size_t b = parts; b <= n; ++b)
      for (std::size_t a = parts - 1; a < b; ++a) {
        if (!std::isfinite(least[parts - 1][a])) continue;
        const double all = least[parts - 1][a] + cost(a, b);
        if (all < least[parts][b]) least[parts][b] = all, from[parts][b] = a;
      }
  std::vector<int> out;
  for (std::size_t parts = k, b = n; parts > 0; b = from[parts][b], --parts)
    out.push_back(value[middle(from[parts][b], b)]);
  return out;
}

}  // namespace popcut
