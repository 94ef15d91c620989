// SPDX-License-Identifier: MIT
// Part of core/layout/layout.hpp.
#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "core/layout/layout.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

constexpr std::array kTints{"#cfe3f7", "#fbe3c8", "#d8efd3", "#f3d6e4",
                            "#e3dcf3", "#f5efc4", "#d2eeee", "#e6e0d6"};

const char* colour(Operation operation) {
  if (operation == Operation::FoldMountain) return "#d62728";
  return operation == Operation::FoldValley ? "#1f5fd6" : "#333333";
}

class Drawing {
 public:
  Drawing(const Layout& layout, const LineWork& drawing) : layout_(layout), drawing_(drawing) {}

  std::string svg() {
    const Box box = bounds(drawing_);
    const double size = std::max(box.width(), box.height());
    text_ = std::clamp(std::min(size / 45, std::min(box.width(), box.height()) / 20), 3.5, 60.0);
    // The steps stand beside the drawing; below it if it is wide.
    const bool under = box.width() > 1.6 * box.height();
    const double list = (static_cast<double>(layout_.steps.size() + 3) * 1.5 + 1) * text_;
    const double width = box.width() + (under ? 2 : 30) * text_;
    const double height =
        under ? box.height() + 2 * text_ + list : std::max(box.height() + 2 * text_, list);
    const PagePoint steps_at =
        under ? PagePoint{box.x0, box.y1 + 2 * text_} : PagePoint{box.x1 + text_, box.y0 + text_};
    out_ += svg_head(
        fmt::format("width=\"{2:.3f}mm\" height=\"{3:.3f}mm\" "
                    "viewBox=\"{0:.3f} {1:.3f} {2:.3f} {3:.3f}\" font-family=\"sans-serif\"",
                    box.x0 - text_, box.y0 - text_, width, height),
        drawing_.name + (layout_.seams.empty() ? ": the pieces and their sheets"
                                               : ": how to glue the pieces together"));
    out_ += fmt::format(
        "<rect x=\"{:.3f}\" y=\"{:.3f}\" width=\"{:.3f}\" height=\"{:.3f}\" "
        "fill=\"white\"/>\n",
        box.x0 - text_, box.y0 - text_, width, height);
    pieces();
    lines_of_drawing(size);
    tabs(size);
    seams(size);
    numbers();
    steps(steps_at);
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  // Fills each piece's part of the paper with its own tint. Closed lines tell where the paper is.
  void pieces() {
    std::string paper;
    for (const DrawnLine& line : drawing_.lines) {
      const auto points = drawing_.points_of(line);
      if (is_cut(line.operation) && closed(points)) append_path(points, paper);
    }
    const bool clip = !paper.empty();
    if (clip)
      out_ += fmt::format(
          "<clipPath id=\"paper\"><path clip-rule=\"evenodd\" d=\"{}\"/></clipPath>\n", paper);
    out_ += fmt::format("<g fill-opacity=\"0.6\"{}>\n", clip ? " clip-path=\"url(#paper)\"" : "");
    for (std::uint32_t i = 0; i < layout_.pieces.size(); ++i) {
      std::string path;
      append_path(layout_.pieces[i].share, path);
      out_ += fmt::format("<path d=\"{}Z\" fill=\"{}\"/>\n", path, kTints[i % kTints.size()]);
    }
    out_ += "</g>\n";
  }

  static void append_path(std::span<const PagePoint> points, std::string& path) {
    const char* sign = "M";
    for (const PagePoint& p : points) {
      path += fmt::format("{}{:.3f},{:.3f}", sign, p.x, p.y);
      sign = "L";
    }
  }

  void lines_of_drawing(double size) {
    for (const Operation operation :
         {Operation::FoldMountain, Operation::FoldValley, Operation::Cut, Operation::Outline}) {
      std::string path;
      for (const DrawnLine& line : drawing_.lines) {
        if (line.operation != operation) continue;
        append_path(drawing_.points_of(line), path);
      }
      if (path.empty()) continue;
      out_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.3f}\"/>\n",
                          path, colour(operation), size / 700);
    }
  }

  void tabs(double size) {
    for (const Tab& tab : layout_.tabs) {
      out_ += "<path d=\"";
      append_path(tab.corners, out_);
      out_ += fmt::format(
          "Z\" fill=\"#2ca02c\" fill-opacity=\"0.35\" stroke=\"#2ca02c\" "
          "stroke-width=\"{:.3f}\"/>\n",
          size / 2500);
    }
  }

  void seams(double size) {
    std::string path;
    for (const SeamRun& run : layout_.runs)
      path += run.vertical ? fmt::format("M{:.3f},{:.3f}V{:.3f}", run.at, run.from, run.to)
                           : fmt::format("M{:.3f},{:.3f}H{:.3f}", run.from, run.at, run.to);
    out_ +=
        fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#2ca02c\" stroke-width=\"{:.3f}\"/>\n",
                    path, size / 350);
    // Each seam's letter stands at the middle of its longest run.
    std::vector<const SeamRun*> longest(layout_.seams.size(), nullptr);
    for (const SeamRun& run : layout_.runs) {
      const SeamRun*& best = longest[run.seam];
      if (!best || run.to - run.from > best->to - best->from) best = &run;
    }
    for (std::size_t s = 0; s < longest.size(); ++s) {
      if (!longest[s]) continue;
      const double middle = (longest[s]->from + longest[s]->to) / 2;
      const PagePoint p = AxisLine{longest[s]->vertical, longest[s]->at}.point(middle, 0);
      out_ += fmt::format(
          "<circle cx=\"{0:.3f}\" cy=\"{1:.3f}\" r=\"{2:.3f}\" fill=\"white\" "
          "stroke=\"#2ca02c\" stroke-width=\"{3:.3f}\"/>",
          p.x, p.y, 0.8 * text_, text_ / 12);
      text(p.x, p.y + 0.35 * text_, text_, "middle", layout_.seams[s].label);
    }
  }

  void numbers() {
    for (std::uint32_t i = 0; i < layout_.pieces.size(); ++i) {
      const Box box = bounds(layout_.pieces[i].share);
      const double x = (box.x0 + box.x1) / 2, y = (box.y0 + box.y1) / 2;
      text(x, y, 1.6 * text_, "middle", fmt::format("{}", i + 1));
      text(x, y + 1.2 * text_, 0.8 * text_, "middle",
           fmt::format("sheet {}", layout_.pieces[i].sheet + 1));
    }
  }

  void steps(const PagePoint& at) {
    const double x = at.x;
    double y = at.y;
    if (layout_.seams.empty()) return text(x, y, 1.1 * text_, "start", "Pieces and their sheets");
    text(x, y, 1.1 * text_, "start", "Glue in this order");
    for (std::size_t k = 0; k < layout_.steps.size(); ++k) {
      std::string words;
      for (const std::uint32_t s : layout_.steps[k]) {
        const PieceSeam& seam = layout_.seams[s];
        words += fmt::format("{}{} ({} + {})", words.empty() ? "" : ", ", seam.label,
                             seam.lower + 1, seam.upper + 1);
      }
      y += 1.5 * text_;
      if (words.size() > 40) words = words.substr(0, words.find(')', 24) + 1) + " ...";
      text(x, y, 0.9 * text_, "start", fmt::format("{}. {}", k + 1, words));
    }
    y += 1.5 * text_;
    text(x, y, 0.9 * text_, "start",
         fmt::format("{:.0f} mm to glue; {} tabs (green) go under the other piece", layout_.glue_mm,
                     layout_.tabs.size()));
  }

  void text(double x, double y, double size, const char* anchor, const std::string& words) {
    out_ += fmt::format(
        "<text x=\"{:.3f}\" y=\"{:.3f}\" font-size=\"{:.3f}\" text-anchor=\"{}\" "
        "fill=\"#111111\">{}</text>\n",
        x, y, size, anchor, xml_escaped(words));
  }

  const Layout& layout_;
  const LineWork& drawing_;
  double text_{};
  std::string out_;
};

}  // namespace

std::string assembly_svg(const Layout& layout, const LineWork& drawing) {
  return Drawing(layout, drawing).svg();
}

}  // namespace popcut
