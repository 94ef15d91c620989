// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_css.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_scan.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

namespace popcut {
namespace {

constexpr std::size_t kNone = std::string_view::npos;
constexpr int kMostNested = 8;          // blocks in blocks
constexpr std::size_t kMostParts = 32;  // of one selector

bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

// The first of `ends` from `at` on, outside quotes and brackets; the size if there is none.
std::size_t find_outside(std::string_view text, std::size_t at, std::string_view ends) {
  int round = 0, square = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '\\') {
      ++at;
    } else if (c == '"' || c == '\'') {
      at = std::min(text.find(c, at + 1), text.size());
    } else if (round == 0 && square == 0 && ends.find(c) != kNone) {
      return at;
    } else if (c == '(') {
      ++round;
    } else if (c == ')') {
      round = std::max(round - 1, 0);
    } else if (c == '[') {
      ++square;
    } else if (c == ']') {
      square = std::max(square - 1, 0);
    }
  }
  return text.size();
}

// The position after the brace that closes the one before `at`.
std::size_t past_block(std::string_view text, std::size_t at) {
  for (int depth = 1; at < text.size();) {
    at = find_outside(text, at, "{}");
    if (at == text.size()) break;
    depth += text[at] == '{' ? 1 : -1;
    ++at;
    if (depth == 0) return at;
  }
  return text.size();
}

bool holds(const CssAttribute& test, const pugi::xml_node& node) {
  std::optional<std::string_view> found;
  for (const pugi::xml_attribute& attribute : node.attributes())
    if (attribute.name() == test.name) found = attribute.value();
  if (!found) return false;
  const std::string_view v = *found, w = test.value;
  switch (test.test) {
    case 0:
      return true;
    case '~':
      return has_word(v, w);
    case '|':
      return v == w || (v.substr(0, w.size()) == w && v.size() > w.size() && v[w.size()] == '-');
    case '^':
      return !w.empty() && v.substr(0, w.size()) == w;
    case '$':
      return !w.empty() && v.size() >= w.size() && v.substr(v.size() - w.size()) == w;
    case '*':
      return !w.empty() && v.find(w) != kNone;
    default:
      return v == w;
  }
}

std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return name.substr(name.rfind(':') + 1);
}

// Whether `node` is what a part of a selector says; of its classes those from `from` on are looked
// for. What is read of long lists of classes counts as steps.
bool is_that(const CssCompound& part, const pugi::xml_node& node, std::size_t from,
             std::size_t& steps) {
  if (part.is_root && node.parent().type() != pugi::node_document) return false;
  if (!part.type.empty() && local_name(node) != part.type) return false;
  if (!part.id.empty() && node.attribute("id").value() != part.id) return false;
  if (from < part.classes.size()) {
    constexpr std::size_t kBytesInStep = 64;
    const std::string_view classes = node.attribute("class").value();
    for (std::size_t k = from; k < part.classes.size(); ++k) {
      steps -= std::min(steps, classes.size() / kBytesInStep);
      if (steps == 0 || !has_word(classes, part.classes[k])) return false;
    }
  }
  return std::all_of(part.attributes.begin(), part.attributes.end(),
                     [&](const CssAttribute& test) { return holds(test, node); });
}

// Whether parts 0 .. `count` - 1 match, the last of them `node`, of which the first `known` classes
// do. Without steps left: no.
bool fits(const CssRule& rule, std::size_t count, pugi::xml_node node, std::size_t known,
          std::size_t& steps) {
  if (steps == 0 || !is_that(rule.parts[count - 1], node, known, steps) || steps == 0) return false;
  --steps;
  if (count == 1) return true;
  const bool child = rule.parts[count - 2].child;
  for (node = node.parent(); node.type() == pugi::node_element; node = node.parent()) {
    if (fits(rule, count - 1, node, 0, steps)) return true;
    if (child || steps == 0) return false;
    --steps;
  }
  return false;
}

// Whether a list of media names screens: "all", "screen, print", "only screen", "not print".
bool is_for_screens(std::string_view list) {
  if (list.empty()) return true;
  while (!list.empty()) {
    std::string_view one = trimmed(take_word(list, ","));
    const std::string_view all = one, first = take_word(one, kBlanks);
    const bool is_not = same_word(first, "not");
    const std::string_view medium = is_not || same_word(first, "only") ? trimmed(one) : all;
    if (std::any_of(medium.begin(), medium.end(), [](char c) { return !is_name(c); })) continue;
    if ((same_word(medium, "all") || same_word(medium, "screen")) != is_not) return true;
  }
  return false;
}

// Reads one selector from left to right.
class SelectorReader {
 public:
  enum class Outcome { Known, Never, Unknown };
  SelectorReader(std::string_view text, std::deque<std::string>& texts)
      : text_(trimmed(text)), texts_(texts) {}

  Outcome read(CssRule& rule) {
    if (text_.empty()) return Outcome::Unknown;
    while (at_ < text_.size()) {
      CssCompound part;
      const std::size_t from = at_;
      while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '>')
        if (!simple(part, rule)) return Outcome::Unknown;
      if (at_ == from || rule.parts.size() == kMostParts) return Outcome::Unknown;
      while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '>')) {
        if (text_[at_] == '>' && part.child) return Outcome::Unknown;
        part.child = part.child || text_[at_] == '>';
        ++at_;
      }
      if (part.child && at_ == text_.size()) return Outcome::Unknown;
      rule.parts.push_back(std::move(part));
    }
    return never_ ? Outcome::Never : Outcome::Known;
  }

 private:
  // A name with its escapes resolved.
  std::string_view name() {
    const std::size_t from = at_;
    while (at_ < text_.size() && is_name(text_[at_])) ++at_;
    if (at_ >= text_.size() || text_[at_] != '\\') return text_.substr(from, at_ - from);
    std::string plain(text_.substr(from, at_ - from));
    while (at_ < text_.size() && (is_name(text_[at_]) || text_[at_] == '\\')) {
      if (text_[at_] != '\\')
        plain += text_[at_++];
      else if (++at_ < text_.size())
        plain += escaped();
    }
    texts_.push_back(std::move(plain));
    return texts_.back();
  }
  // The character after a backslash: up to six hexadecimal digits and a space, or the character
  // itself.
  char escaped() {
    const auto digit = [](char c) {
      if (c >= '0' && c <= '9') return c - '0';
      if (c >= 'a' && c <= 'f') return c - 'a' + 10;
      return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
    };
    if (digit(text_[at_]) < 0) return text_[at_++];
    int value = 0;
    for (int n = 0; n < 6 && at_ < text_.size() && digit(text_[at_]) >= 0; ++n)
      value = value * 16 + digit(text_[at_++]);
    if (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    return value > 0 && value < 128 ? static_cast<char>(value) : '?';
  }

  bool simple(CssCompound& part, CssRule& rule) {
    const char c = text_[at_];
    if (c == '*' || c == '|') {
      ++at_;
      return true;
    }
    if (c == '#' || c == '.') {
      ++at_;
      const std::string_view word = name();
      if (word.empty()) return false;
      rule.specificity += c == '#' ? 1u << 20 : 1u << 10;
      if (c == '.')
        part.classes.push_back(word);
      else if (part.id.empty() || part.id == word)
        part.id = word;
      else
        never_ = true;
      return true;
    }
    if (c == '[') return attribute(part, rule);
    if (c == ':') return pseudo(part, rule);
    const std::string_view word = name();
    if (word.empty()) return false;
    if (at_ < text_.size() && text_[at_] == '|') return true;  // a namespace
    part.type = word;
    rule.specificity += 1;
    return true;
  }

  bool attribute(CssCompound& part, CssRule& rule) {
    const std::size_t end = text_.find(']', at_);
    if (end == kNone) return false;
    const std::string_view whole = text_;
    text_ = text_.substr(0, end);
    ++at_;
    CssAttribute test;
    test.name = trimmed_name();
    std::string_view rest = trimmed(text_.substr(std::min(at_, text_.size())));
    if (!rest.empty()) {
      test.test = rest[0];
      const std::size_t equals = test.test == '=' ? 0 : 1;
      if (std::string_view("=~|^$*").find(test.test) == kNone || rest.size() <= equals ||
          rest[equals] != '=')
        return false;
      rest = trimmed(rest.substr(equals + 1));
      if (rest.size() >= 2 && (rest[0] == '"' || rest[0] == '\'') && rest.back() == rest[0])
        rest = rest.substr(1, rest.size() - 2);
      test.value = rest;
    }
    text_ = whole;
    at_ = end + 1;
    rule.specificity += 1u << 10;
    part.attributes.push_back(test);
    return !test.name.empty();
  }
  std::string_view trimmed_name() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    return name();
  }

  // Pseudo-classes for interaction (:hover) never match on paper.
  bool pseudo(CssCompound& part, CssRule& rule) {
    ++at_;
    const std::string_view word = name();
    rule.specificity += 1u << 10;
    if (word == "root") {
      part.is_root = true;
      return true;
    }
    for (const std::string_view hand : {"hover", "active", "focus", "visited", "target"})
      if (word == hand) return never_ = true;
    return false;
  }

  std::string_view text_;
  std::deque<std::string>& texts_;
  std::size_t at_{};
  bool never_{false};
};

}  // namespace

bool next_declaration(std::string_view& rest, CssDeclaration& out) {
  while (!rest.empty()) {
    const std::size_t end = find_outside(rest, 0, ";");
    const std::string_view one = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t colon = one.find(':');
    if (colon == kNone) continue;
    out = {trimmed(one.substr(0, colon)), trimmed(one.substr(colon + 1)), false};
    const std::size_t mark = out.value.rfind('!');
    if (mark != kNone && same_word(trimmed(out.value.substr(mark + 1)), "important")) {
      out.value = trimmed(out.value.substr(0, mark));
      out.important = true;
    }
    if (!out.name.empty() && !out.value.empty()) return true;
  }
  return false;
}

std::string without_css_comments(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (true) {
    const std::size_t open = text.find("/*");
    out += text.substr(0, open);
    if (open == kNone) return out;
    out += ' ';
    const std::size_t close = text.find("*/", open + 2);
    if (close == kNone) return out;
    text.remove_prefix(close + 2);
  }
}

class CssSheetReader {
 public:
  explicit CssSheetReader(CssSheets& sheets) : sheets_(sheets) {}

  Result<void> read(std::string_view text, int depth) {
    for (std::size_t at = 0; at < text.size();) {
      if (is_blank(text[at]) || text[at] == '}' || text[at] == ';') {
        ++at;
        continue;
      }
      if (text.substr(at, 4) == "<!--" || text.substr(at, 3) == "-->") {
        at += text[at] == '<' ? 4 : 3;
        continue;
      }
      const std::size_t open = find_outside(text, at, text[at] == '@' ? "{;" : "{");
      const std::string_view head = trimmed(text.substr(at, open - at));
      const bool has_block = open < text.size() && text[open] == '{';
      at = has_block ? past_block(text, open + 1) : std::min(open + 1, text.size());
      std::string_view block;
      if (has_block) block = text.substr(open + 1, at - open - 1);
      if (!block.empty() && block.back() == '}') block.remove_suffix(1);
      if (auto done = head[0] == '@' ? at_rule(head, block, depth) : rules(head, block); !done)
        return done;
      // Rules in rules.
      if (head[0] != '@' && find_outside(block, 0, "{") < block.size())
        unknown(sheets_.unknown_selectors_, head);
    }
    return {};
  }

 private:
  void unknown(std::size_t& count, std::string_view what) {
    ++count;
    if (sheets_.first_unknown_.empty()) sheets_.first_unknown_ = what.substr(0, 60);
  }

  Result<void> at_rule(std::string_view head, std::string_view block, int depth) {
    const std::string_view name =
        head.substr(0, std::min(head.find_first_of(" \t\r\n\f(\"'"), head.size()));
    const std::string_view rest = trimmed(head.substr(name.size()));
    for (const std::string_view harmless :
         {"@charset", "@namespace", "@font-face", "@keyframes", "@page", "@-webkit-keyframes"})
      if (same_word(name, harmless)) return {};
    if (same_word(name, "@import")) {
      ++sheets_.imports_;
      return {};
    }
    if (same_word(name, "@media") && depth < kMostNested && is_for_screens(rest))
      return read(block, depth + 1);
    unknown(sheets_.unknown_blocks_, head);
    return {};
  }

  Result<void> rules(std::string_view selectors, std::string_view declarations) {
    for (std::size_t at = 0; at < selectors.size();) {
      const std::size_t end = find_outside(selectors, at, ",");
      const std::string_view one = selectors.substr(at, end - at);
      at = end + 1;
      CssRule rule;
      rule.declarations = declarations;
      switch (SelectorReader(one, sheets_.texts_).read(rule)) {
        case SelectorReader::Outcome::Unknown:
          unknown(sheets_.unknown_selectors_, trimmed(one));
          break;
        case SelectorReader::Outcome::Never:
          break;
        case SelectorReader::Outcome::Known:
          if (sheets_.rules_.size() == CssSheets::kMostSelectors)
            return fail(ErrorKind::OutOfRange, "",
                        fmt::format("the style sheets have more than {} selectors; write the "
                                    "styles as attributes",
                                    CssSheets::kMostSelectors));
          enter(std::move(rule));
      }
    }
    return {};
  }

  void enter(CssRule rule) {
    const auto index = static_cast<std::uint32_t>(sheets_.rules_.size());
    const CssCompound& last = rule.parts.back();
    CssSheets::Bucket& bucket = !last.id.empty()        ? sheets_.by_id_[last.id]
                                : !last.classes.empty() ? sheets_.by_class_[last.classes[0]]
                                : !last.type.empty()    ? sheets_.by_type_[last.type]
                                                        : sheets_.others_;
    bucket.push_back(index);
    sheets_.rules_.push_back(std::move(rule));
  }

  CssSheets& sheets_;
};

Result<void> CssSheets::add(std::string_view text) {
  texts_.push_back(without_css_comments(text));
  return CssSheetReader(*this).read(texts_.back(), 0);
}

bool CssSheets::find(const pugi::xml_node& node, std::string_view type, std::string_view id,
                     std::string_view classes, std::size_t& steps,
                     std::vector<const CssRule*>& found) const {
  const std::size_t first = found.size();
  const auto try_bucket = [&](const Bucket& bucket, std::size_t known = 0) {
    for (const std::uint32_t index : bucket) {
      if (steps == 0) return;
      --steps;
      if (fits(rules_[index], rules_[index].parts.size(), node, known, steps))
        found.push_back(&rules_[index]);
    }
  };
  const auto try_key = [&](const auto& buckets, std::string_view key, std::size_t known = 0) {
    if (const auto bucket = buckets.find(key); bucket != buckets.end())
      try_bucket(bucket->second, known);
  };
  if (!id.empty()) try_key(by_id_, id);
  while (!classes.empty() && !by_class_.empty()) {
    if (const std::string_view one = take_word(classes, kBlanks); !one.empty())
      try_key(by_class_, one, 1);
    if (steps == 0) return false;
    --steps;
  }
  try_key(by_type_, type);
  try_bucket(others_);
  const auto from = found.begin() + static_cast<std::ptrdiff_t>(first);
  // Rules are in the order of the sheets, so their addresses break ties. An element that names a
  // class twice finds its rules twice, which has no effect.
  std::sort(from, found.end(), [](const CssRule* a, const CssRule* b) {
    return a->specificity != b->specificity ? a->specificity < b->specificity : a < b;
  });
  return steps > 0;
}

}  // namespace popcut
