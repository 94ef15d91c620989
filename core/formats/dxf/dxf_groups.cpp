// SPDX-License-Identifier: MIT
#include "core/formats/dxf/dxf_groups.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr int kComment = 999;
constexpr int kLeastCode = -5, kMostCode = 1071;  // AutoCAD's DXF reference, group code ranges

}  // namespace

std::string dxf_line(std::size_t line) { return fmt::format("line {}", line); }

std::string dxf_shown(std::string_view text) { return shown_ascii(text, 40); }

DxfCursor::DxfCursor(std::string_view text) : text_(text) {
  if (text_.substr(0, 3) == "\xEF\xBB\xBF") text_.remove_prefix(3);
  if (text_.find('\n') == std::string_view::npos) newline_ = '\r';
  // Blank lines before the first group.
  for (std::string_view blank;;) {
    const std::size_t at = at_, number = line_;
    if (line(blank) && blank.empty()) continue;
    at_ = at, line_ = number;
    break;
  }
}

bool DxfCursor::line(std::string_view& out) {
  if (at_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find(newline_, at_), text_.size());
  out = trimmed(text_.substr(at_, end - at_), " \t\r");
  at_ = end + 1;
  ++line_;
  return true;
}

bool DxfCursor::refuse(std::size_t line, std::string detail, ErrorKind kind) {
  if (!error_) error_ = Error{kind, dxf_line(line), std::move(detail)};
  return false;
}

bool DxfCursor::next() {
  if (error_) return false;
  do {
    std::string_view code;
    if (!line(code)) return false;
    if (!read_number(code, group_.code) || group_.code < kLeastCode || group_.code > kMostCode) {
      if (code.empty() && text_.find_first_not_of(" \t\r\n\x1a", at_) == std::string_view::npos)
        return false;  // only blank lines follow
      return refuse(line_,
                    fmt::format("\"{}\" is not a group code; use a whole number from 0 to {} "
                                "here; is a line missing above?",
                                dxf_shown(code), kMostCode));
    }
    if (!line(group_.value))
      return refuse(line_, "the file ends after a group code; is it complete?");
  } while (group_.code == kComment);
  group_.line = line_;
  return true;
}

bool DxfCursor::real(double& value) {
  if (read_number(group_.value, value) && std::isfinite(value)) return true;
  return refuse(group_.line,
                fmt::format("\"{}\" is not a number (group code {}); write a finite number with a "
                            "decimal point",
                            dxf_shown(group_.value), group_.code));
}

bool DxfCursor::integer(int& value) {
  if (read_number(group_.value, value)) return true;
  double wide = 0.0;  // some programs write 1.0, or a flag word of 64 bits
  if (read_number(group_.value, wide) && std::abs(wide) < 1e18) {
    value = std::abs(wide) < 2e9 ? static_cast<int>(wide) : 0;
    return true;
  }
  return refuse(group_.line, fmt::format("\"{}\" is not a whole number (group code {})",
                                         dxf_shown(group_.value), group_.code));
}

}  // namespace popcut
