// SPDX-License-Identifier: MIT
#include "daemon/cli/help/terminal_text.hpp"

#include <sys/ioctl.h>
#include <unistd.h>
#include <unistr.h>
#include <uniwidth.h>

#include <algorithm>
#include <cstdint>

namespace popcut::cli {
namespace {

struct Letter {
  std::size_t bytes{}, columns{};
};

/// The first character of `text`; what is no UTF-8, or controls something, is one column.
Letter first_letter(std::string_view text) {
  ucs4_t letter = 0;
  const int bytes =
      u8_mbtouc(&letter, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const int columns = uc_width(letter, "UTF-8");
  return {static_cast<std::size_t>(bytes), columns < 0 ? 1 : static_cast<std::size_t>(columns)};
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
