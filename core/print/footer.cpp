// SPDX-License-Identifier: MIT
#include "core/print/footer.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "core/text/text_sink.hpp"
#include "core/text/text_width.hpp"

namespace popcut {
namespace {

constexpr double kTextMm = 2.8;  // height of letters, as a font size
constexpr double kRowMm = 4.6;   // from one row to the next
constexpr double kSampleMm = 10.0;
constexpr double kGapMm = 2.0;

using Out = std::back_insert_iterator<std::string>;

void put_text(std::string& svg, double x, double y, std::string_view text) {
  fmt::format_to(Out(svg), "<text x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n", x, y, xml_escaped(text));
}

double bar_length_mm(double width_mm) {
  for (const double length : {100.0, 50.0, 20.0, 10.0})
    if (length <= width_mm) return length;
  return 0.0;
}

double entry_width_mm(const LegendEntry& entry) {
  return kSampleMm + kGapMm + text_width(entry.words, kTextMm);
}

// Entries row by row, as many as fit beside each other.
std::vector<std::vector<const LegendEntry*>> legend_rows(const std::vector<LegendEntry>& legend,
                                                         double width_mm) {
  std::vector<std::vector<const LegendEntry*>> rows;
  double used = 0.0;
  for (const LegendEntry& entry : legend) {
    const double wide = entry_width_mm(entry);
    if (rows.empty() || used + 2 * kGapMm + wide > width_mm) {
      rows.emplace_back();
      used = -2 * kGapMm;
    }
    rows.back().push_back(&entry);
    used += 2 * kGapMm + wide;
  }
  return rows;
}

std::vector<std::string> all_broken(const Footer& footer, double width_mm) {
  std::vector<std::string> rows;
  for (const std::string& sentence : footer.sentences)
    for (std::string& row : text_rows(sentence, kTextMm, width_mm)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace

std::vector<double> fold_dashes_mm(Operation operation, double length_mm) {
  const bool is_mountain = operation == Operation::FoldMountain;
  std::vector<double> dashes =
      is_mountain ? std::vector{6.0, 1.5, 1.0, 1.5} : std::vector{3.0, 1.5};
  // Two dashes and the gap between them.
  const double least_mm = is_mountain ? 8.5 : 7.5;
  if (length_mm >= least_mm) return dashes;
  constexpr double kShort_mm = 3.5, kDot_mm = 0.5;
  if (length_mm < kShort_mm) return std::vector(2, std::min(kDot_mm, length_mm / 4));
  for (double& part : dashes) part *= length_mm / least_mm;
  return dashes;
}

LegendEntry legend_entry(Operation operation) {
  const auto fold = [](std::string_view colour, const std::vector<double>& dashes) {
    return fmt::format("stroke-width=\"0.3\" stroke=\"{}\" stroke-dasharray=\"{:g}\"", colour,
                       fmt::join(dashes, " "));
  };
  switch (operation) {
    case Operation::FoldMountain:
      return {fold(kMountainInk, fold_dashes_mm(operation, kSampleMm)), "mountain fold"};
    case Operation::FoldValley:
      return {fold(kValleyInk, fold_dashes_mm(operation, kSampleMm)), "valley fold"};
    case Operation::Score:
      return {fold("#007a5a", {0.8, 0.8}), "score"};
    case Operation::Draw:
      return {"stroke-width=\"0.2\" stroke=\"#808080\"", "mark"};
    default:
      return {"stroke-width=\"0.3\" stroke=\"#000000\"", "cut"};
  }
}

LegendEntry legend_entry_of_tabs() {
  return {"fill=\"#dddddd\" stroke=\"none\"", "tab: glue under the same letter", true};
}

double footer_height_mm(const Footer& footer, double width_mm) {
  const std::size_t rows =
      1 + legend_rows(footer.legend, width_mm).size() + all_broken(footer, width_mm).size();
  return kRowMm * static_cast<double>(rows);
}

std::string footer_bar(const FooterPlace& place) {
  const double length = bar_length_mm(place.width);
  if (length == 0.0 || place.height < kRowMm) return {};
  std::string svg;
  const double y = place.top + kRowMm - 2.0, x = place.left;
  fmt::format_to(
      Out(svg),
      "<path id=\"bar\" fill=\"none\" stroke=\"#000000\" stroke-width=\"0.3\" "
      "d=\"M{0:.2f} {2:.2f}V{3:.2f}M{0:.2f} {4:.2f}H{1:.2f}M{1:.2f} {2:.2f}V{3:.2f}\"/>\n",
      x, x + length, y - 1.5, y + 1.5, y);
  svg += fmt::format("<g font-family=\"sans-serif\" font-size=\"{}\" fill=\"#000000\">\n", kTextMm);
  for (const std::string& words :
       {fmt::format("{:g} mm: measure it on the print before you cut", length),
        fmt::format("{:g} mm", length)}) {
    if (length + kGapMm + text_width(words, kTextMm) > place.width) continue;
    put_text(svg, x + length + kGapMm, y + 1.0, words);
    return svg + "</g>\n";
  }
  // No room beside it: its length stands on it.
  put_text(svg, x + 1.0, y - 0.8, fmt::format("{:g} mm", length));
  return svg + "</g>\n";
}

std::string footer_svg(const Footer& footer, const FooterPlace& place) {
  if (footer_height_mm(footer, place.width) > place.height + 1e-9) return {};
  const auto rows = legend_rows(footer.legend, place.width);
  for (const auto& row : rows)
    for (const LegendEntry* entry : row)
      if (entry_width_mm(*entry) > place.width) return {};
  std::string svg = footer_bar(place);
  if (svg.empty()) return {};
  svg += fmt::format("<g font-family=\"sans-serif\" font-size=\"{}\" fill=\"#000000\">\n", kTextMm);
  double y = place.top + kRowMm;
  for (const auto& row : rows) {
    double x = place.left;
    y += kRowMm;
    for (const LegendEntry* entry : row) {
      if (entry->filled)
        fmt::format_to(Out(svg),
                       "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"3\" {}/>\n", x,
                       y - 3.5, kSampleMm, entry->style);
      else
        fmt::format_to(Out(svg), "<path d=\"M{:.2f} {:.2f}h{:.2f}\" fill=\"none\" {}/>\n", x,
                       y - 2.0, kSampleMm, entry->style);
      put_text(svg, x + kSampleMm + kGapMm, y - 1.0, entry->words);
      x += entry_width_mm(*entry) + 2 * kGapMm;
    }
  }
  for (const std::string& words : all_broken(footer, place.width)) {
    y += kRowMm;
    put_text(svg, place.left, y - 1.0, words);
  }
  return svg + "</g>\n";
}

}  // namespace popcut
