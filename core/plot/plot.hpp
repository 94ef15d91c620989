// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace popcut::plot {

/// Colours as SVG takes them.
inline constexpr const char* kBlack = "#000000";
inline constexpr const char* kBlue = "#1f5fa8";
inline constexpr const char* kRed = "#b3282d";
inline constexpr const char* kGreen = "#2e8b57";
inline constexpr const char* kGrey = "#808080";

struct Axis {
  std::string label;
  double from{};
  double to{};
  bool log{};  ///< decades; from and to are then positive
};

using PlotPoint = std::array<double, 2>;

/// A line, a row of marks, or both.
struct Curve {
  std::string name;  ///< in the legend; empty: not there
  std::vector<PlotPoint> points;
  std::string colour{kBlack};
  bool line{true};
  bool marks{false};
  bool dashed{false};
  double width{2.0};
};

/// A word at a place, with a dot there if wanted.
struct Note {
  double x{};
  double y{};
  std::string text;
  bool dot{false};
  bool to_left{false};  ///< the text ends at the place instead of beginning there
};

/// Values over a grid on the panel's axes, drawn as filled bands with a colour bar.
struct Map {
  std::size_t columns{}, rows{};
  std::vector<double> value;  ///< row by row, from the least y; not finite: left blank
  std::string label;
  double least{}, largest{};          ///< of the colours; what lies beyond has the last colour
  bool diverging{true};               ///< blue - white - red, else dark to light
  std::vector<double> contours;       ///< drawn black
  std::vector<double> thin_contours;  ///< drawn thin and grey
};

/// One pair of axes with what is on it.
struct Panel {
  std::string title;
  Axis x, y;
  std::optional<Map> map;
  std::vector<Curve> curves;
  std::vector<Note> notes;
  std::vector<std::string> remarks;  ///< lines of text below the x axis' label
  bool legend_left{false};           ///< where the curves' legend stands; else right
  bool legend_bottom{false};
};

/// A value over a box, drawn as surfaces where it has given levels, seen from above.
struct IsoPanel {
  std::string title;
  std::array<Axis, 3> axis;  ///< the third points up
  std::size_t samples{};     ///< along each axis
  std::function<double(double, double, double)> value;
  struct Level {
    double value{};
    std::string colour;
    std::string name;
  };
  std::vector<Level> levels;
  std::string remark;
};

inline constexpr double kPanelWidth = 520, kPanelHeight = 450;  // px

/// The panels side by side, `columns` to a row, as one SVG document of plain shapes and text: no
/// style sheets, scripts or filters, so that any program turns it into pixels.
[[nodiscard]] std::string figure_svg(std::span<const Panel> panels, int columns = 2);
/// The same with the surfaces after the panels.
[[nodiscard]] std::string figure_svg(std::span<const Panel> panels,
                                     std::span<const IsoPanel> surfaces, int columns = 2);

/// Round values for the ticks of an axis, within it; decades if it is logarithmic.
[[nodiscard]] std::vector<double> ticks(const Axis& axis, int about = 6);
/// A tick's value as text: few digits, true minus, 10 to a power on a logarithmic axis.
[[nodiscard]] std::string tick_text(const Axis& axis, double value);

/// Lines on which a map has the value `level`, in grid coordinates (column, row): piecewise linear
/// on the cells' edges, chained, closed ones with the first point again at the end.
[[nodiscard]] std::vector<std::vector<PlotPoint>> contour_lines(const Map& map, double level);

}  // namespace popcut::plot
