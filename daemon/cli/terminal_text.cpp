// SPDX-License-Identifier: MIT
#include "daemon/cli/terminal_text.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

namespace popcut::cli {
namespace {

using Span = std::pair<char32_t, char32_t>;

// Combining marks, joiners and selectors (Unicode 15, categories Mn and Cf of common scripts).
constexpr std::array<Span, 8> kNoColumn{{{0x300, 0x36F},
                                         {0x483, 0x489},
                                         {0x591, 0x5BD},
                                         {0x64B, 0x65F},
                                         {0x200B, 0x200F},
                                         {0x20D0, 0x20FF},
                                         {0xFE00, 0xFE0F},
                                         {0xFE20, 0xFE2F}}};
// East Asian Width W and F, and emoji (Unicode 15, EastAsianWidth.txt), in whole blocks.
constexpr std::array<Span, 11> kTwoColumns{{{0x1100, 0x115F},
                                            {0x2E80, 0x303E},
                                            {0x3041, 0xA4CF},
                                            {0xA960, 0xA97F},
                                            {0xAC00, 0xD7A3},
                                            {0xF900, 0xFAFF},
                                            {0xFE30, 0xFE6F},
                                            {0xFF00, 0xFF60},
                                            {0xFFE0, 0xFFE6},
                                            {0x1F300, 0x1FAFF},
                                            {0x20000, 0x3FFFD}}};

template <std::size_t N>
bool is_in(const std::array<Span, N>& spans, char32_t c) {
  return std::any_of(spans.begin(), spans.end(),
                     [c](const Span& span) { return c >= span.first && c <= span.second; });
}

struct Letter {
  std::size_t bytes{1}, columns{1};
};

/// The first character of `text`; a byte that is no UTF-8 is one column.
Letter first_letter(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(0);
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC0 ? 2 : 1;
  if (bytes == 1 || bytes > text.size()) return {};
  char32_t c = lead & (0xFFu >> (bytes + 1));
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0u) != 0x80u) return {};
    c = (c << 6) | (byte(k) & 0x3Fu);
  }
  return {bytes, is_in(kNoColumn, c) ? 0u : is_in(kTwoColumns, c) ? 2u : 1u};
}

/// How many bytes of `text` fit into `width` columns.
std::size_t bytes_within(std::string_view text, std::size_t width) {
  std::size_t at = 0, columns = 0;
  while (at < text.size()) {
    const Letter letter = first_letter(text.substr(at));
    if (columns + letter.columns > width) break;
    columns += letter.columns;
    at += letter.bytes;
  }
  return at;
}

/// Where the line may be broken: before the words that are listed, a whole command being one.
std::vector<std::string_view> parts_of(std::string_view line, std::size_t room) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t begin = std::min(line.find_first_not_of(' ', at), line.size());
    std::size_t end = std::min(line.find(' ', begin), line.size());
    if (line.substr(begin, 7) == "popcut ") {
      const std::size_t whole = std::min(line.find("  ", begin), line.size());
      if (columns_of(line.substr(begin, whole - begin)) <= room) end = whole;
    }
    parts.push_back(line.substr(at, end - at));  // with the blanks before it
    at = end;
  }
  return parts;
}

}  // namespace

std::size_t columns_of(std::string_view text) {
  std::size_t columns = 0;
  while (!text.empty()) {
    const Letter letter = first_letter(text);
    columns += letter.columns;
    text.remove_prefix(letter.bytes);
  }
  return columns;
}

std::string fitted(std::string text, std::size_t width) {
  text.resize(bytes_within(text, width));
  return text;
}

std::string padded(std::string text, std::size_t width) {
  text = fitted(std::move(text), width);
  return text + std::string(width - columns_of(text), ' ');
}

std::vector<std::string> wrapped(const std::string& line, std::size_t width, std::size_t indent) {
  if (columns_of(line) <= width) return {line};
  if (indent + 1 >= width) indent = 0;
  std::vector<std::string> lines{""};
  for (const std::string_view part : parts_of(line, width - indent)) {
    std::string next = lines.back() + std::string(part);
    if (columns_of(next) > width) {
      const std::size_t word = std::min(part.find_first_not_of(' '), part.size());
      const bool is_first = lines.back().find_first_not_of(' ') == std::string::npos;
      next = std::string(is_first ? std::min(word, indent) : indent, ' ') +
             std::string(part.substr(word));
      if (!is_first) lines.emplace_back();
    }
    for (; columns_of(next) > width; lines.emplace_back()) {  // a word longer than a line
      const std::size_t fits = std::max<std::size_t>(bytes_within(next, width), 1);
      lines.back() = next.substr(0, fits);
      next = std::string(indent, ' ') + next.substr(fits);
    }
    lines.back() = std::move(next);
  }
  for (std::string& one : lines) one.resize(one.find_last_not_of(' ') + 1);
  std::erase_if(lines, [](const std::string& one) { return one.empty(); });
  return lines;
}

std::size_t terminal_columns(int descriptor, std::size_t otherwise) {
  winsize size{};
  if (isatty(descriptor) != 1 || ioctl(descriptor, TIOCGWINSZ, &size) != 0) return otherwise;
  return size.ws_col > 0 ? size.ws_col : otherwise;
}

}  // namespace popcut::cli
