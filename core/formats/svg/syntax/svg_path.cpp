// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_path.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_scan.hpp"
#include "core/text/utf8.hpp"

namespace popcut {
namespace {

class PathReader {
 public:
  PathReader(std::string_view data, SvgPen pen, const SvgLines& lines, std::size_t most_points)
      : data_(data), scan_(data), pen_(pen), lines_(lines), most_points_(most_points) {}

  Result<void> read() {
    char command = 0;
    if (trimmed(data_) == "none") return {};
    while (!scan_.at_end()) {
      const char c = scan_.peek();
      if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
        command = c;
        scan_.skip();
        if (!moved_ && command != 'M' && command != 'm')
          return wrong("path data must begin with M");
      } else if (command == 0 || command == 'Z' || command == 'z') {
        return wrong("expected a path command");
      }
      if (!draw(command)) return wrong("this cannot be read as path data");
      if (lines_.points.size() > most_points_)
        return tl::unexpected(
            too_much(fmt::format("the path has more than {} points", most_points_)));
      // Further pairs after a move are lines.
      if (command == 'M') command = 'L';
      if (command == 'm') command = 'l';
    }
    pen_.finish();
    return {};
  }

 private:
  [[nodiscard]] tl::unexpected<Error> wrong(const char* what) const {
    const std::size_t at = scan_.position();
    const std::string near = shown_ascii(data_.substr(std::min(at, data_.size())), 12);
    return fail(ErrorKind::Malformed, "",
                fmt::format("{} at character {} (\"{}\")", what, at + 1, near));
  }

  // Reads a point; for a relative command, relative to the pen.
  bool point(bool relative, PagePoint& p) {
    if (!scan_.number(p.x) || !scan_.number(p.y)) return false;
    if (relative) p = {p.x + pen_.at().x, p.y + pen_.at().y};
    return true;
  }
  [[nodiscard]] PagePoint mirrored(const PagePoint& control) const {
    return {2 * pen_.at().x - control.x, 2 * pen_.at().y - control.y};
  }

  bool draw(char command) {
    const bool relative = std::islower(static_cast<unsigned char>(command)) != 0;
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command)));
    PagePoint p, q, r;
    const char before = std::exchange(before_, kind);
    switch (kind) {
      case 'M':
        if (!point(relative, p)) return false;
        moved_ = true;
        pen_.move(p);
        return true;
      case 'Z':
        pen_.close();
        return true;
      case 'L':
        if (!point(relative, p)) return false;
        pen_.line(p);
        return true;
      case 'H':
        if (!scan_.number(p.x)) return false;
        pen_.line({relative ? p.x + pen_.at().x : p.x, pen_.at().y});
        return true;
      case 'V':
        if (!scan_.number(p.y)) return false;
        pen_.line({pen_.at().x, relative ? p.y + pen_.at().y : p.y});
        return true;
      case 'C':
        if (!point(relative, q) || !point(relative, r) || !point(relative, p)) return false;
        return cubic(q, r, p);
      case 'S':
        q = before == 'C' || before == 'S' ? mirrored(control_) : pen_.at();
        if (!point(relative, r) || !point(relative, p)) return false;
        return cubic(q, r, p);
      case 'Q':
        if (!point(relative, q) || !point(relative, p)) return false;
        return quadratic(q, p);
      case 'T':
        q = before == 'Q' || before == 'T' ? mirrored(control_) : pen_.at();
        if (!point(relative, p)) return false;
        return quadratic(q, p);
      case 'A':
        return arc(relative);
      default:
        return false;
    }
  }
  bool cubic(const PagePoint& q, const PagePoint& r, const PagePoint& to) {
    pen_.cubic(q, r, to);
    control_ = r;
    return true;
  }
  bool quadratic(const PagePoint& q, const PagePoint& to) {
    pen_.quadratic(q, to);
    control_ = q;
    return true;
  }
  bool arc(bool relative) {
    double rx = 0, ry = 0, turn = 0;
    bool large = false, sweep = false;
    PagePoint to;
    if (!scan_.number(rx) || !scan_.number(ry) || !scan_.number(turn) || !scan_.flag(large) ||
        !scan_.flag(sweep) || !point(relative, to))
      return false;
    pen_.arc(rx, ry, turn, large, sweep, to);
    return true;
  }

  std::string_view data_;
  SvgScan scan_;
  SvgPen pen_;
  const SvgLines& lines_;
  std::size_t most_points_;
  PagePoint control_;  ///< last control point, for S and T
  char before_{0};
  bool moved_{false};
};

}  // namespace

Result<void> read_svg_path(std::string_view data, double tolerance, std::size_t most_points,
                           SvgLines& lines, bool closes) {
  return PathReader(data, SvgPen(tolerance, lines, closes), lines, most_points).read();
}

}  // namespace popcut
