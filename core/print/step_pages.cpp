// SPDX-License-Identifier: MIT
#include "core/print/step_pages.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "core/text/svg_document.hpp"
#include "core/text/text_width.hpp"

namespace popcut {
namespace step_pages_parts {
namespace {

constexpr double kEdgeMm = 10, kHeadMm = 9, kBetweenMm = 3;
constexpr double kWordsMm = 2.8, kWordsRowMm = 3.5;
constexpr std::array<double, 2> kLeastPageMm{105, 148};

struct StepGrid {
  std::size_t columns{}, rows{};
  double width_mm{}, height_mm{};

  StepGrid(std::size_t steps, std::array<double, 2> area_mm) {
    constexpr double kLeastWideMm = 85;
    columns = std::max<std::size_t>(1, static_cast<std::size_t>(area_mm[0] / kLeastWideMm));
    columns = std::min(columns, std::max<std::size_t>(1, steps));
    rows = (steps + columns - 1) / columns;
    const auto c = static_cast<double>(columns), r = static_cast<double>(rows);
    width_mm = (area_mm[0] - (c - 1) * kBetweenMm) / c;
    height_mm = std::min(width_mm, (area_mm[1] - (r - 1) * kBetweenMm) / r);
  }
};

}  // namespace
}  // namespace step_pages_parts

std::string step_words_svg(std::size_t number, const std::string& words, const PageCell& cell,
                           PageCell& rest) {
  using namespace step_pages_parts;
  std::string svg = fmt::format(
      "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"none\" "
      "stroke=\"#c8c2b8\" stroke-width=\"0.2\" rx=\"1.5\"/>\n",
      cell.x, cell.y, cell.width, cell.height);
  double y = cell.y + 1.4 + kWordsMm;
  fmt::format_to(std::back_inserter(svg),
                 "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"4\" font-weight=\"bold\">{}</text>\n",
                 cell.x + 1.5, y + 0.4, number);
  constexpr double kIndentMm = 9;
  for (const std::string& row : text_rows(words, kWordsMm, cell.width - kIndentMm - 1)) {
    fmt::format_to(std::back_inserter(svg), "<text x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n",
                   cell.x + kIndentMm, y, xml_escaped(row));
    y += kWordsRowMm;
  }
  y -= 2.2;
  rest = {cell.x + 1.5, y, cell.width - 3, cell.y + cell.height - 1.5 - y};
  return svg;
}

Result<std::vector<PrintedPage>> step_pages(
    const std::string& name, std::array<double, 2> page_mm, std::size_t steps, std::size_t a_page,
    const std::function<Result<std::string>(std::size_t, const PageCell&)>& draw) {
  using namespace step_pages_parts;
  if (std::min(page_mm[0], page_mm[1]) < kLeastPageMm[0] ||
      std::max(page_mm[0], page_mm[1]) < kLeastPageMm[1] ||
      std::max(page_mm[0], page_mm[1]) > kLargestPageMm)
    return fail(
        ErrorKind::OutOfRange, "page",
        fmt::format("{:g} x {:g} mm has no room for a fold guide; give a paper from A6 "
                    "({:g} x {:g} mm) to {:g} mm",
                    page_mm[0], page_mm[1], kLeastPageMm[0], kLeastPageMm[1], kLargestPageMm));
  const std::size_t pages =
      a_page == 0 ? 1 : std::max<std::size_t>(1, (steps + a_page - 1) / a_page);
  std::vector<PrintedPage> out;
  for (std::size_t page = 0; page < pages; ++page) {
    std::string svg = svg_head(
        fmt::format("width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" viewBox=\"0 0 {0:.3f} {1:.3f}\"",
                    page_mm[0], page_mm[1]),
        name);
    fmt::format_to(std::back_inserter(svg),
                   "<g font-family=\"sans-serif\" font-size=\"{}\" fill=\"#202020\">\n"
                   "<text x=\"{}\" y=\"{}\" font-size=\"5\" font-weight=\"bold\">{}</text>\n"
                   "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">page {} of {}</text>\n",
                   kWordsMm, kEdgeMm, kEdgeMm + 4, xml_escaped(shortened(name, 5, page_mm[0] - 60)),
                   page_mm[0] - kEdgeMm, kEdgeMm + 4, page + 1, pages);
    const StepGrid grid(a_page, {page_mm[0] - 2 * kEdgeMm, page_mm[1] - 2 * kEdgeMm - kHeadMm});
    for (std::size_t k = page * a_page; k < std::min(steps, (page + 1) * a_page); ++k) {
      const std::size_t place = k - page * a_page;
      const std::size_t column = place % grid.columns, row = place / grid.columns;
      auto step =
          draw(k, {kEdgeMm + static_cast<double>(column) * (grid.width_mm + kBetweenMm),
                   kEdgeMm + kHeadMm + static_cast<double>(row) * (grid.height_mm + kBetweenMm),
                   grid.width_mm, grid.height_mm});
      if (!step) return tl::unexpected(step.error());
      svg += *step;
    }
    out.push_back({svg + "</g>\n</svg>\n", page_mm[0], page_mm[1], 0.0});
  }
  return out;
}

}  // namespace popcut
