// SPDX-License-Identifier: MIT
#include "core/formats/dxf/dxf_tables.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/text/code_page.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostElements = 64;  // of one line type

struct Unit {
  const char* name;
  double mm;
};

// $INSUNITS, by number (DXF reference, header variables); 0 is no unit.
constexpr std::array<Unit, 25> kUnits{{{"", 0.0},
                                       {"inch", 25.4},
                                       {"foot", 304.8},
                                       {"mile", 1609344.0},
                                       {"mm", 1.0},
                                       {"cm", 10.0},
                                       {"m", 1000.0},
                                       {"km", 1e6},
                                       {"microinch", 25.4e-6},
                                       {"mil", 25.4e-3},
                                       {"yard", 914.4},
                                       {"angstrom", 1e-7},
                                       {"nm", 1e-6},
                                       {"um", 1e-3},
                                       {"dm", 100.0},
                                       {"dam", 1e4},
                                       {"hm", 1e5},
                                       {"Gm", 1e12},
                                       {"astronomical unit", 1.495978707e14},
                                       {"light year", 9.4607304725808e18},
                                       {"parsec", 3.0856775814914e19},
                                       {"US survey foot", 1200000.0 / 3937},
                                       {"US survey inch", 100000.0 / 3937},
                                       {"US survey yard", 3600000.0 / 3937},
                                       {"US survey mile", 6336000000.0 / 3937}}};

// Bytes 0x80 to 0x9f of Windows-1252; the others are those of Unicode.
constexpr std::array<std::uint16_t, 32> kWindows{
    0x20ac, '?',    0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, '?',    0x017d, '?',    '?',    0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, '?',    0x017e, 0x0178};

/// The character at the start of `text` that is written as "\\M+n" and four hexadecimal digits: two
/// bytes in a code page of East Asia.
///
/// @return as UTF-8; none if there is no such character
std::optional<std::string> character_of_page(std::string_view text) {
  constexpr std::array kPages{"ANSI_932", "ANSI_950", "ANSI_949", "ANSI_1361", "ANSI_936"};
  constexpr std::string_view kBegin = "\\M+";
  std::uint32_t code = 0;
  const std::string_view digits = text.substr(0, 8).substr(std::min(text.size(), kBegin.size()));
  const auto page = static_cast<std::size_t>(digits.empty() ? 0 : digits[0] - '0');
  if (!text.starts_with(kBegin) || digits.size() != 5 || page < 1 || page > kPages.size() ||
      std::from_chars(digits.data() + 1, digits.data() + 5, code, 16).ptr != digits.data() + 5)
    return std::nullopt;
  const std::array bytes{static_cast<char>(code >> 8), static_cast<char>(code & 0xff)};
  return utf8_of_code_page({bytes.data(), bytes.size()}, kPages.at(page - 1));
}

class TableReader {
 public:
  explicit TableReader(std::string_view text) : cursor_(text) {}

  Result<DxfTables> read() {
    bool sections = false, ended = false;
    while (cursor_.next()) {
      const DxfGroup& group = cursor_.group();
      if (group.is(0, "EOF")) {
        ended = true;
        break;
      }
      if (!group.is(0, "SECTION")) {
        if (!sections || group.code == 0)
          return wrong(
              fmt::format("\"{}\" is outside of any section; expected 0 SECTION; is "
                          "this a DXF file?",
                          dxf_shown(group.value)));
        continue;
      }
      sections = true;
      if (!section()) return fault();
    }
    if (cursor_.error()) return tl::unexpected(*cursor_.error());
    if (!sections)
      return fail(ErrorKind::Malformed, dxf_line(1),
                  "this is not a DXF file: it has no section (0 SECTION)");
    if (tables_.entities.empty())
      return fail(ErrorKind::Malformed, dxf_line(cursor_.group().line),
                  "there is no ENTITIES section; is the file complete?");
    if (!ended)
      tables_.warnings.push_back(
          {.code = "no_eof",
           .message = "the file does not end with EOF, but all its sections are complete"});
    settle_unit();
    if (clips_ > 0)
      tables_.warnings.push_back(
          {.code = "block_clipped",
           .message = fmt::format("{} clipped (XCLIP), and cut whole; explode and trim {}",
                                  clips_ == 1 ? "1 insert of a block is"
                                              : fmt::format("{} inserts of blocks are", clips_),
                                  clips_ == 1 ? "it" : "them"),
           .spoils = true});
    return std::move(tables_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> wrong(std::string detail,
                                            ErrorKind kind = ErrorKind::Malformed) const {
    return fail(kind, dxf_line(cursor_.group().line), std::move(detail));
  }

  bool stop(std::string detail, ErrorKind kind = ErrorKind::Malformed) {
    if (!error_) error_ = Error{kind, dxf_line(cursor_.group().line), std::move(detail)};
    return false;
  }

  [[nodiscard]] tl::unexpected<Error> fault() const {
    return tl::unexpected<Error>(cursor_.error() ? *cursor_.error() : *error_);
  }

  bool section() {
    if (!cursor_.next() || cursor_.group().code != 2)
      return stop("a section must begin with its name (group code 2)");
    const std::string name(dxf_key(cursor_.group().value));
    if (name == "ENTITIES") tables_.entities.push_back(cursor_);
    bool ended = false;
    more_ = cursor_.next();
    while (more_ && !ended) {
      const DxfGroup& group = cursor_.group();
      if (group.is(0, "SECTION") || group.is(0, "EOF")) break;
      ended = group.is(0, "ENDSEC") && !(name == "HEADER" && goes_on());
      const bool named = group.is(0, "LAYER") || group.is(0, "LTYPE");
      if (name == "TABLES" && named) {
        if (!record(group.value == "LAYER")) return false;
        continue;  // the cursor is at the group 0 after it
      }
      if (name == "HEADER" && group.code == 9 && !variable()) return false;
      if (name == "BLOCKS" && group.is(0, "BLOCK") && !block()) return false;
      if (name == "OBJECTS" && group.is(0, "SPATIAL_FILTER")) ++clips_;
      more_ = ended || cursor_.next();
    }
    if (cursor_.error()) return false;
    return ended ||
           stop(fmt::format("the section {} does not end (0 ENDSEC); is the file complete?",
                            dxf_shown(name)));
  }

  /// Whether variables follow: dxflib 2.0 writes an ENDSEC into the midst of them.
  [[nodiscard]] bool goes_on() const {
    DxfCursor after = cursor_;
    return after.next() && after.group().code == 9;
  }

  bool variable() {
    const std::string_view name = cursor_.group().value;
    const bool integer = name == "$INSUNITS" || name == "$MEASUREMENT";
    const bool page = name == "$DWGCODEPAGE";
    if (!integer && !page && name != "$LTSCALE") return true;
    if (!cursor_.next()) return true;  // the caller reports the missing end
    if (page) {
      const std::string code = dxf_key(cursor_.group().value.substr(0, 40));
      tables_.foreign_names = code.starts_with("ANSI_") && code != "ANSI_1252";
      return true;
    }
    if (name == "$INSUNITS") return cursor_.integer(insunits_.emplace());
    if (name == "$MEASUREMENT") return cursor_.integer(measurement_.emplace());
    double scale = 1.0;
    if (!cursor_.real(scale)) return false;
    if (scale > 1e-9 && scale < 1e9) tables_.linetype_scale = scale;
    return true;
  }

  /// Reads the LAYER or LTYPE that begins here; the cursor ends at the group 0 after it.
  bool record(bool is_layer) {
    std::string key;
    DxfLayer one;
    DxfLinetype dashes;
    bool transparency = false;  // it comes as attached data
    while ((more_ = cursor_.next()) && cursor_.group().code != 0) {
      const DxfGroup& group = cursor_.group();
      int number = 0;
      double real = 0.0;
      if (group.code == 2) {
        key = dxf_key(group.value.substr(0, 1024));
        one.name = dxf_name(group.value);
      } else if (is_layer && group.code == 6) {
        one.linetype = dxf_key(group.value.substr(0, 1024));
      } else if (is_layer && (group.code == 70 || group.code == 62 || group.code == 290)) {
        if (!cursor_.integer(number)) return false;
        if (group.code == 70) one.frozen = (number & 1) != 0;
        if (group.code == 62)
          one.off = number < 0, one.colour = number < -256 ? 7 : std::abs(number);
        if (group.code == 290) one.unplotted = one.unplotted || number == 0;
      } else if (is_layer && group.code == 420) {
        if (!cursor_.integer(number)) return false;
        one.rgb = number & 0xffffff;
      } else if (is_layer && group.code == 1001) {
        transparency = group.value == "AcCmTransparency";
      } else if (transparency && group.code == 1071) {
        if (!cursor_.integer(number)) return false;
        one.unplotted = one.unplotted || is_dxf_transparent(number);
      } else if (!is_layer && group.code == 49) {
        if (!cursor_.real(real)) return false;
        if (dashes.elements.size() < kMostElements) dashes.elements.push_back(real);
      }
    }
    if (is_layer)
      tables_.layers.try_emplace(std::move(key), std::move(one));
    else
      tables_.linetypes.try_emplace(std::move(key), std::move(dashes));
    if (tables_.layers.size() > kMostDxfNames || tables_.linetypes.size() > kMostDxfNames)
      return stop(fmt::format("more than {} layers or line types", kMostDxfNames),
                  ErrorKind::OutOfRange);
    return !cursor_.error();
  }

  /// Moves to the ENDBLK of the block that begins here.
  bool block() {
    std::string key;
    DxfBlock one{{}, {}, cursor_, false};
    while (cursor_.next() && cursor_.group().code != 0) {
      int flags = 0;
      switch (cursor_.group().code) {
        case 2:
          key = dxf_key(cursor_.group().value.substr(0, 1024));
          one.name = dxf_name(cursor_.group().value);
          break;
        case 10:
        case 20:
        case 30:
          if (!cursor_.real(one.base[cursor_.group().code / 10 - 1])) return false;
          break;
        case 70:
          if (!cursor_.integer(flags)) return false;
          one.external = (flags & (4 | 8)) != 0;  // another file, or an overlay of it
          break;
        default:
          break;
      }
    }
    // The block's cursor is at the beginning of the block; the reader of entities skips its first
    // groups.
    while (!cursor_.group().is(0, "ENDBLK")) {
      if (cursor_.group().is(0, "ENDSEC") || cursor_.group().is(0, "BLOCK"))
        return stop(fmt::format("the block \"{}\" does not end (0 ENDBLK)", dxf_shown(key)));
      if (!cursor_.next())
        return cursor_.error() ? false
                               : stop("a block does not end (0 ENDBLK); is the file complete?");
    }
    tables_.blocks.try_emplace(std::move(key), std::move(one));
    return tables_.blocks.size() <= kMostDxfNames ||
           stop(fmt::format("more than {} blocks", kMostDxfNames), ErrorKind::OutOfRange);
  }

  void settle_unit() {
    const int code = insunits_.value_or(0);
    if (code >= 1 && code < static_cast<int>(kUnits.size())) {
      const Unit& unit = kUnits.at(static_cast<std::size_t>(code));
      tables_.unit_mm = unit.mm;
      tables_.unit_name = unit.name;
      return;
    }
    const bool inch = measurement_ == 0;
    if (inch) tables_.unit_mm = 25.4, tables_.unit_name = "inch";
    tables_.warnings.push_back(
        {.code = "no_unit",
         .message =
             fmt::format("the file gives no unit of length ($INSUNITS); 1 unit is read as 1 {}{}",
                         tables_.unit_name, inch ? " ($MEASUREMENT is English)" : ""),
         .spoils = true});
  }

  DxfCursor cursor_;
  DxfTables tables_;
  bool more_{false};  ///< `cursor_` is on a group
  std::optional<int> insunits_, measurement_;
  std::size_t clips_{};  ///< of blocks
  std::optional<Error> error_;
};

}  // namespace

namespace {

/// A name with all its characters as UTF-8.
std::string decoded(std::string_view name) {
  std::string shown;
  for (std::size_t i = 0; i < name.size();) {
    // How ASCII files of AutoCAD write other characters.
    std::uint32_t code = 0;
    const std::string_view digits = name.substr(i).starts_with("\\U+") ? name.substr(i + 3, 4) : "";
    if (digits.size() == 4 &&
        std::from_chars(digits.data(), digits.data() + 4, code, 16).ptr == digits.data() + 4 &&
        code >= 0x20 && (code < 0xD800 || code >= 0xE000)) {
      append_utf8(shown, code);
      i += 7;
      continue;
    }
    if (const auto character = character_of_page(name.substr(i))) {
      shown += *character;
      i += 8;
      continue;
    }
    const std::size_t n = std::max<std::size_t>(code_point(name, i).length, 1);
    const unsigned c = static_cast<unsigned char>(name[i]);
    if (n > 1)
      shown += name.substr(i, n);
    else if (c >= 0x80)
      append_utf8(shown, c < 0xa0 ? kWindows.at(c - 0x80) : c);
    else
      shown += c < 0x20 || c == 0x7f ? '?' : name[i];
    i += n;
  }
  return shown;
}

/// A letter in lower case (Unicode's simple case folding, of the scripts in which layers are named:
/// Latin, Greek, Cyrillic, Armenian, wide letters); other characters as they are.
std::uint32_t lower_case(std::uint32_t c) {
  // Capitals from first to last; a step of 1 leads to the small letter beside each of every two.
  struct Capitals {
    std::uint32_t first, last, step;
  };
  static constexpr std::array<Capitals, 24> kCapitals{
      {{'A', 'Z', 32},     {0xC0, 0xD6, 32},   {0xD8, 0xDE, 32},   {0x100, 0x12F, 1},
       {0x132, 0x137, 1},  {0x139, 0x148, 1},  {0x14A, 0x177, 1},  {0x179, 0x17E, 1},
       {0x1A0, 0x1A5, 1},  {0x1AF, 0x1B0, 1},  {0x1CD, 0x1DC, 1},  {0x1DE, 0x1EF, 1},
       {0x1F8, 0x21F, 1},  {0x222, 0x233, 1},  {0x388, 0x38A, 37}, {0x391, 0x3AB, 32},
       {0x400, 0x40F, 80}, {0x410, 0x42F, 32}, {0x460, 0x481, 1},  {0x48A, 0x4BF, 1},
       {0x4C1, 0x4CE, 1},  {0x4D0, 0x52F, 1},  {0x531, 0x556, 48}, {0x1E00, 0x1E95, 1}}};
  static constexpr std::array<std::pair<std::uint32_t, std::uint32_t>, 7> kOthers{{{0x178, 0xFF},
                                                                                   {0x386, 0x3AC},
                                                                                   {0x38C, 0x3CC},
                                                                                   {0x38E, 0x3CD},
                                                                                   {0x38F, 0x3CE},
                                                                                   {0x3C2, 0x3C3},
                                                                                   {0x1E9E, 0xDF}}};
  for (const auto& [first, last, step] : kCapitals)
    if (c >= first && c <= last) return step > 1 || (c - first) % 2 == 0 ? c + step : c;
  for (const auto& [capital, small] : kOthers)
    if (c == capital) return small;
  if (c >= 0x1EA0 && c <= 0x1EFF) return c | 1;   // Vietnamese
  if (c >= 0xFF21 && c <= 0xFF3A) return c + 32;  // wide letters
  return c;
}

}  // namespace

std::string dxf_key(std::string_view name) {
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x80 && c != '\\';
  });
  std::string key;
  const std::string kept = plain ? std::string() : decoded(name);
  const std::string_view text = plain ? name : std::string_view(kept);
  key.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const CodePoint at = code_point(text, i);
    if (at.value < 0x80)
      key += capital(text[i]);
    else
      append_utf8(key, lower_case(at.value));
    i += std::max<std::size_t>(at.length, 1);
  }
  return key;
}

std::string dxf_name(std::string_view name) { return decoded(name.substr(0, 120)); }

Result<DxfTables> read_dxf_tables(std::string_view text) { return TableReader(text).read(); }

}  // namespace popcut
