// SPDX-License-Identifier: MIT
#include "core/formats/pens/pen_finder.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/formats/pens/layer_words.hpp"
#include "core/formats/svg/syntax/svg_colour.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostSeen = 12;  // for a message

/// Lower case, with spaces and underscores as hyphens.
std::string plain_name(std::string_view name) {
  std::string out = lower(trimmed(name));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c == ' ' || c == '_'; }, '-');
  return out;
}

/// Takes the word before a name, as in "layer red"; false if another one stands there.
bool takes_word(std::string_view& name, std::string_view word) {
  if (name.size() <= word.size() || !same_word(name.substr(0, word.size()), word) ||
      !is_blank(name[word.size()]))
    return false;
  name = trimmed(name.substr(word.size()));
  return true;
}

}  // namespace

PenFinder::PenFinder(const std::vector<std::string>& names) {
  for (const std::string& given : names) {
    Pen& pen = pens_.emplace_back();
    std::string_view name = trimmed(given);
    if (takes_word(name, "layer")) {
      pen.label = plain_name(name);
      continue;
    }
    const bool colour = takes_word(name, "colour") || takes_word(name, "color");
    if (int index = 0; colour && read_number(name, index)) pen.index = index;
    if (const auto paint = parse_svg_paint(name); paint && (paint->kind == SvgPaint::Kind::Colour))
      pen.rgb = paint->rgb;
    if (!pen.rgb && !pen.index) pen.label = plain_name(given);
  }
}

void PenFinder::see(std::string what) {
  if (seen_.size() < kMostSeen && std::find(seen_.begin(), seen_.end(), what) == seen_.end())
    seen_.push_back(std::move(what));
}

template <typename Fits>
std::uint8_t PenFinder::find(Fits fits) const {
  const auto found = std::find_if(pens_.begin(), pens_.end(), fits);
  return found == pens_.end() ? std::uint8_t{0}
                              : static_cast<std::uint8_t>(found - pens_.begin() + 1);
}

std::uint8_t PenFinder::of_layer(std::string_view name, bool listed) {
  const std::string label = plain_name(name);
  if (pens_.empty() || label.empty()) return 0;
  if (listed) see(fmt::format("layer {}", trimmed(name).substr(0, 40)));
  return find([&](const Pen& pen) { return pen.label == label; });
}

std::uint8_t PenFinder::of_colour(std::uint32_t rgb) {
  if (pens_.empty()) return 0;
  see(colour_text(rgb));
  return find([&](const Pen& pen) { return pen.rgb == rgb; });
}

std::uint8_t PenFinder::of_index(int index) {
  if (pens_.empty()) return 0;
  const auto values = values_of_index(index);
  see(index_text(index));
  return find([&](const Pen& pen) {
    return pen.index == index ||
           (values && pen.rgb && (*pen.rgb == values->front() || *pen.rgb == values->back()));
  });
}

std::uint8_t LookFinder::of_colour(std::string layer, std::uint32_t rgb) {
  return of({std::move(layer), colour_text(rgb)});
}

std::uint8_t LookFinder::of_index(std::string layer, int index) {
  return of({std::move(layer), index_text(index)});
}

std::uint8_t LookFinder::of(DrawnLook look) {
  auto found = std::find(seen_.begin(), seen_.end(), look);
  if (found == seen_.end()) {
    if (seen_.size() < kMostPens) seen_.push_back(std::move(look));
    found = seen_.end() - 1;
  }
  return static_cast<std::uint8_t>(found - seen_.begin() + 1);
}

}  // namespace popcut
