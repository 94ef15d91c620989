// SPDX-License-Identifier: MIT
#include "daemon/planning/views/preview.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut::planning {
namespace {

constexpr std::size_t kMostPoints = 1'000'000;

const char* colour_of(Operation operation) {
  switch (operation) {
    case Operation::FoldMountain:
      return "#d32f2f";
    case Operation::FoldValley:
      return "#1565c0";
    case Operation::Cut:
    case Operation::Outline:
      return "#000000";
    default:
      return "#2e7d32";
  }
}

std::string note(const std::string& text, double x, double y, double size) {
  return fmt::format(
      "<text x=\"{:.2f}\" y=\"{:.2f}\" font-family=\"sans-serif\" font-size=\"{:.2f}\">{}</text>\n",
      x, y, size, xml_escaped(text));
}

std::string head(double x, double y, double width, double height) {
  return svg_head(fmt::format("width=\"{2:.2f}mm\" height=\"{3:.2f}mm\" "
                              "viewBox=\"{0:.2f} {1:.2f} {2:.2f} {3:.2f}\"",
                              x, y, width, height),
                  {}, SvgPlace::Inside) +
         fmt::format(
             "<rect x=\"{0:.2f}\" y=\"{1:.2f}\" width=\"{2:.2f}\" height=\"{3:.2f}\" "
             "fill=\"#fff\"/>\n",
             x, y, width, height);
}

}  // namespace

std::string preview_svg(const LineWork& work) {
  const Box box = bounds(work);
  if (box.empty()) return no_preview_svg("the drawing has nothing to cut, fold or draw");
  const double size = std::max({box.width(), box.height(), 1.0});
  const double margin = 0.03 * size;
  std::string svg =
      head(box.x0 - margin, box.y0 - margin, box.width() + 2 * margin, box.height() + 2 * margin);
  auto out = std::back_inserter(svg);
  std::size_t drawn = 0;
  constexpr auto kLast = static_cast<int>(Operation::Outline);
  for (int k = 0; k <= kLast; ++k) {
    const auto operation = static_cast<Operation>(k);
    bool open = false;
    for (const DrawnLine& line : work.lines) {
      if (line.operation != operation || drawn + line.count > kMostPoints) continue;
      if (!open)
        fmt::format_to(out, "<path fill=\"none\" stroke=\"{}\" stroke-width=\"{:.3f}\" d=\"",
                       colour_of(operation), size / 600);
      open = true;
      drawn += line.count;
      char letter = 'M';
      for (const PagePoint& p : work.points_of(line)) {
        fmt::format_to(out, "{}{:.2f} {:.2f}", letter, p.x, p.y);
        letter = 'L';
      }
    }
    if (open) svg += "\"/>\n";
  }
  if (drawn < work.points.size())
    svg += note("only a part is shown: the drawing is large", box.x0, box.y0, size / 40);
  svg += "</svg>\n";
  return svg;
}

std::string no_preview_svg(const std::string& why) {
  constexpr std::size_t kLine = 60;
  std::string svg = head(0, 0, 200, 100) + note("no preview", 5, 15, 6);
  double y = 25;
  for (std::size_t at = 0; at < std::min<std::size_t>(why.size(), 10 * kLine); y += 7) {
    std::size_t count = std::min(kLine, why.size() - at);
    if (at + count < why.size())  // between two words
      if (const std::size_t blank = why.rfind(' ', at + count);
          blank != std::string::npos && blank > at)
        count = blank + 1 - at;
    svg += note(why.substr(at, count), 5, y, 5);
    at += count;
  }
  return svg + "</svg>\n";
}

Result<std::string> shown_blob(const PatchAssembly& made, LatticeQuality quality) {
  constexpr std::size_t kGhostTriangles = 4000;
  const bool is_draft = quality == LatticeQuality::Draft;
  LatticeBlobOptions how;
  how.quality = quality;
  how.curvature = !is_draft;
  how.most_ghost_triangles = is_draft ? 0 : kGhostTriangles;
  return lattice_blob(made, how);
}

}  // namespace popcut::planning
