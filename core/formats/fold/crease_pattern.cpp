// SPDX-License-Identifier: MIT
#include "core/formats/fold/crease_pattern.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostOpxBytes = 16u << 20;

/// A line of a crease pattern: its type, and x and y of both ends.
using Crease = std::array<double, 5>;

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//") || line.starts_with('%');
}

/// Sets `wrong` to the first part of the line that is not right.
std::optional<Crease> crease_in(std::string_view line, std::string_view& wrong) {
  constexpr std::string_view kBetween = " \t\n\r\f,;";
  Crease crease{};
  for (double& number : crease) {
    line = trimmed(line, kBetween);
    const std::string_view word = take_word(line, kBetween);
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), number);
    wrong = word;
    if (fault != std::errc() || end != word.data() + word.size() || !std::isfinite(number) ||
        crease[0] != std::floor(crease[0]))
      return std::nullopt;
  }
  line = trimmed(line, kBetween);
  wrong = line;
  if (!line.empty() && !is_comment(line)) return std::nullopt;
  return crease;
}

bool is_crease(std::string_view line) {
  std::string_view wrong;
  return crease_in(line, wrong).has_value();
}

/// A number as Java writes it; NaN for anything else.
double number_in(std::string_view text) {
  double number = NAN;
  return read_number(trimmed(text), number) ? number : NAN;
}

/// Collects lines as the members of a FOLD text.
class FoldText {
 public:
  void add(const Crease& crease) {
    const int type = std::abs(crease[0]) < 10 ? static_cast<int>(crease[0]) : 0;
    const char letter = type == 1 ? 'B' : type == 2 ? 'M' : type == 3 ? 'V' : 'F';
    const char* const comma = count_ == 0 ? "" : ",";
    // The reader of FOLD lays the second coordinate to the right and the first one down.
    fmt::format_to(std::back_inserter(points_), "{}[{},{}],[{},{}]", comma, crease[2], crease[1],
                   crease[4], crease[3]);
    fmt::format_to(std::back_inserter(edges_), "{}[{},{}]", comma, 2 * count_, 2 * count_ + 1);
    fmt::format_to(std::back_inserter(letters_), "{}\"{}\"", comma, letter);
    ++count_;
  }

  [[nodiscard]] Result<std::string> text() const {
    if (count_ == 0) return fail(ErrorKind::Malformed, "", "is a crease pattern without lines");
    return fmt::format(
        "{{\"file_spec\":1.1,\"vertices_coords\":[{}],\"edges_vertices\":[{}],"
        "\"edges_assignment\":[{}]}}",
        points_, edges_, letters_);
  }

 private:
  std::string points_, edges_, letters_;
  std::size_t count_{};
};

/// The next line that is no comment; empty at the end of `text`.
std::string_view next_line(std::string_view& text) {
  std::string_view line;
  do {
    text = trimmed(text);
    line = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(line.size());
  } while (is_comment(line));
  return line;
}

/// Whether the first line is a crease, or it is not right but most of the next ones are: a pattern
/// with one wrong line is one.
bool is_cp(std::string_view text) {
  constexpr int kLines = 8;
  const std::string_view first = next_line(text);
  if (is_crease(first)) return true;
  if (first.empty() || first[0] == '<' || first[0] == '{' || first[0] == '[') return false;
  int lines = 1, creases = 0;
  for (; lines < kLines; ++lines) {
    const std::string_view line = next_line(text);
    if (line.empty()) break;
    creases += is_crease(line) ? 1 : 0;
  }
  return 2 * creases > lines;
}

bool is_opx(std::string_view text) {
  const std::string_view head = trimmed(text.substr(0, 4096));
  return head.starts_with('<') && head.find("<java") != head.npos &&
         text.find("OriLineProxy") != text.npos;
}

Result<std::string> fold_of_cp(std::string_view text) {
  FoldText fold;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find_first_of("\r\n");
    const std::string_view whole = text.substr(0, end), line = trimmed(whole);
    const bool two = end != text.npos && text.substr(end).starts_with("\r\n");
    text.remove_prefix(end == text.npos ? text.size() : end + (two ? 2 : 1));
    if (line.empty() || is_comment(line)) continue;
    std::string_view wrong;
    const auto crease = crease_in(line, wrong);
    if (!crease)
      return fail(ErrorKind::Malformed,
                  fmt::format("line {}, column {}", number, wrong.data() - whole.data() + 1),
                  fmt::format("\"{}\" is not a line of a crease pattern; write its type (1 border, "
                              "2 mountain, 3 valley, 4 auxiliary) and x1 y1 x2 y2",
                              shown_ascii(line, 60)));
    fold.add(*crease);
  }
  return fold.text();
}

Result<std::string> fold_of_opx(std::string_view text) {
  if (text.size() > kMostOpxBytes)
    return tl::unexpected(
        too_much(fmt::format("the OPX has {} bytes; the limit is {}", text.size(), kMostOpxBytes)));
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    return fail(ErrorKind::Malformed, fmt::format("byte {}", parsed.offset),
                fmt::format("not XML: {}; is the file complete?", parsed.description()));
  FoldText fold;
  struct Lines : pugi::xml_tree_walker {
    explicit Lines(FoldText& into) : fold(into) {}
    bool for_each(pugi::xml_node& node) override {
      const std::string_view kind = node.attribute("class").value();
      if (std::string_view(node.name()) == "array" && kind.ends_with("OriLineProxy"))
        announced += node.attribute("length").as_uint();
      if (std::string_view(node.name()) != "object" || !kind.ends_with("OriLineProxy")) return true;
      Crease crease{};  // Java leaves out what is zero
      constexpr std::array<std::string_view, 5> kNames{"type", "x0", "y0", "x1", "y1"};
      for (const pugi::xml_node& property : node.children("void"))
        for (std::size_t i = 0; i < kNames.size(); ++i)
          if (kNames[i] == property.attribute("property").value())
            crease[i] = number_in(property.first_child().text().get());
      for (const double number : crease) sound = sound && std::isfinite(number);
      if (sound) fold.add(crease);
      ++lines;
      return sound;
    }
    FoldText& fold;
    std::uint64_t announced{}, lines{};
    bool sound{true};
  } lines(fold);
  document.traverse(lines);
  if (!lines.sound)
    return fail(ErrorKind::Malformed, "", "has a line whose type or place is not a number");
  if (lines.announced > lines.lines)
    return fail(ErrorKind::Malformed, "",
                fmt::format("announces {} lines and has {}; is the file complete?", lines.announced,
                            lines.lines));
  return fold.text();
}

}  // namespace

bool is_crease_pattern(std::string_view text) {
  std::string kept;
  text = plain_text(text, kept);
  return is_opx(text) || is_cp(text);
}

Result<std::string> fold_of_crease_pattern(std::string_view text) {
  std::string kept;
  text = plain_text(text, kept);
  return is_opx(text) ? fold_of_opx(text) : fold_of_cp(text);
}

}  // namespace popcut
