// SPDX-License-Identifier: MIT
#include "core/print/drawn_letters.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/layout/marks.hpp"
#include "core/text/text_sink.hpp"
#include "core/text/text_width.hpp"

namespace popcut {
namespace {

constexpr double kCapital = 0.7;  // height of capitals, of the size of a font

std::optional<std::string_view> attribute(std::string_view tag, std::string_view name) {
  const std::string begin = fmt::format(" {}=\"", name);
  const std::size_t at = tag.find(begin);
  if (at == tag.npos) return std::nullopt;
  tag.remove_prefix(at + begin.size());
  return tag.substr(0, tag.find('"'));
}

double number_of(std::optional<std::string_view> text, double otherwise) {
  double value = otherwise;
  if (text) std::from_chars(text->data(), text->data() + text->size(), value);
  return value;
}

std::string unescaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    bool found = false;
    for (const auto& [entity, letter] : {std::pair<std::string_view, char>{"&amp;", '&'},
                                         {"&lt;", '<'},
                                         {"&gt;", '>'},
                                         {"&quot;", '"'},
                                         {"&apos;", '\''}})
      if (text.starts_with(entity)) {
        out += letter;
        text.remove_prefix(entity.size());
        found = true;
        break;
      }
    if (found) continue;
    out += text.front();
    text.remove_prefix(1);
  }
  return out;
}

/// One space for each character that is not ASCII.
std::string capitals(std::string_view words) {
  std::string out;
  for (const char c : words) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0u) == 0x80u) continue;
    out += byte >= 0x80u ? ' ' : c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return out;
}

void put_letters(std::string& svg, std::string_view tag, std::string_view words, double size) {
  const std::string text = capitals(unescaped(words));
  const double natural = single_stroke_size(text, kCapital * size).x;
  if (!(natural > 0.0)) return;
  const double width = std::min(natural, 0.9 * text_width(unescaped(words), size));
  const std::string_view anchor = attribute(tag, "text-anchor").value_or("start");
  const double x = number_of(attribute(tag, "x"), 0.0) - (anchor == "end"      ? width
                                                          : anchor == "middle" ? width / 2
                                                                               : 0.0);
  const double y = number_of(attribute(tag, "y"), 0.0);
  auto lines = single_stroke(text, kCapital * size);
  lines.pop_back();  // the bar below the letters
  svg += fmt::format("<path fill=\"none\" stroke=\"#000000\" stroke-width=\"{:.3f}\" d=\"",
                     0.06 * size);
  for (const auto& line : lines)
    for (std::size_t i = 0; i < line.size(); ++i) {
      svg += i == 0 ? 'M' : 'L';
      append_rounded(svg, x + line[i].x * width / natural);
      svg += ' ';
      append_rounded(svg, y + line[i].y);
    }
  svg += "\"/>\n";
}

}  // namespace

std::string with_drawn_letters(std::string_view svg) {
  std::string out;
  double size = 16.0;  // of the group around a text
  while (!svg.empty()) {
    const std::size_t at = svg.find('<');
    out += svg.substr(0, at);
    if (at == svg.npos) break;
    svg.remove_prefix(at);
    const std::size_t end = svg.find('>');
    const std::string_view tag = svg.substr(0, end == svg.npos ? end : end + 1);
    if (tag.starts_with("<g ")) size = number_of(attribute(tag, "font-size"), size);
    const std::size_t close = tag.starts_with("<text ") ? svg.find("</text>") : svg.npos;
    if (close == svg.npos) {
      out += tag;
      svg.remove_prefix(tag.size());
      continue;
    }
    put_letters(out, tag, svg.substr(tag.size(), close - tag.size()),
                number_of(attribute(tag, "font-size"), size));
    svg.remove_prefix(close + std::string_view("</text>").size());
  }
  return out;
}

}  // namespace popcut
