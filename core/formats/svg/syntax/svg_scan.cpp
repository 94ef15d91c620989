// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_scan.hpp"

#include <charconv>
#include <cmath>

#include "core/text/words.hpp"

namespace popcut {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

void SvgScan::blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
}

void SvgScan::separator() {
  blanks();
  if (at_ < text_.size() && text_[at_] == ',') ++at_;
  blanks();
}

bool SvgScan::at_end() {
  blanks();
  return at_ >= text_.size();
}

char SvgScan::peek() { return at_end() ? '\0' : text_[at_]; }

bool SvgScan::number_follows() {
  std::size_t i = at_;
  while (i < text_.size() && (is_blank(text_[i]) || text_[i] == ',')) ++i;
  return i < text_.size() &&
         (is_digit(text_[i]) || text_[i] == '.' || text_[i] == '-' || text_[i] == '+');
}

bool SvgScan::number(double& out) {
  separator();
  std::size_t from = at_;
  if (from < text_.size() && text_[from] == '+') ++from;
  std::size_t first = from;
  if (first < text_.size() && text_[first] == '-' && first == at_) ++first;
  if (first >= text_.size() || !(is_digit(text_[first]) || text_[first] == '.')) return false;
  const char* begin = text_.data() + from;
  const auto [end, fault] = std::from_chars(begin, text_.data() + text_.size(), out);
  if (fault != std::errc{} || !std::isfinite(out)) return false;
  at_ = from + static_cast<std::size_t>(end - begin);
  return true;
}

bool SvgScan::flag(bool& out) {
  separator();
  if (at_ >= text_.size() || (text_[at_] != '0' && text_[at_] != '1')) return false;
  out = text_[at_++] == '1';
  return true;
}

std::string_view SvgScan::word() {
  blanks();
  const std::size_t from = at_;
  while (at_ < text_.size() && is_letter(text_[at_])) ++at_;
  return text_.substr(from, at_ - from);
}

}  // namespace popcut
