// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <utility>

#include "core/formats/dxf/dxf_tables.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

using Word = std::pair<std::string_view, DxfMeaning>;

constexpr std::array kWords{Word{"NO", DxfMeaning::Ignore},
                            Word{"NOT", DxfMeaning::Ignore},
                            Word{"IGNORE", DxfMeaning::Ignore},
                            Word{"GUIDE", DxfMeaning::Ignore},
                            Word{"CONSTRUCTION", DxfMeaning::Ignore},
                            Word{"DEFPOINT", DxfMeaning::Ignore},
                            Word{"MOUNTAIN", DxfMeaning::FoldMountain},
                            Word{"VALLEY", DxfMeaning::FoldValley},
                            Word{"FOLD", DxfMeaning::Fold},
                            Word{"FOLDING", DxfMeaning::Fold},
                            Word{"CREASE", DxfMeaning::Fold},
                            Word{"PERF", DxfMeaning::Fold},
                            Word{"PERFORATION", DxfMeaning::Fold},
                            Word{"SCORE", DxfMeaning::Score},
                            Word{"SCORING", DxfMeaning::Score},
                            Word{"MARK", DxfMeaning::Draw},
                            Word{"MARKING", DxfMeaning::Draw},
                            Word{"ENGRAVE", DxfMeaning::Draw},
                            Word{"ENGRAVING", DxfMeaning::Draw},
                            Word{"ETCH", DxfMeaning::Draw},
                            Word{"DRAW", DxfMeaning::Draw},
                            Word{"PEN", DxfMeaning::Draw},
                            Word{"LABEL", DxfMeaning::Draw},
                            Word{"OUTLINE", DxfMeaning::Outline},
                            Word{"BORDER", DxfMeaning::Outline},
                            Word{"BOUNDARY", DxfMeaning::Outline},
                            Word{"PERIMETER", DxfMeaning::Outline},
                            Word{"CUT", DxfMeaning::Cut},
                            Word{"CUTTING", DxfMeaning::Cut},
                            Word{"SLIT", DxfMeaning::Cut},
                            Word{"KERF", DxfMeaning::Cut}};

bool letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool small(char c) { return c >= 'a' && c <= 'z'; }

/// Splits "Valley_Folds 2" or "valleyFold2" into words: runs of letters; a capital after a
/// lower-case letter begins a new word.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < name.size() && words.size() < 32; ++i) {
    if (!letter(name[i])) continue;
    const bool begins = i == 0 || !letter(name[i - 1]) || (small(name[i - 1]) && !small(name[i]));
    if (begins) words.emplace_back();
    words.back() += capital(name[i]);
  }
  return words;
}

DxfMeaning meaning_of(std::string_view word) {
  for (const bool plural : {false, true}) {
    if (plural && (word.size() < 4 || word.back() != 'S')) break;
    const std::string_view one = plural ? word.substr(0, word.size() - 1) : word;
    for (const auto& [known, meaning] : kWords)
      if (known == one) return meaning;
  }
  return DxfMeaning::Unknown;
}

}  // namespace

std::string dxf_key(std::string_view name) {
  std::string key(name);
  for (char& c : key) c = capital(c);
  return key;
}

DxfMeaning dxf_meaning(std::string_view layer) {
  std::array<bool, 9> said{};
  const std::vector<std::string> words = words_of(layer.substr(0, 256));
  bool m = false, v = false;
  for (const std::string& word : words) {
    said.at(static_cast<std::size_t>(meaning_of(word))) = true;
    m = m || word == "M";
    v = v || word == "V";
  }
  const auto has = [&](DxfMeaning meaning) { return said.at(static_cast<std::size_t>(meaning)); };
  if (has(DxfMeaning::Ignore)) return DxfMeaning::Ignore;
  const bool sided = has(DxfMeaning::Fold) || words.size() == 1;
  const bool mountain = has(DxfMeaning::FoldMountain) || (sided && m);
  const bool valley = has(DxfMeaning::FoldValley) || (sided && v);
  if (mountain != valley) return mountain ? DxfMeaning::FoldMountain : DxfMeaning::FoldValley;
  if (mountain) return DxfMeaning::Fold;
  for (const DxfMeaning meaning : {DxfMeaning::Fold, DxfMeaning::Score, DxfMeaning::Draw,
                                   DxfMeaning::Outline, DxfMeaning::Cut})
    if (has(meaning)) return meaning;
  return DxfMeaning::Unknown;
}

}  // namespace popcut
