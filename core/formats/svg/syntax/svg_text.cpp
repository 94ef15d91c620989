// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_text.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/text/code_page.hpp"
#include "core/text/gzip.hpp"
#include "core/text/utf8.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostEntities = 64;
constexpr std::size_t kMostEntityBytes = 256;
constexpr std::string_view kXmlBlanks = " \t\r\n";
constexpr const char* kEntityRule =
    "use only plain <!ENTITY name \"text\"> and remove the rest of the DOCTYPE";

struct Entity {
  std::string name, value;
};

// The encoding that the XML declaration gives; empty: none.
std::string said_encoding(std::string_view text) {
  const std::string_view head = text.substr(0, std::min(text.find("?>"), std::size_t{200}));
  std::size_t at = head.find("encoding");
  if (!head.starts_with("<?xml") || at == head.npos) return {};
  at = head.find_first_of("\"'", at);
  if (at == head.npos) return {};
  const std::size_t end = head.find(head[at], at + 1);
  if (end == head.npos) return {};
  const std::string_view said = head.substr(at + 1, end - at - 1);
  return same_word(said, "utf-8") || same_word(said, "utf8") ? std::string() : std::string(said);
}

Result<void> to_utf8(std::string& text, std::size_t most_bytes) {
  const auto begins = [&](std::string_view bytes) {
    return std::string_view(text).substr(0, bytes.size()) == bytes;
  };
  if (is_gzip(text)) {
    auto plain = unpacked(text, most_bytes);
    if (!plain) return tl::unexpected(plain.error());
    text = std::move(*plain);
  }
  if (begins("\xFF\xFE") || begins(std::string_view("<\0", 2)))
    text = utf8_of_utf16(std::string_view(text).substr(text[0] == '<' ? 0 : 2), false);
  else if (begins("\xFE\xFF") || begins(std::string_view("\0<", 2)))
    text = utf8_of_utf16(std::string_view(text).substr(text[0] == '\0' ? 0 : 2), true);
  else if (begins("\xEF\xBB\xBF"))
    text.replace(0, 3, "   ");
  else if (const std::string code = said_encoding(text); !code.empty() && !is_utf8(text))
    if (auto converted = utf8_of_code_page(text, code)) {
      text = std::move(*converted);
      // Its lines keep their places, and nobody converts it once more.
      if (const std::size_t at = text.find(code); at != text.npos)
        text.replace(at, code.size(), "utf-8");
    }
  return {};
}

// Skips a comment, a processing instruction or CDATA that begins at `at`; npos: it does not end.
std::optional<std::size_t> past_marked(std::string_view text, std::size_t at) {
  constexpr std::pair<std::string_view, std::string_view> kMarked[]{
      {"<!--", "-->"}, {"<?", "?>"}, {"<![CDATA[", "]]>"}};
  for (const auto& [open, close] : kMarked) {
    if (text.substr(at, open.size()) != open) continue;
    const std::size_t end = text.find(close, at + open.size());
    return end == std::string_view::npos ? end : end + close.size();
  }
  return std::nullopt;
}

// Where the DOCTYPE begins, if there is one before the first element.
std::size_t find_doctype(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    at = text.find('<', at);
    if (at == std::string_view::npos || text.substr(at, 9) == "<!DOCTYPE") return at;
    const auto past = past_marked(text, at);
    if (!past) break;
    at = *past;
  }
  return std::string_view::npos;
}

// Whether a comment before the root names Adobe Illustrator, as "Generator: Adobe
// Illustrator 24.0".
bool is_by_illustrator(std::string_view text) {
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    const auto past = past_marked(text, at);
    if (!past || *past == std::string_view::npos) return false;
    const std::string_view comment = text.substr(at, *past - at);
    if (comment.starts_with("<!--") && comment.find("Adobe Illustrator") != std::string_view::npos)
      return true;
    at = *past;
  }
  return false;
}

// Reads the declarations of one DOCTYPE.
class DoctypeReader {
 public:
  DoctypeReader(std::string_view text, std::size_t at) : text_(text), at_(at + 9) {}

  /// Returns the position of the first byte after it.
  Result<std::size_t> read(std::vector<Entity>& entities) {
    char quote = 0;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        return at_ + 1;
      } else if (c == '[') {
        ++at_;
        if (auto done = subset(entities); !done) return tl::unexpected(done.error());
      } else if (c == '<') {
        break;
      }
    }
    return wrong("the DOCTYPE does not end; is the file complete?");
  }

 private:
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& detail,
                                            ErrorKind kind = ErrorKind::Malformed) const {
    const auto lines =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    return fail(kind, fmt::format("line {}", lines + 1), detail);
  }
  void blanks() { at_ = std::min(text_.find_first_not_of(kXmlBlanks, at_), text_.size()); }

  // Reads up to and including the closing bracket.
  Result<void> subset(std::vector<Entity>& entities) {
    while (true) {
      blanks();
      if (at_ >= text_.size()) return wrong("the DOCTYPE does not end; is the file complete?");
      if (text_[at_] == ']') return {};
      if (text_.substr(at_, 4) == "<!--") {
        at_ = std::min(*past_marked(text_, at_), text_.size());
      } else if (text_.substr(at_, 8) == "<!ENTITY") {
        at_ += 8;
        auto entity = declaration();
        if (!entity) return tl::unexpected(entity.error());
        if (entities.size() == kMostEntities)
          return wrong(
              fmt::format("the DOCTYPE declares more than {} entities; replace them by their "
                          "text",
                          kMostEntities),
              ErrorKind::OutOfRange);
        entities.push_back(std::move(*entity));
      } else if (text_.substr(at_, 9) == "<!ATTLIST" && names_only()) {
        continue;
      } else {
        return wrong(
            fmt::format("the DOCTYPE declares something other than an entity; {}", kEntityRule));
      }
    }
  }

  // Passes over a list of attributes that gives values to namespaces only: old drawings of Sodipodi
  // and Illustrator have it, and write the namespaces into the drawing, too.
  bool names_only() {
    const std::size_t end = text_.find('>', at_);
    if (end == std::string_view::npos) return false;
    const std::string_view list = text_.substr(at_, end - at_);
    for (std::size_t k = list.find_first_of("\"'"); k != std::string_view::npos;) {
      const std::size_t close = list.find(list[k], k + 1);
      // NAME CDATA #FIXED "VALUE", or without #FIXED
      std::string_view before = list.substr(0, k);
      for (const std::string_view word : {"#FIXED", "CDATA"}) {
        before = before.substr(0, before.find_last_not_of(kXmlBlanks) + 1);
        if (before.ends_with(word))
          before.remove_suffix(word.size());
        else if (word == "CDATA")
          return false;
      }
      before = before.substr(0, before.find_last_not_of(kXmlBlanks) + 1);
      if (close == std::string_view::npos ||
          !before.substr(before.find_last_of(kXmlBlanks) + 1).starts_with("xmlns"))
        return false;
      k = list.find_first_of("\"'", close + 1);
    }
    at_ = end + 1;
    return true;
  }

  Result<Entity> declaration() {
    blanks();
    Entity entity;
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n%\"'<>&;", at_), text_.size());
    entity.name = text_.substr(at_, end - at_);
    at_ = end;
    blanks();
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    if (entity.name.empty() || (quote != '"' && quote != '\''))
      return wrong(
          fmt::format("an entity of the DOCTYPE is a parameter or is in another file, "
                      "which popcut never fetches; {}",
                      kEntityRule));
    const std::size_t close = text_.find(quote, at_ + 1);
    if (close == std::string_view::npos)
      return wrong("the DOCTYPE does not end; is the file complete?");
    const std::string_view value = text_.substr(at_ + 1, close - at_ - 1);
    if (value.size() > kMostEntityBytes)
      return wrong(fmt::format("the entity {} has {} bytes, but the limit is {}; replace it by its "
                               "text",
                               entity.name.substr(0, 40), value.size(), kMostEntityBytes),
                   ErrorKind::OutOfRange);
    if (value.find_first_of("&<") != std::string_view::npos)
      return wrong(fmt::format("the entity {} is not plain text; {}", entity.name.substr(0, 40),
                               kEntityRule));
    for (const char c : value) {
      if (c == '"')
        entity.value += "&quot;";
      else if (c == '\'')
        entity.value += "&apos;";
      else
        entity.value += c == '\n' || c == '\r' ? ' ' : c;  // keep the line count
    }
    at_ = close + 1;
    blanks();
    if (at_ >= text_.size() || text_[at_] != '>')
      return wrong(fmt::format("the entity {} is not plain text; {}", entity.name.substr(0, 40),
                               kEntityRule));
    ++at_;
    return entity;
  }

  std::string_view text_;
  std::size_t at_;
};

Result<std::string> with_entities(std::string_view text, std::size_t from,
                                  const std::vector<Entity>& entities, std::size_t most_bytes) {
  std::string out(text.substr(0, from));
  out.reserve(text.size() + 1024);
  for (std::size_t at = from; at < text.size();) {
    const std::size_t next = std::min(text.find_first_of("&<", at), text.size());
    out += text.substr(at, next - at);
    if (out.size() > most_bytes)
      return fail(
          ErrorKind::OutOfRange, "",
          fmt::format("more than {} bytes of SVG after replacing its entities; write a smaller "
                      "file",
                      most_bytes));
    at = next;
    if (at == text.size()) break;
    if (text[at] == '<') {
      const std::size_t past = std::min(past_marked(text, at).value_or(at + 1), text.size());
      out += text.substr(at, past - at);
      at = past;
      continue;
    }
    const std::string_view after = text.substr(at + 1, 256);
    const std::string_view name = after.substr(0, std::min(after.find(';'), after.size()));
    const auto entity = std::find_if(entities.begin(), entities.end(),
                                     [&](const Entity& e) { return e.name == name; });
    if (entity == entities.end()) {
      out += text[at++];
    } else {
      out += entity->value;
      at += name.size() + 2;
    }
  }
  return out;
}

Result<void> remove_doctype(SvgText& svg, const SvgLimits& limits) {
  const std::size_t at = find_doctype(svg.text);
  const std::size_t prolog = std::min(at, svg.text.size());
  svg.has_foreign_sheet =
      std::string_view(svg.text).substr(0, prolog).find("<?xml-stylesheet") != std::string::npos;
  if (at == std::string::npos) return {};
  std::vector<Entity> entities;
  const auto end = DoctypeReader(svg.text, at).read(entities);
  if (!end) return tl::unexpected(end.error());
  svg.has_foreign_sheet =
      svg.has_foreign_sheet || svg.text.find("<?xml-stylesheet", *end) != std::string::npos;
  for (std::size_t i = at; i < *end; ++i)
    if (svg.text[i] != '\n') svg.text[i] = ' ';
  if (entities.empty()) return {};
  auto text = with_entities(svg.text, *end, entities, limits.bytes);
  if (!text) return tl::unexpected(text.error());
  svg.text = std::move(*text);
  return {};
}

// Memory that the tree will take: pugixml uses 64 bytes per node and 40 per attribute.
std::size_t tree_bytes(std::string_view text) {
  std::size_t nodes = 0;
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at + 1)) {
    if (at + 1 < text.size() && text[at + 1] != '/') ++nodes;
    if (at > 0 && text[at - 1] != '>' && static_cast<unsigned char>(text[at - 1]) > ' ') ++nodes;
  }
  const auto attributes = static_cast<std::size_t>(std::count(text.begin(), text.end(), '='));
  return 64 * nodes + 40 * attributes;
}

}  // namespace

SvgLimits SvgLimits::raised(unsigned factor) const {
  SvgLimits out = *this;
  out.bytes = std::min<std::size_t>(bytes * factor, 0xFFFF'FFFFu);
  out.tree_bytes = tree_bytes * factor;
  out.points = std::min<std::size_t>(points * factor, 0x7FFF'FFFFu);
  out.steps = steps * factor;
  return out;
}

Result<SvgText> prepare_svg_text(std::string text, const SvgLimits& limits) {
  if (text.size() > limits.bytes)
    return tl::unexpected(
        too_much(fmt::format("the SVG has {} bytes; the limit is {}", text.size(), limits.bytes)));
  SvgText svg;
  svg.text = std::move(text);
  if (auto done = to_utf8(svg.text, limits.bytes); !done) return tl::unexpected(done.error());
  const std::size_t nul = svg.text.find('\0');
  if (nul != std::string::npos)
    return fail(
        ErrorKind::Malformed, "",
        fmt::format("byte {} is zero, which text never contains; is this an SVG file?", nul + 1));
  if (auto done = remove_doctype(svg, limits); !done) return tl::unexpected(done.error());
  svg.by_illustrator = is_by_illustrator(svg.text);
  const auto newlines =
      static_cast<std::size_t>(std::count(svg.text.begin(), svg.text.end(), '\n'));
  const std::size_t need = tree_bytes(svg.text) + 4 * newlines;
  if (need > limits.tree_bytes)
    return tl::unexpected(
        too_much(fmt::format("its elements would take {} MB of memory; the limit is {}", need >> 20,
                             limits.tree_bytes >> 20)));
  svg.lines.reserve(newlines);
  for (std::size_t at = svg.text.find('\n'); at < svg.text.size(); at = svg.text.find('\n', at + 1))
    svg.lines.push_back(static_cast<std::uint32_t>(at + 1));
  return svg;
}

std::size_t svg_line(const SvgText& text, std::ptrdiff_t offset) {
  const auto after = std::upper_bound(
      text.lines.begin(), text.lines.end(), offset,
      [](std::ptrdiff_t a, std::uint32_t b) { return a < static_cast<std::ptrdiff_t>(b); });
  return 1 + static_cast<std::size_t>(after - text.lines.begin());
}

std::string svg_place(const SvgText& text, std::ptrdiff_t offset) {
  offset = std::max<std::ptrdiff_t>(offset, 0);
  const std::size_t line = svg_line(text, offset);
  const std::ptrdiff_t begin = line < 2 ? 0 : static_cast<std::ptrdiff_t>(text.lines[line - 2]);
  return fmt::format("line {}, column {}", line, offset - begin + 1);
}

}  // namespace popcut
