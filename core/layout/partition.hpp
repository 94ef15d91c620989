// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/layout/layout.hpp"
#include "core/layout/line_index.hpp"

namespace popcut {

/// The number of the part that `x` lies in, of those between neighbours of `at`; beyond the ends
/// the nearest one.
[[nodiscard]] inline std::size_t part_at(const std::vector<double>& at, double x) {
  const auto after = std::upper_bound(at.begin() + 1, at.end() - 1, x);
  return static_cast<std::size_t>(after - at.begin()) - 1;
}

/// A seam across a column: at height `y[i]` from `x[i]` to `x[i + 1]`. Where y changes, the seam
/// steps.
struct StepSeam {
  std::vector<double> x;
  std::vector<double> y;
  [[nodiscard]] double at(double x_mm) const { return y[part_at(x, x_mm)]; }
};

/// A drawing's box cut into columns at `xs` (including its own sides); seams cut each column into
/// rows.
struct Partition {
  std::vector<double> xs;
  std::vector<std::vector<StepSeam>> rows;  ///< the seams of each column, downwards
  double top{}, bottom{};

  [[nodiscard]] std::size_t pieces() const;
  /// The piece that contains `p`, which must lie on no seam.
  [[nodiscard]] std::uint32_t piece_at(const PagePoint& p) const;
  [[nodiscard]] std::uint32_t piece(std::size_t column, std::size_t row) const;
  /// A piece's part of the box: a polygon along its sides and seams.
  [[nodiscard]] std::vector<PagePoint> share(std::size_t column, std::size_t row) const;
  /// The column in which `x` lies.
  [[nodiscard]] std::size_t column_at(double x) const { return part_at(xs, x); }
  void index();  ///< call after each change of `xs` or `rows`

 private:
  std::vector<std::uint32_t> first_;
};

/// All straight runs of all seams, each between two pieces, with the stretches that are already cut
/// and the stretches to glue.
[[nodiscard]] std::vector<SeamRun> seam_runs(const Partition& partition, const LineIndex& lines,
                                             double min_panel_mm);

/// Appends the stretches of paper along the line that no cut follows. They end where lines end on
/// the line or cross it.
void uncut_stretches(const LineIndex& lines, const AxisLine& line, double from, double to,
                     const SeamScan& scan, std::vector<SeamStretch>& out);

/// Splits the drawing at the seams: for each piece the parts of lines inside it, in drawing mm.
/// Leaves out what runs along a seam; `add_borders` adds it.
[[nodiscard]] std::vector<LineWork> split_lines(const LineWork& drawing,
                                                const Partition& partition);

/// Adds each piece's border along its seams: existing cuts, straight lines, and the way around its
/// tabs. `tabs` holds the tabs of all runs in order. `border` is the operation of the drawing's own
/// border, so that both join into closed lines; then everything inside them is cut first.
void add_borders(const std::vector<SeamRun>& runs, const std::vector<Tab>& tabs,
                 const LineIndex& lines, Operation border, std::vector<LineWork>& pieces);

}  // namespace popcut
