// SPDX-License-Identifier: MIT
#include "core/text/near_names.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut {
namespace {

/// Letters to change, add, drop or swap with the next one (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> last(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      next[j] =
          std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        next[j] = std::min(next[j], last[j - 2] + 1);
    }
    last.swap(row);
    row.swap(next);
  }
  return row[b.size()];
}

}  // namespace

std::string nearest_word(std::string_view wrong, const std::vector<std::string>& names) {
  constexpr std::size_t kLongest = 64;
  std::string best;
  // Two letters of four are too many: "fast" is no slip of "best".
  std::size_t best_distance =
      (wrong.size() < 5 ? 1 : std::max<std::size_t>(2, wrong.size() / 3)) + 1;
  if (wrong.size() > kLongest) return best;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(wrong, name);
    if (distance < best_distance) best_distance = distance, best = name;
  }
  return best;
}

std::string suggestion(std::string_view wrong, const std::vector<std::string>& names) {
  const std::string near = nearest_word(wrong, names);
  if (!near.empty()) return fmt::format("did you mean {}?", near);
  constexpr std::size_t kFewest = 3, kMost = 6;
  std::vector<std::string> longer;
  for (const std::string& name : names)
    if (wrong.size() >= kFewest && name.find(wrong) != name.npos) longer.push_back(name);
  if (!longer.empty() && longer.size() <= kMost) {
    const std::string last = longer.back();
    longer.pop_back();
    return longer.empty() ? fmt::format("did you mean {}?", last)
                          : fmt::format("did you mean {} or {}?", fmt::join(longer, ", "), last);
  }
  return fmt::format("one of {}", fmt::join(names, ", "));
}

}  // namespace popcut
