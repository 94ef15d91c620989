// SPDX-License-Identifier: MIT
#include "core/plot/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/plot/plot_parts.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut::plot {
namespace {

constexpr double kLeft = 72, kTop = 40, kAxesHeight = 320, kAxesWidth = 400, kMapWidth = 350;

std::string superscript(int power) {
  static constexpr std::array kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = power < 0 ? "⁻" : "";
  for (const char digit : std::to_string(std::abs(power)))
    out += kDigits[static_cast<std::size_t>(digit - '0')];
  return out;
}

void put_axes(std::string& svg, const Frame& frame) {
  put(svg,
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#000000\" stroke-width=\"1\"/>\n",
      frame.left, frame.top, frame.width, frame.height);
  const double bottom = frame.top + frame.height;
  for (const double value : ticks(frame.x)) {
    put_line(svg, frame.px(value), bottom, frame.px(value), bottom + 5, kBlack, 1);
    put_text(svg, frame.px(value), bottom + 19, tick_text(frame.x, value), "middle", 12);
  }
  for (const double value : ticks(frame.y)) {
    put_line(svg, frame.left - 5, frame.py(value), frame.left, frame.py(value), kBlack, 1);
    put_text(svg, frame.left - 8, frame.py(value) + 4, tick_text(frame.y, value), "end", 12);
  }
  put_text(svg, frame.left + frame.width / 2, bottom + 38, frame.x.label, "middle", 14);
  const double middle = frame.top + frame.height / 2;
  put(svg,
      "<text x=\"{0:.1f}\" y=\"{1:.1f}\" text-anchor=\"middle\" font-size=\"14\" "
      "transform=\"rotate(-90 {0:.1f} {1:.1f})\">{2}</text>\n",
      frame.left - 52, middle, xml_escaped(frame.y.label));
}

bool inside(const Frame& frame, const PlotPoint& p) {
  const auto within = [](const Axis& axis, double value) {
    const double slack = 1e-9 * std::abs(axis.to - axis.from);
    return value >= axis.from - slack && value <= axis.to + slack;
  };
  return std::isfinite(p[0]) && std::isfinite(p[1]) && within(frame.x, p[0]) &&
         within(frame.y, p[1]);
}

void put_curve(std::string& svg, const Curve& curve, const Frame& frame) {
  std::string path;
  bool pen_down = false;
  for (const PlotPoint& p : curve.points) {
    const bool seen = inside(frame, p);
    if (seen) {
      put(path, "{}{:.2f},{:.2f}", pen_down ? "L" : "M", frame.px(p[0]), frame.py(p[1]));
      if (curve.marks)
        put(svg, "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"3\" fill=\"{}\"/>\n", frame.px(p[0]),
            frame.py(p[1]), curve.colour);
    }
    pen_down = seen;
  }
  if (!curve.line || path.empty()) return;
  put(svg, "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\"{}/>\n", path,
      curve.colour, curve.width, curve.dashed ? " stroke-dasharray=\"6 4\"" : "");
}

void put_note(std::string& svg, const Note& note, const Frame& frame) {
  const double x = frame.px(note.x), y = frame.py(note.y);
  if (note.dot)
    put(svg,
        "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4.5\" fill=\"#ffd92f\" "
        "stroke=\"#000000\" stroke-width=\"1.2\"/>\n",
        x, y);
  const double gap = note.dot ? 8 : 0;
  put_text(svg, note.to_left ? x - gap : x + gap, y + 4, note.text, note.to_left ? "end" : "start",
           12, true);
}

void put_legend(std::string& svg, const Panel& panel, const Frame& frame) {
  constexpr double kRow = 19;
  const auto rows =
      static_cast<double>(std::count_if(panel.curves.begin(), panel.curves.end(),
                                        [](const Curve& curve) { return !curve.name.empty(); }));
  double y = panel.legend_bottom ? frame.top + frame.height - kRow * rows + 6 : frame.top + 18;
  const double x = panel.legend_left ? frame.left + 12 : frame.left + frame.width - 12;
  for (const Curve& curve : panel.curves) {
    if (curve.name.empty()) continue;
    const double from = panel.legend_left ? x : x - 26;
    if (curve.line)
      put(svg, "<path d=\"M{:.1f},{:.1f}h26\" stroke=\"{}\" stroke-width=\"{:g}\"{}/>\n", from,
          y - 4, curve.colour, curve.width, curve.dashed ? " stroke-dasharray=\"6 4\"" : "");
    if (curve.marks)
      put(svg, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", from + 13, y - 4,
          curve.colour);
    put_text(svg, panel.legend_left ? x + 32 : x - 32, y, curve.name,
             panel.legend_left ? "start" : "end", 12, true);
    y += kRow;
  }
}

void put_panel(std::string& svg, const Panel& panel, double left, double top) {
  const Frame frame{left + kLeft, top + kTop, panel.map ? kMapWidth : kAxesWidth,
                    kAxesHeight,  panel.x,    panel.y};
  put_text(svg, frame.left + frame.width / 2, top + 26, panel.title, "middle", 15);
  if (panel.map) put_map(svg, *panel.map, frame);
  for (const Curve& curve : panel.curves) put_curve(svg, curve, frame);
  put_axes(svg, frame);
  put_legend(svg, panel, frame);
  for (const Note& note : panel.notes) put_note(svg, note, frame);
  double y = frame.top + frame.height + 58;
  for (const std::string& remark : panel.remarks) {
    put_text(svg, frame.left + frame.width / 2, y, remark, "middle", 12);
    y += 16;
  }
}

}  // namespace

double Frame::px(double value) const {
  const double t = x.log ? std::log(value / x.from) / std::log(x.to / x.from)
                         : (value - x.from) / (x.to - x.from);
  return left + width * t;
}

double Frame::py(double value) const {
  const double t = y.log ? std::log(value / y.from) / std::log(y.to / y.from)
                         : (value - y.from) / (y.to - y.from);
  return top + height * (1 - t);
}

void put_text(std::string& svg, double x, double y, std::string_view text, std::string_view anchor,
              int size, bool halo) {
  const std::string escaped = xml_escaped(text);
  if (halo) {  // once wide in white, so that it can be read on any colour
    put(svg,
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{}\" "
        "stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\">{}</text>\n",
        x, y, anchor, size, escaped);
  }
  put(svg, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{}\">{}</text>\n", x, y,
      anchor, size, escaped);
}

void put_line(std::string& svg, double x0, double y0, double x1, double y1, std::string_view colour,
              double width) {
  put(svg, "<path d=\"M{:.2f},{:.2f}L{:.2f},{:.2f}\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n", x0,
      y0, x1, y1, colour, width);
}

std::vector<double> ticks(const Axis& axis, int about) {
  std::vector<double> out;
  if (axis.log) {
    const int first = static_cast<int>(std::ceil(std::log10(axis.from) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(axis.to) + 1e-9));
    for (int power = first; power <= last; ++power) out.push_back(std::pow(10.0, power));
    return out;
  }
  const double span = axis.to - axis.from;
  if (!(span > 0) || !std::isfinite(span)) return out;
  const double rough = span / about;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * decade;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= rough * 0.999) {
      step = factor * decade;
      break;
    }
  }
  const double first = std::ceil(axis.from / step - 1e-9);
  for (double k = first; k * step <= axis.to + 1e-9 * span; ++k) out.push_back(k * step);
  return out;
}

std::string tick_text(const Axis& axis, double value) {
  if (axis.log) return "10" + superscript(static_cast<int>(std::llround(std::log10(value))));
  const double span = std::abs(axis.to - axis.from);
  std::string text = fmt::format("{:.4g}", std::abs(value) < 1e-9 * span ? 0.0 : value);
  if (text.front() == '-') text.replace(0, 1, "−");
  return text;
}

std::string figure_svg(std::span<const Panel> panels, std::span<const IsoPanel> surfaces,
                       int columns) {
  const auto count = static_cast<int>(panels.size() + surfaces.size());
  columns = std::clamp(columns, 1, std::max(count, 1));
  const int rows = (count + columns - 1) / columns;
  const double width = columns * kPanelWidth, height = rows * kPanelHeight;
  std::string svg =
      svg_head(fmt::format("width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" "
                           "font-family=\"Helvetica, Arial, DejaVu Sans, sans-serif\"",
                           width, height));
  svg += fmt::format("<rect width=\"{:g}\" height=\"{:g}\" fill=\"#ffffff\"/>\n", width, height);
  int at = 0;
  const auto place = [&] {
    const std::array<double, 2> corner{at % columns * kPanelWidth, at / columns * kPanelHeight};
    ++at;
    return corner;
  };
  for (const Panel& panel : panels) {
    const auto [left, top] = place();
    put_panel(svg, panel, left, top);
  }
  for (const IsoPanel& panel : surfaces) {
    const auto [left, top] = place();
    put_surfaces(svg, panel, left, top);
  }
  svg += "</svg>\n";
  return svg;
}

std::string figure_svg(std::span<const Panel> panels, int columns) {
  return figure_svg(panels, {}, columns);
}

}  // namespace popcut::plot
