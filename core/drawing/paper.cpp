// SPDX-License-Identifier: MIT
#include "core/drawing/paper.hpp"

#include <algorithm>
#include <utility>

#include "core/text/words.hpp"

namespace popcut {

std::optional<Paper> find_paper(std::string_view word) {
  constexpr std::string_view kTurned = "-landscape";
  const bool is_turned =
      word.size() > kTurned.size() && same_word(word.substr(word.size() - kTurned.size()), kTurned);
  if (is_turned) word.remove_suffix(kTurned.size());
  const auto* const found = std::find_if(kPapers.begin(), kPapers.end(), [&](const Paper& paper) {
    return same_word(paper.name, word);
  });
  if (found == kPapers.end()) return std::nullopt;
  Paper paper = *found;
  if (is_turned) std::swap(paper.width_mm, paper.height_mm);
  return paper;
}

}  // namespace popcut
