// SPDX-License-Identifier: MIT
#include "core/formats/csv/segments_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::string_view kAround = " \t\r\"";  // what may stand around a field

constexpr std::size_t kColumns = 12;
constexpr std::array<std::string_view, kColumns> kNames{
    "x1", "y1", "z1", "x2", "y2", "z2", "length", "tag", "level", "slice", "flag", "width"};
using Row = std::array<double, kColumns>;

tl::unexpected<Error> wrong(ErrorKind kind, std::size_t line, std::string detail) {
  return fail(kind, fmt::format("line {}", line), std::move(detail));
}

Result<Row> parse_row(std::string_view text, std::size_t line) {
  const auto found = static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
  if (found != kColumns) {
    return wrong(ErrorKind::Malformed, line,
                 fmt::format("has {} columns; give {} columns, separated by commas: x1 to width",
                             found, kColumns));
  }
  Row row{};
  for (std::size_t c = 0; c < kColumns; ++c) {
    const std::string_view field = trimmed(take_word(text, ","), kAround);
    if (!read_number(field, row[c]) || !std::isfinite(row[c])) {
      return wrong(ErrorKind::Malformed, line,
                   fmt::format("column {} ({}) is '{}'; give a finite number", c + 1, kNames[c],
                               field.substr(0, 20)));
    }
  }
  return row;
}

Result<SegmentPanel> panel_of(const Row& row, std::size_t line, SegmentConvention convention) {
  const bool paper = convention == SegmentConvention::Paper;
  const auto z = [&](std::size_t at) { return paper ? 1 - row[at + 1] : row[at + 2]; };
  const auto v = [&](std::size_t at) { return paper ? row[at + 2] : row[at + 1]; };
  const SegmentPanel panel{row[0], z(0), row[3], z(3), v(0), row[11]};
  constexpr double kMost = 100'000.0;
  const double size = std::max({std::abs(panel.x0), std::abs(panel.z0), std::abs(panel.x1),
                                std::abs(panel.z1), std::abs(panel.v), std::abs(panel.width)});
  if (!(size <= kMost))
    return wrong(ErrorKind::OutOfRange, line, "has a coordinate more than 100 m from the origin");
  if (!(panel.width > 0)) {
    return wrong(ErrorKind::OutOfRange, line,
                 fmt::format("column 12 (width) is {}; it must be positive", panel.width));
  }
  constexpr double kRounding = 1e-9;
  if (std::abs(v(3) - v(0)) > kRounding * size) {
    return wrong(ErrorKind::OutOfRange, line,
                 fmt::format("runs from {} to {} along the spine; a panel's line must stay at one "
                             "place along it{}",
                             v(0), v(3),
                             paper ? ""
                                   : " (for a file of the paper's code, use "
                                     "--convention paper)"));
  }
  if (std::min(std::abs(panel.x1 - panel.x0), std::abs(panel.z1 - panel.z0)) > kRounding * size) {
    return wrong(
        ErrorKind::OutOfRange, line,
        "is neither level nor upright; panels must be parallel to the ground or to the wall");
  }
  return panel;
}

}  // namespace

Result<std::vector<SegmentPanel>> read_segments_csv(std::string_view text,
                                                    SegmentConvention convention) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<SegmentPanel> panels;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::string_view row_text = trimmed(text.substr(0, text.find('\n')), kAround);
    text.remove_prefix(std::min(text.size(), std::max(text.find('\n'), text.find('\n') + 1)));
    if (row_text.empty() || (line == 1 && row_text.starts_with("x1"))) continue;
    if (panels.size() == kMaxSegments)
      return wrong(ErrorKind::OutOfRange, line,
                   fmt::format("the file has more than {} rows; split it", kMaxSegments));
    const auto row = parse_row(row_text, line);
    if (!row) return tl::unexpected(row.error());
    const auto panel = panel_of(*row, line, convention);
    if (!panel) return tl::unexpected(panel.error());
    panels.push_back(*panel);
  }
  if (panels.empty())
    return wrong(ErrorKind::Malformed, 1, "the file has no rows; each row needs twelve numbers");
  return panels;
}

}  // namespace popcut
