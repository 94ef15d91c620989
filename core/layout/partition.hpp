// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/layout/layout.hpp"
#include "core/layout/line_index.hpp"

namespace popcut {

/// A seam across a column: at `y[i]` from `x[i]` to `x[i + 1]`. Where y changes it steps along x.
struct StepSeam {
  std::vector<double> x;
  std::vector<double> y;
  [[nodiscard]] double at(double x_mm) const;
};

/// A drawing's box cut into columns at `xs` (its own sides too), each into rows at its seams.
struct Partition {
  std::vector<double> xs;
  std::vector<std::vector<StepSeam>> rows;  ///< of each column, downwards
  double top{}, bottom{};

  [[nodiscard]] std::size_t pieces() const;
  /// The piece in which a point lies that is on no seam.
  [[nodiscard]] std::uint32_t piece_at(const PagePoint& p) const;
  [[nodiscard]] std::uint32_t piece(std::size_t column, std::size_t row) const;
  /// What of the box belongs to a piece: a polygon along its sides and seams.
  [[nodiscard]] std::vector<PagePoint> share(std::size_t column, std::size_t row) const;
  void index();  ///< after a change of `xs` or `rows`

 private:
  std::vector<std::uint32_t> first_;
};

/// All straight runs of all seams, with what is cut along them already and the stretches that have
/// to be glued. Each run lies between two pieces.
[[nodiscard]] std::vector<SeamRun> seam_runs(const Partition& partition, const LineIndex& lines,
                                             double min_panel_mm);

/// The stretches of paper along the line that no cut follows, parted where lines end on it or cross
/// it.
void uncut_stretches(const LineIndex& lines, const AxisLine& line, double from, double to,
                     const SeamScan& scan, std::vector<SeamStretch>& out);

}  // namespace popcut
