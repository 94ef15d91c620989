// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "core/model/model_readers.hpp"
#include "core/text/utf8.hpp"

namespace popcut::model_readers {
namespace {

constexpr std::size_t kHead = 84;      // bytes before the first triangle, the count last
constexpr std::size_t kTriangle = 50;  // bytes of a triangle
constexpr std::size_t kNormal = 12;    // of them, before its corners

std::uint32_t announced(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHead - sizeof count, sizeof count);
  return count;
}

bool is_binary(std::string_view bytes) {
  if (bytes.size() < kHead) return false;
  // A text holds no zero bytes, and has a facet soon or is a solid without one.
  const std::string_view begin = bytes.substr(0, 1000);
  if (begin.find('\0') != std::string_view::npos) return true;
  const std::string low = lower(begin);
  return low.find("solid") == std::string::npos && low.find("facet") == std::string::npos;
}

tl::unexpected<Error> no_triangles(const std::string& name) {
  return fail(ErrorKind::Malformed, name, "has no triangles; a mesh needs faces");
}

/// Whether bytes behind the triangles are none: zeros that fill a block, or text.
bool is_filling(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](char c) {
    return c == '\0' || c == '\n' || c == '\r' || c == '\t' || (c >= 0x20 && c < 0x7f);
  });
}

/// The triangles that the head announces; all that are there, if the rest of the file is whole
/// triangles: some programs write a count that is too small, or none. A few other bytes after them,
/// zeros and text are left out.
Result<Model> read_binary(const std::string& name, std::string_view bytes) {
  const std::size_t there = (bytes.size() - kHead) / kTriangle;
  std::size_t count = announced(bytes);
  if (count < there && !is_filling(bytes.substr(kHead + kTriangle * count))) {
    if ((bytes.size() - kHead) % kTriangle != 0)
      return fail(ErrorKind::Malformed, name,
                  fmt::format("announces {} triangles, and {} bytes follow them; save the model "
                              "again",
                              count, bytes.size() - kHead - kTriangle * count));
    count = there;
  }
  if (there < count)
    return fail(
        ErrorKind::Malformed, name,
        fmt::format("announces {} triangles and holds {}; is the file whole?", count, there));
  if (auto few = check_triangles(name, count); !few) return tl::unexpected(few.error());
  if (count == 0) return no_triangles(name);
  Model out;
  out.corners.reserve(9 * count);
  for (std::size_t t = 0; t < count; ++t) {
    std::array<float, 9> corners{};
    std::memcpy(corners.data(), bytes.data() + kHead + kTriangle * t + kNormal, sizeof corners);
    if (!std::all_of(corners.begin(), corners.end(), [](float v) { return std::isfinite(v); }))
      return fail(ErrorKind::OutOfRange, fmt::format("{}: triangle {}", name, t),
                  "has a corner that is not a finite number; repair the mesh");
    out.corners.insert(out.corners.end(), corners.begin(), corners.end());
  }
  return out;
}

/// The words of a text, and the lines that they stand in.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  /// The next word; empty at the end.
  std::string_view next() {
    while (!rest_.empty() && is_blank_or_end(rest_.front())) {
      if (rest_.front() == '\n' || (rest_.front() == '\r' && !rest_.substr(1).starts_with('\n')))
        ++line_;
      rest_.remove_prefix(1);
    }
    std::size_t end = 0;
    while (end < rest_.size() && !is_blank_or_end(rest_[end])) ++end;
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
  }
  [[nodiscard]] std::size_t line() const { return line_; }

  /// Leaves out the name of a solid, which may be any words: the rest of the line, or what comes
  /// before its first facet.
  void skip_name() {
    const std::string_view line = rest_.substr(0, rest_.find_first_of("\r\n"));
    constexpr std::size_t kLongestName = 4096;
    const std::size_t facet = lower(line.substr(0, kLongestName)).find("facet normal");
    rest_.remove_prefix(facet == std::string::npos ? line.size() : facet);
  }

 private:
  static bool is_blank_or_end(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  std::string_view rest_;
  std::size_t line_{1};
};

/// Keywords in letters of either size, in any number of lines.
Result<Model> read_text(const std::string& name, std::string_view bytes) {
  Model out;
  Words words(bytes);
  std::size_t facets = 0, corners = 0;
  bool is_solid = false;
  const auto broken = [&](const char* what) {
    return fail(ErrorKind::Malformed, line_place(name, words.line()), what);
  };
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const std::string key = word.size() <= 8 ? lower(word) : std::string();
    is_solid = is_solid || key == "solid";
    if (key == "solid" || key == "endsolid") words.skip_name();
    if (key == "facet") {
      if (corners != 3 * facets) return broken("a facet begins before the last has three corners");
      if (auto few = check_triangles(name, ++facets); !few) return tl::unexpected(few.error());
    }
    if (key != "vertex") continue;
    if (++corners > 3 * facets) return broken("is a fourth corner of a facet; three are needed");
    const std::size_t line = words.line();
    for (int k = 0; k < 3; ++k) {
      std::string_view number = words.next();
      if (words.line() != line) number = {};
      const auto value = read_coordinate(name, line, number);
      if (!value) return tl::unexpected(value.error());
      out.corners.push_back(*value);
    }
  }
  if (facets == 0 && !is_solid)
    return fail(ErrorKind::Malformed, name, "is not an STL file; it has neither head nor facets");
  if (facets == 0) return no_triangles(name);
  if (corners != 3 * facets)
    return fail(ErrorKind::Malformed, name, "ends inside a facet; is the file whole?");
  return out;
}

}  // namespace

bool is_whole_binary_stl(std::string_view bytes) {
  return bytes.size() >= kHead && bytes.size() == kHead + kTriangle * std::size_t{announced(bytes)};
}

Result<Model> read_stl(const std::string& name, std::string_view bytes) {
  if (is_whole_binary_stl(bytes)) return read_binary(name, bytes);
  std::string kept;
  const std::string_view text = plain_lines(bytes, kept);
  // A text in UTF-16 may be longer than its bytes.
  const bool has_head = bytes.size() >= kHead;
  return has_head && is_binary(text) ? read_binary(name, bytes) : read_text(name, text);
}

}  // namespace popcut::model_readers
