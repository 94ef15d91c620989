// SPDX-License-Identifier: MIT
#include "core/print/pages.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "core/layout/layout.hpp"
#include "core/layout/sheet.hpp"
#include "core/plan/sheet_pieces.hpp"
#include "core/print/footer.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"
#include "core/text/utf8.hpp"

namespace popcut {
namespace {

using Out = std::back_insert_iterator<std::string>;

constexpr std::size_t kLongestName = 120;  // bytes

// From below to above, so that cuts are never hidden.
constexpr std::array kOrder{Operation::Draw,       Operation::Score, Operation::FoldMountain,
                            Operation::FoldValley, Operation::Cut,   Operation::Outline};

bool has(const LineWork& work, Operation operation) {
  return std::any_of(work.lines.begin(), work.lines.end(),
                     [&](const DrawnLine& line) { return line.operation == operation; });
}

void put_points(std::string& svg, std::span<const PagePoint> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    svg += i == 0 ? 'M' : 'L';
    append_rounded(svg, points[i].x);
    svg += ' ';
    append_rounded(svg, points[i].y);
  }
}

// In place of those of its group, where a fold is too short for them.
void put_short_dashes(std::string& svg, Operation operation, double length_mm) {
  const std::vector<double> dashes = fold_dashes_mm(operation, length_mm);
  if (dashes == fold_dashes_mm(operation, kLargestPageMm)) return;
  fmt::format_to(Out(svg), " stroke-dasharray=\"{:.3g}\"", fmt::join(dashes, " "));
}

void put_paths(std::string& svg, const LineWork& work, Operation operation) {
  for (const DrawnLine& line : work.lines) {
    if (line.operation != operation) continue;
    svg += "<path d=\"";
    put_points(svg, work.points_of(line));
    svg += '"';
    if (is_fold(operation)) put_short_dashes(svg, operation, length(work.points_of(line)));
    svg += "/>\n";
  }
}

// Around lines on a picture, as dashed as they are, so that they are seen on dark colours too.
void put_rims(std::string& svg, const LineWork& work) {
  for (const Operation operation : kOrder) {
    if (!has(work, operation)) continue;
    std::string style = legend_entry(operation).style;
    const auto set = [&](std::string_view name, std::string_view value) {
      const std::string begin = fmt::format("{}=\"", name);
      const std::size_t at = style.find(begin) + begin.size();
      style.replace(at, style.find('"', at) - at, value);
    };
    set("stroke-width", "0.7");
    set("stroke", "#ffffff");
    fmt::format_to(Out(svg), "<g fill=\"none\" stroke-opacity=\"0.6\" {}>\n", style);
    put_paths(svg, work, operation);
    svg += "</g>\n";
  }
}

// One path for each operation, so that the file stays small.
void put_lines(std::string& svg, const LineWork& work) {
  for (const Operation operation : kOrder) {
    if (!has(work, operation)) continue;
    fmt::format_to(Out(svg), "<g id=\"{}\" fill=\"none\" stroke-linecap=\"butt\" {}>\n",
                   operation_name(operation), legend_entry(operation).style);
    put_paths(svg, work, operation);
    svg += "</g>\n";
  }
}

std::vector<LegendEntry> legend_of(const LineWork& work, bool tabs) {
  std::vector<LegendEntry> legend;
  if (has(work, Operation::Cut) || has(work, Operation::Outline))
    legend.push_back(legend_entry(Operation::Cut));
  for (const Operation operation :
       {Operation::FoldMountain, Operation::FoldValley, Operation::Score, Operation::Draw})
    if (has(work, operation)) legend.push_back(legend_entry(operation));
  if (tabs) legend.push_back(legend_entry_of_tabs());
  return legend;
}

std::string which_side(bool mountain, bool valley) {
  if (!mountain && !valley) return "Printed side up.";
  return fmt::format(
      "Printed side up: {}{}{}. Press the folds first, then cut, and cut the outline last.",
      mountain ? "mountain folds rise toward you" : "", mountain && valley ? ", " : "",
      valley ? "valley folds sink away" : "");
}

std::string which_side(const LineWork& work) {
  return which_side(has(work, Operation::FoldMountain), has(work, Operation::FoldValley));
}

/// One page in the making: an area, with margins around it.
struct Page {
  std::array<double, 2> area_mm{};
  std::string name;
  Footer footer;

  [[nodiscard]] double width() const { return area_mm[0] + 2 * kPrintSideMm; }
  [[nodiscard]] double height() const { return area_mm[1] + kPrintSideMm + kPrintFooterMm; }
  [[nodiscard]] FooterPlace footer_place() const {
    constexpr double kFree = 6.0;  // what printers leave white
    return {kPrintSideMm, kPrintSideMm + area_mm[1] + 1.0, area_mm[0],
            kPrintFooterMm - kFree - 1.0};
  }
};

Result<void> check_size(const Page& page) {
  if (page.width() <= kLargestPageMm && page.height() <= kLargestPageMm) return {};
  return fail(ErrorKind::Infeasible, "pdf",
              fmt::format("a page of {:.0f} x {:.0f} mm is larger than PDF allows ({:.0f} mm); use "
                          "a smaller sheet, or leave pdf out of the formats",
                          page.width(), page.height(), kLargestPageMm));
}

std::string page_head(double width, double height, const std::string& name) {
  return svg_head(
      fmt::format("width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" viewBox=\"0 0 {0:.3f} {1:.3f}\"", width,
                  height),
      name);
}

// One page explains what is on all pages that have no room for it.
void add_legend(std::optional<Footer>& all, const Footer& footer) {
  if (!all) {
    all = footer;
    return;
  }
  const auto has_entry = [&](const LegendEntry& wanted) {
    return std::any_of(all->legend.begin(), all->legend.end(),
                       [&](const LegendEntry& one) { return one.words == wanted.words; });
  };
  for (const LegendEntry& entry : footer.legend)
    if (!has_entry(entry)) all->legend.push_back(entry);
  all->sentences = {"For all sheets that have no room for their legend.",
                    which_side(has_entry(legend_entry(Operation::FoldMountain)),
                               has_entry(legend_entry(Operation::FoldValley)))};
}

/// @param legend_page  set where the legend has no room: what is to stand on a page of its own
PrintedPage printed(const Page& page, const std::string& drawing,
                    std::optional<Footer>& legend_page) {
  std::string svg = page_head(page.width(), page.height(), page.name);
  fmt::format_to(Out(svg), "<g transform=\"translate({0} {0})\">\n{1}</g>\n", kPrintSideMm,
                 drawing);
  std::string footer = footer_svg(page.footer, page.footer_place());
  if (footer.empty()) {
    add_legend(legend_page, page.footer);
    Footer only_name{{}, {page.footer.sentences.front()}};
    footer = footer_svg(only_name, page.footer_place());
    if (footer.empty()) footer = footer_bar(page.footer_place());
  }
  svg += footer + "</svg>\n";
  return {std::move(svg), page.width(), page.height(), 0.0};
}

// On the paper of the other pages, if that is large enough.
PrintedPage legend_only(const Footer& footer, const std::string& name, const PrintedPage& other) {
  constexpr double kWidth = 148.0, kMargin = 10.0;  // as wide as A5
  double width = kWidth;
  double height = footer_height_mm(footer, width - 2 * kMargin) + 2 * kMargin;
  if (other.width_mm >= width && other.height_mm >= height)
    width = other.width_mm, height = other.height_mm;
  std::string svg = page_head(width, height, name + ": legend");
  svg += footer_svg(footer, {kMargin, kMargin, width - 2 * kMargin, height - 2 * kMargin});
  return {svg + "</svg>\n", width, height, 0.0};
}

std::string pieces_in_words(const PlannedSheet& sheet) {
  if (sheet.pieces.empty()) return {};
  std::string words = sheet.pieces.size() == 1 ? ", piece " : ", pieces ";
  for (std::size_t i = 0; i < sheet.pieces.size(); ++i)
    words += fmt::format("{}{}", i == 0 ? "" : ", ", sheet.pieces[i] + 1);
  return words;
}

// Where labels may not stand.
std::vector<Box> tab_boxes(const Plan& plan, std::size_t sheet) {
  std::vector<Box> out;
  for (const PieceMap& piece : pieces_on_sheet(plan, sheet))
    for (std::size_t k = 1; k < piece.polygons.size(); ++k)
      out.push_back(bounds(piece.polygons[k]));
  return out;
}

// The tabs of the sheet's pieces, in sheet mm.
std::string tab_areas(const Plan& plan, const PlannedSheet& sheet) {
  if (!plan.layout) return {};
  std::string path;
  for (const Tab& tab : plan.layout->tabs) {
    if (!std::binary_search(sheet.pieces.begin(), sheet.pieces.end(), tab.on)) continue;
    const Placement& to_sheet = plan.layout->pieces[tab.on].transform;
    std::array<PagePoint, 4> corners{};
    for (std::size_t i = 0; i < 4; ++i) corners[i] = to_sheet(tab.corners[i]);
    put_points(path, corners);
    path += 'Z';
  }
  if (path.empty()) return {};
  return fmt::format("<path id=\"tabs\" {} d=\"{}\"/>\n", legend_entry_of_tabs().style, path);
}

}  // namespace

std::string page_name(const std::string& name) {
  std::string shown;
  for (std::size_t i = 0; i < name.size();) {
    const std::size_t length = code_point(name, i).length;
    shown += length == 0 ? "?" : name.substr(i, length);
    i += std::max<std::size_t>(1, length);
  }
  shown = shown_text(shown);
  if (shown.size() <= kLongestName) return shown;
  std::size_t end = kLongestName;
  while (end > 0 && (static_cast<unsigned char>(shown[end]) & 0xC0u) == 0x80u) --end;
  return shown.substr(0, end) + "…";
}

Result<std::string> sheet_lines_svg(const Plan& plan, std::size_t sheet, PageGround ground) {
  const PlannedSheet& planned = plan.sheets[sheet];
  if (!planned.lines) return fail(ErrorKind::Internal, "pdf", "the plan has not kept its lines");
  std::string svg;
  if (ground == PageGround::Paper)
    svg = tab_areas(plan, planned);
  else
    put_rims(svg, *planned.lines);
  put_lines(svg, *planned.lines);
  return svg;
}

Result<std::vector<PrintedPage>> sheet_pages(const Plan& plan, PageGround ground) {
  std::vector<PrintedPage> pages;
  std::optional<Footer> legend_page;
  const std::string name = page_name(plan.name);
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    const PlannedSheet& sheet = plan.sheets[i];
    auto drawing = sheet_lines_svg(plan, i, ground);
    if (!drawing) return tl::unexpected(drawing.error());
    const bool grey_tabs = ground == PageGround::Paper && !tab_areas(plan, sheet).empty();
    Page page{sheet.area_mm,
              fmt::format("{}: sheet {} of {}", name, i + 1, plan.sheets.size()),
              {legend_of(*sheet.lines, grey_tabs), {}}};
    const std::vector<PartOnSheet> parts = parts_on_sheet(plan, i);
    page.footer.sentences = {
        fmt::format("{}: sheet {} of {}{}{}", name, i + 1, plan.sheets.size(),
                    pieces_in_words(sheet), parts.empty() ? "" : ", " + part_names(parts)),
        which_side(*sheet.lines)};
    if (auto fits = check_size(page); !fits) return tl::unexpected(fits.error());
    constexpr double kPrinted = kPrintSideMm - 5.0;  // what most printers reach
    *drawing += part_labels_svg(
        parts, {-kPrinted, -kPrinted, sheet.area_mm[0] + kPrinted, sheet.area_mm[1]},
        tab_boxes(plan, i));
    *drawing += glue_marks_svg(plan, i);
    pages.push_back(printed(page, *drawing, legend_page));
  }
  if (plan.layout) {
    constexpr double kAround = 10.0;
    const PrintedPage& first = pages.front();
    pages.push_back({assembly_svg(*plan.layout, plan.whole), first.width_mm, first.height_mm,
                     std::min(kAround, first.width_mm / 10)});
  }
  if (legend_page) pages.push_back(legend_only(*legend_page, name, pages.front()));
  return pages;
}

Result<std::vector<PrintedPage>> pattern_pages(const Pattern& pattern) {
  const LineWork work = linework_from_pattern(pattern);
  const std::string name = page_name(pattern.name);
  const double height = pattern.wall_mm + pattern.ground_mm;
  Page page{
      {pattern.width_mm, height},
      name,
      {legend_of(work, false),
       {fmt::format("{}: {:.1f} x {:.1f} mm", name, pattern.width_mm, height), which_side(work)}}};
  if (auto fits = check_size(page); !fits) return tl::unexpected(fits.error());
  std::string drawing;
  put_lines(drawing, work);
  std::optional<Footer> legend_page;
  std::vector<PrintedPage> pages{printed(page, drawing, legend_page)};
  if (legend_page) pages.push_back(legend_only(*legend_page, name, pages.front()));
  return pages;
}

}  // namespace popcut
