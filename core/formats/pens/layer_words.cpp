// SPDX-License-Identifier: MIT
#include "core/formats/pens/layer_words.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_colour.hpp"
#include "core/machines/table.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/near_names.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostBytes = 256;  // of a name that are looked at
constexpr std::size_t kMostWords = 32;
constexpr std::size_t kLeastPart = 3;      // letters of a part of a compound
constexpr std::size_t kMostCompound = 48;  // bytes

/// The letter without case and accents; 0: no letter.
std::uint32_t plain_letter(std::uint32_t c) {
  // U+00C0 to U+017F
  constexpr std::string_view kLatin =
      "aaaaaaaceeeeiiiidnooooo*ouuuuytsaaaaaaaceeeeiiiidnooooo*"
      "ouuuuytyaaaaaaccccccccddddeeeeeeeeeegggg"
      "gggghhhhiiiiiiiiiiiijjkkklllllll"
      "lllnnnnnnnnnoooooooorrrrrrssssssssttttttuuuuuuuuuuuuwwyyyzzzzzzs";
  static_assert(kLatin.size() == 0x180 - 0xC0);
  constexpr std::array<std::pair<std::uint32_t, std::uint32_t>, 15> kOthers{{{0x218, 's'},
                                                                             {0x219, 's'},
                                                                             {0x21A, 't'},
                                                                             {0x21B, 't'},
                                                                             {0x3AC, 0x3B1},
                                                                             {0x3AD, 0x3B5},
                                                                             {0x3AE, 0x3B7},
                                                                             {0x3AF, 0x3B9},
                                                                             {0x3CC, 0x3BF},
                                                                             {0x3CD, 0x3C5},
                                                                             {0x3CE, 0x3C9},
                                                                             {0x3C2, 0x3C3},
                                                                             {0x386, 0x3B1},
                                                                             {0x388, 0x3B5},
                                                                             {0x451, 0x435}}};
  if (c < 0x80) {
    const char letter = lower(static_cast<char>(c));
    return letter >= 'a' && letter <= 'z' ? static_cast<std::uint32_t>(letter) : 0;
  }
  if (c < 0xC0 || c == 0xD7 || c == 0xF7) return 0;
  if (c < 0x180) return static_cast<unsigned char>(kLatin[c - 0xC0]);
  for (const auto& [from, to] : kOthers)
    if (c == from) return to;
  if (c >= 0x391 && c <= 0x3A9) return c + 0x20;  // Greek
  if (c >= 0x410 && c <= 0x42F) return c + 0x20;  // Cyrillic
  if (c >= 0x400 && c <= 0x40F) return plain_letter(c + 0x50);
  if (c == 0x1A0 || c == 0x1A1) return 'o';  // Vietnamese
  if (c == 0x1AF || c == 0x1B0) return 'u';
  if (c >= 0x1EA0 && c < 0x1EFA)
    return static_cast<unsigned char>(
        "aaaaaaaaaaaaeeeeeeeeiioooooooooooouuuuuuuyyyy"[(c - 0x1EA0) / 2]);
  if ((c >= 0x2000 && c <= 0x2BFF) || (c >= 0x3000 && c <= 0x3004) || (c >= 0x3007 && c <= 0x3030))
    return 0;                                                       // punctuation and symbols
  if (c >= 0xFF21 && c <= 0xFF5A) return plain_letter(c - 0xFEE0);  // wide letters
  if (c >= 0xFF00 && c <= 0xFF0F) return 0;
  return c;
}

bool is_accent(std::uint32_t c) { return c >= 0x300 && c < 0x370; }
bool is_apostrophe(std::uint32_t c) { return c == '\'' || c == 0x2019; }
bool is_capital(std::uint32_t c) {
  if (c >= 0x100 && c < 0x180) {  // capitals and small letters take turns
    const bool odd = (c >= 0x139 && c <= 0x148) || c >= 0x179;
    return c == 0x178 || (c % 2 == 1) == odd;
  }
  return (c >= 'A' && c <= 'Z') || (c >= 0xC0 && c <= 0xDE && c != 0xD7) ||
         (c >= 0x391 && c <= 0x3A9) || (c >= 0x400 && c <= 0x42F) || c == 0x1A0 || c == 0x1AF ||
         (c >= 0x1EA0 && c < 0x1EFA && c % 2 == 0);
}
/// Whether words of this script stand without blanks between.
bool is_unspaced(std::uint32_t c) {
  return (c >= 0xE00 && c < 0xE80) || (c >= 0x3005 && c < 0xA000) || (c >= 0xAC00 && c < 0xD7B0) ||
         (c >= 0xF900 && c < 0xFB00) || c >= 0x20000;
}

/// A word of a name: letters of one script, or a number.
struct Word {
  std::string text;
  bool unspaced{false};
  bool number{false};
  bool attached{false};  ///< nothing stands between it and the word before
  bool capital{false};   ///< it begins with a capital
  std::size_t letters{};
};

std::vector<Word> words_of(std::string_view name) {
  std::vector<Word> words;
  enum class Last { None, Small, Capital, Digit } last = Last::None;
  name = name.substr(0, kMostBytes);
  for (std::size_t i = 0; i < name.size();) {
    CodePoint point = code_point(name, i);
    if (point.length == 0) point = {static_cast<unsigned char>(name[i]), 1};
    i += point.length;
    const std::uint32_t c = point.value;
    if (is_accent(c) || is_apostrophe(c)) continue;
    const bool digit = c >= '0' && c <= '9';
    const std::uint32_t letter = digit ? c : plain_letter(c);
    if (letter == 0) {
      last = Last::None;
      continue;
    }
    const Last now = digit ? Last::Digit : is_capital(c) ? Last::Capital : Last::Small;
    const bool unspaced = is_unspaced(letter);
    const bool begins = last == Last::None || (last == Last::Digit) != digit ||
                        (last == Last::Small && now == Last::Capital) ||
                        words.back().unspaced != unspaced;
    if (begins) {
      if (words.size() == kMostWords) break;
      words.push_back({{}, unspaced, digit, last != Last::None, now == Last::Capital});
    }
    append_utf8(words.back().text, letter);
    if (c == 0xDF) words.back().text += 's';  // ss
    ++words.back().letters;
    last = now;
  }
  return words;
}

/// Whether words are an id that programs make up: "g17", "e4023"; or hexadecimal digits of
/// some length, such as "3fa9b2c1" and those of a UUID.
bool is_made_up(std::span<const Word> words) {
  if (words.size() >= 2 && words[0].letters == 1 && !words[0].capital && words[0].text[0] >= 'a' &&
      words[1].number && words[1].attached && (words[0].text == "g" || words[1].letters > 1) &&
      std::all_of(words.begin() + 2, words.end(), [](const Word& one) { return one.number; }))
    return true;
  constexpr std::size_t kLeastHexadecimal = 8;  // characters
  std::size_t characters = 0, numbers = 0;
  for (const Word& one : words) {
    if (one.text == "uuid") continue;
    if (one.text.find_first_not_of("0123456789abcdef") != one.text.npos) return false;
    characters += one.letters;
    numbers += one.number ? 1 : 0;
  }
  return characters >= kLeastHexadecimal && numbers >= 2 && numbers + 2 <= words.size();
}

std::string joined(const std::vector<Word>& words, std::size_t from, std::size_t count) {
  std::string text;
  for (std::size_t i = from; i < from + count; ++i) text += (i > from ? " " : "") + words[i].text;
  return text;
}

/// The rows of the table. The first is no meaning of its own: it takes that of the next word away.
constexpr std::array<std::pair<std::string_view, std::optional<LayerMeaning>>, 11> kRows{
    {{"not", std::nullopt},
     {"ignore", LayerMeaning::Ignore},
     {"fold-mountain", LayerMeaning::FoldMountain},
     {"fold-valley", LayerMeaning::FoldValley},
     {"fold", LayerMeaning::Fold},
     {"score", LayerMeaning::Score},
     {"draw", LayerMeaning::Draw},
     {"outline", LayerMeaning::Outline},
     {"cut", LayerMeaning::Cut},
     {"asked", LayerMeaning::Unknown},
     {"wordless", LayerMeaning::Wordless}}};

using Said = std::optional<LayerMeaning>;  ///< none: "not"

struct Table {
  std::map<std::string, Said, std::less<>> phrases;
  std::vector<std::pair<std::string, Said>> unspaced;  ///< the longest first
  std::size_t most_words{1};
};

Table read_table() {
  Table table;
  const auto rows = table_rows("layer_words", kLayerWordsJson, {});
  if (!rows) return table;  // it is built in, and a test reads it
  for (const TableRow& row : *rows) {
    const auto* known = std::find_if(kRows.begin(), kRows.end(),
                                     [&](const auto& one) { return one.first == row.name; });
    if (known == kRows.end()) continue;
    for (const nlohmann::json& entry : row.row.at("words")) {
      const std::vector<Word> words = words_of(entry.get_ref<const std::string&>());
      if (words.empty()) continue;
      const std::string text = joined(words, 0, words.size());
      table.phrases.emplace(text, known->second);
      table.most_words = std::max(table.most_words, words.size());
      if (words.size() == 1 && words[0].unspaced) table.unspaced.emplace_back(text, known->second);
    }
  }
  std::stable_sort(table.unspaced.begin(), table.unspaced.end(),
                   [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
  return table;
}

const Table& table() {
  static const Table kTable = read_table();
  return kTable;
}

/// Collects what the words of a name say, from left to right.
class Reading {
 public:
  explicit Reading(std::string_view name) : words_(words_of(name)) {
    if (is_made_up(words_)) return;
    for (std::size_t i = 0; i < words_.size();) i += take(i);
  }

  [[nodiscard]] LayerMeaning meaning() const {
    using enum LayerMeaning;
    if (has(Ignore)) return Ignore;
    // "Cut without fold" and "no fold" may mean to cut, "fold, do not cut" to fold.
    if (negated_ || not_folded_ || (left_out_ && says_use_)) return Unknown;
    if (left_out_) return Ignore;
    const bool letters = letters_ > 0 && !says_use_ && !has(Unknown);
    const bool sided = has(Fold) || (letters && letters_ == (m_ ? 1U : 0U) + (v_ ? 1U : 0U));
    const bool mountain = has(FoldMountain) || (sided && m_);
    const bool valley = has(FoldValley) || (sided && v_);
    if (mountain != valley) return mountain ? FoldMountain : FoldValley;
    if (mountain) return Fold;
    for (const LayerMeaning one : {Fold, Score, Draw, Outline, Cut, Unknown})
      if (has(one)) return one;
    return letters ? Unknown : Wordless;
  }

 private:
  [[nodiscard]] bool has(LayerMeaning meaning) const {
    return said_.test(static_cast<std::size_t>(meaning));
  }

  void say(const Said& said) {
    using enum LayerMeaning;
    if (!said || !is_known(*said)) {
      negated_ = negated_ || !said;
      if (said) said_.set(static_cast<std::size_t>(*said));
      return;
    }
    const bool folds = *said == Fold || *said == FoldMountain || *said == FoldValley;
    if (negated_) {
      (folds || *said == Score ? not_folded_ : left_out_) = true;
    } else {
      said_.set(static_cast<std::size_t>(*said));
      says_use_ = says_use_ || *said != Ignore;
    }
    negated_ = false;
  }

  /// Takes what begins at word `i`; returns how many words.
  std::size_t take(std::size_t i) {
    const Word& word = words_[i];
    for (std::size_t n = std::min(table().most_words, words_.size() - i); n > 0; --n)
      if (const auto* said = phrase(joined(words_, i, n))) {
        say(*said);
        return n;
      }
    if (word.number) {
      negated_ = false;  // "no 1"
    } else if (word.letters == 1 && !word.unspaced) {
      m_ = m_ || word.text == "m";
      v_ = v_ || word.text == "v";
      ++letters_;
    } else if (!(word.unspaced ? within(word.text) : compound(word.text))) {
      say(LayerMeaning::Unknown);
    }
    return 1;
  }

  /// Words and their plural.
  static const Said* phrase(std::string_view text) {
    const auto& known = table().phrases;
    auto found = known.find(text);
    if (found == known.end() && text.size() >= 4 && text.back() == 's')
      found = known.find(text.substr(0, text.size() - 1));
    return found == known.end() ? nullptr : &found->second;
  }

  /// Known words anywhere in a text without blanks.
  bool within(std::string_view text) {
    bool any = false;
    while (!text.empty()) {
      const auto& known = table().unspaced;
      const auto found = std::find_if(known.begin(), known.end(),
                                      [&](const auto& one) { return text.starts_with(one.first); });
      if (found == known.end()) {
        text.remove_prefix(code_point(text, 0).length);
        continue;
      }
      any = true;
      say(found->second);
      text.remove_prefix(found->first.size());
    }
    return any;
  }

  /// "foldline": a word that is nothing but known words.
  bool compound(std::string_view text) {
    if (text.size() > kMostCompound) return false;
    // How long the last part of the text up to here is; 0: none fits.
    std::vector<std::size_t> last(text.size() + 1, 0);
    for (std::size_t end = kLeastPart; end <= text.size(); ++end)
      for (std::size_t from = 0; from + kLeastPart <= end && last[end] == 0; ++from)
        if ((from == 0 || last[from] > 0) && phrase(text.substr(from, end - from)) != nullptr)
          last[end] = end - from;
    if (last.back() == 0) return false;
    std::vector<std::string_view> parts;
    for (std::size_t end = text.size(); end > 0; end -= last[end])
      parts.push_back(text.substr(end - last[end], last[end]));
    for (auto part = parts.rbegin(); part != parts.rend(); ++part) say(*phrase(*part));
    return true;
  }

  std::vector<Word> words_;
  std::bitset<16> said_;
  std::size_t letters_{};  ///< words of one letter
  bool m_{false}, v_{false};
  bool negated_{false};     ///< the next word is taken away
  bool left_out_{false};    ///< a word other than a fold is taken away
  bool not_folded_{false};  ///< a fold or score is
  bool says_use_{false};    ///< a known word, not of Ignore, is not
};

}  // namespace

LayerMeaning layer_meaning(std::string_view name) { return Reading(name).meaning(); }

char only_letter(std::string_view name) {
  char letter = 0;
  for (const Word& word : words_of(name)) {
    if (word.number) continue;
    if (letter != 0 || word.text.size() != 1) return 0;
    letter = word.text[0];
  }
  return letter;
}

bool is_letter_of_fold(std::string_view name) {
  const char letter = only_letter(name);
  return letter == 'm' || letter == 'v';
}

bool is_letter_of_cut(std::string_view name) {
  const char letter = only_letter(name);
  return letter == 'b' || letter == 'c';
}

std::string layer_key(std::string_view name) {
  const std::vector<Word> words = words_of(name);
  return joined(words, 0, words.size());
}

namespace {

constexpr std::size_t kMostListed = 6;

std::string listed_names(std::span<const std::string> names) {
  std::string list;
  for (const std::string& name : names.first(std::min(names.size(), kMostListed)))
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", name);
  return names.size() > kMostListed ? list + " ..." : list;
}

}  // namespace

std::string only_unknown_names(std::span<const std::string> names) {
  const bool one = names.size() == 1;
  return fmt::format(
      "the name{} {} {} neither cut nor fold, and no other name does: all lines are cut; if some "
      "are folds, say so with `layers`, such as \"{}=fold\"",
      one ? "" : "s", listed_names(names), one ? "says" : "say", names.back());
}

std::string unknown_names(std::span<const std::string> names) {
  std::string uses;
  for (const std::string& name : names.first(std::min(names.size(), kMostListed)))
    uses += fmt::format("{}{}=fold", uses.empty() ? "" : "; ", name);
  const bool one = names.size() == 1;
  return fmt::format(
      "the name{} {} {} neither cut nor fold, and other names do; popcut does not guess what "
      "these lines are for; use `layers` \"{}\" with fold, score, cut, draw or ignore for each, or "
      "`svg-profile` popcut to cut them all",
      one ? "" : "s", listed_names(names), one ? "says" : "say", uses);
}

Operation operation_of(LayerMeaning meaning) {
  switch (meaning) {
    case LayerMeaning::Draw:
      return Operation::Draw;
    case LayerMeaning::Score:
      return Operation::Score;
    case LayerMeaning::Fold:
    case LayerMeaning::FoldValley:
      return Operation::FoldValley;
    case LayerMeaning::FoldMountain:
      return Operation::FoldMountain;
    case LayerMeaning::Outline:
      return Operation::Outline;
    default:
      return Operation::Cut;
  }
}

namespace {

/// Reads "NAME=USE; NAME=USE"; `add` takes a name and its use, and says whether it is one.
///
/// @param right  what would be right, after "is not "
template <typename Add>
Result<void> read_uses(std::string_view text, const char* place, std::string_view right, Add add) {
  while (!trimmed(text).empty()) {
    const std::string_view entry = trimmed(take_word(text, ";"));
    if (entry.empty()) continue;
    const std::size_t equals = entry.rfind('=');
    const std::string_view name = trimmed(entry.substr(0, equals));
    const auto refused = [&] {
      return fail(ErrorKind::Usage, place,
                  fmt::format("\"{}\" is not {}", entry.substr(0, 60), right));
    };
    if (equals == entry.npos || name.empty()) return refused();
    std::string use = lower(trimmed(entry.substr(equals + 1)));
    if (use == "mountain" || use == "valley") use.insert(0, "fold-");
    const auto* known = std::find_if(kRows.begin(), kRows.end(), [&](const auto& row) {
      return row.second && is_known(*row.second) && row.first == use;
    });
    if (known == kRows.end()) {
      std::vector<std::string> names;
      for (const auto& [row, meaning] : kRows)
        if (meaning && is_known(*meaning)) names.emplace_back(row);
      return fail(
          ErrorKind::Usage, place,
          fmt::format("\"{}\" is no use of lines; {}", use.substr(0, 40), suggestion(use, names)));
    }
    if (!add(name, *known->second)) return refused();
  }
  return {};
}

}  // namespace

Result<LayerUses> parse_layer_uses(std::string_view text) {
  LayerUses uses;
  const auto read = read_uses(text, "/options/layers",
                              "a name and its use; write one such as \"Wing=cut; Notes=ignore\"",
                              [&](std::string_view name, LayerMeaning use) {
                                if (words_of(name).empty()) return false;
                                uses[layer_key(name)] = use;
                                return true;
                              });
  if (!read) return tl::unexpected(read.error());
  return uses;
}

Result<std::vector<ColourUse>> parse_colour_uses(std::string_view text) {
  std::vector<ColourUse> uses;
  const auto read = read_uses(
      text, "/options/colors",
      "a colour and its use; write one such as \"red=fold-mountain; #0000ff=fold-valley; colour "
      "30=ignore\"",
      [&](std::string_view name, LayerMeaning use) {
        ColourUse& one = uses.emplace_back();
        one.use = use;
        std::string_view rest = name;
        const std::string_view word = take_word(rest, " ");
        if (int index = 0; (same_word(word, "colour") || same_word(word, "color")) &&
                           read_number(trimmed(rest), index)) {
          one.index = index;
        } else if (const auto paint = parse_svg_paint(name);
                   paint && paint->kind == SvgPaint::Kind::Colour) {
          one.rgb = paint->rgb;
        }
        return one.rgb || one.index;
      });
  if (!read) return tl::unexpected(read.error());
  return uses;
}

std::optional<LayerMeaning> use_of_colour(std::span<const ColourUse> uses, std::uint32_t rgb) {
  const auto found =
      std::find_if(uses.begin(), uses.end(), [&](const ColourUse& one) { return one.rgb == rgb; });
  return found == uses.end() ? std::nullopt : std::optional(found->use);
}

std::optional<LayerMeaning> use_of_index(std::span<const ColourUse> uses, int index) {
  const auto values = values_of_index(index);
  const auto found = std::find_if(uses.begin(), uses.end(), [&](const ColourUse& one) {
    return one.index == index ||
           (values && one.rgb && (*one.rgb == values->front() || *one.rgb == values->back()));
  });
  return found == uses.end() ? std::nullopt : std::optional(found->use);
}

std::optional<std::array<std::uint32_t, 2>> values_of_index(int index) {
  constexpr std::array<std::array<std::uint32_t, 2>, 7> kColours{{{0xff0000, 0xff0000},
                                                                  {0xffff00, 0xffff00},
                                                                  {0x00ff00, 0x008000},
                                                                  {0x00ffff, 0x00ffff},
                                                                  {0x0000ff, 0x0000ff},
                                                                  {0xff00ff, 0xff00ff},
                                                                  {0x000000, 0xffffff}}};
  if (index < 1 || index > static_cast<int>(kColours.size())) return std::nullopt;
  return kColours.at(static_cast<std::size_t>(index - 1));
}

std::string index_text(int index) {
  const auto values = values_of_index(index);
  return values ? colour_text(values->front()) : fmt::format("colour {}", index);
}

LayerMeaning meaning_of_name(const LayerUses& uses, std::string_view name) {
  if (!uses.empty())
    if (const auto found = uses.find(layer_key(name)); found != uses.end()) return found->second;
  return layer_meaning(name);
}

}  // namespace popcut
