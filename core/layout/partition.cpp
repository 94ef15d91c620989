// SPDX-License-Identifier: MIT
#include "core/layout/partition.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/layout/line_index.hpp"

namespace popcut {
namespace {

class Runs {
 public:
  Runs(const Partition& partition, const LineIndex& lines, double min_panel_mm)
      : partition_(partition), lines_(lines), min_panel_mm_(min_panel_mm) {}

  std::vector<SeamRun> all() {
    for (std::size_t c = 0; c + 1 < partition_.xs.size(); ++c) {
      if (c > 0) column_seam(c);
      for (std::size_t r = 0; r < partition_.rows[c].size(); ++r) row_seam(c, r);
    }
    return std::move(runs_);
  }

 private:
  // The y at which the rows of a column meet its side at `x`.
  static std::vector<double> meetings(const std::vector<StepSeam>& rows, bool right_side) {
    std::vector<double> ys;
    ys.reserve(rows.size());
    for (const StepSeam& row : rows) ys.push_back(right_side ? row.y.back() : row.y.front());
    return ys;
  }

  void column_seam(std::size_t c) {
    const std::vector<double> left = meetings(partition_.rows[c - 1], true);
    const std::vector<double> right = meetings(partition_.rows[c], false);
    std::size_t l = 0, r = 0;
    double from = partition_.top;
    while (from < partition_.bottom - kOn) {
      const double to = std::min(l < left.size() ? left[l] : partition_.bottom,
                                 r < right.size() ? right[r] : partition_.bottom);
      add(true, partition_.xs[c], from, to, partition_.piece(c - 1, l), partition_.piece(c, r));
      if (l < left.size() && left[l] <= to + kOn) ++l;
      if (r < right.size() && right[r] <= to + kOn) ++r;
      from = to;
    }
  }

  void row_seam(std::size_t c, std::size_t r) {
    const StepSeam& seam = partition_.rows[c][r];
    const std::uint32_t above = partition_.piece(c, r), below = partition_.piece(c, r + 1);
    for (std::size_t i = 0; i < seam.y.size();) {
      std::size_t j = i + 1;
      while (j < seam.y.size() && seam.y[j] == seam.y[i]) ++j;
      add(false, seam.y[i], seam.x[i], seam.x[j], above, below);
      if (j < seam.y.size()) {
        // At a step down the upper piece is to the right; at a step up, to the left.
        const bool down = seam.y[j] > seam.y[i];
        add(true, seam.x[j], std::min(seam.y[i], seam.y[j]), std::max(seam.y[i], seam.y[j]),
            down ? below : above, down ? above : below);
      }
      i = j;
    }
  }

  void add(bool vertical, double at, double from, double to, std::uint32_t lower,
           std::uint32_t upper) {
    if (to - from <= kOn) return;
    SeamRun run{vertical, at, from, to, lower, upper, 0, {}, {}};
    const AxisLine line{vertical, at};
    lines_.scan(line, from, to, min_panel_mm_, scan_);
    uncut_stretches(lines_, line, from, to, scan_, run.uncut);
    run.covered = scan_.covered;
    runs_.push_back(std::move(run));
  }

  const Partition& partition_;
  const LineIndex& lines_;
  double min_panel_mm_;
  SeamScan scan_;
  std::vector<SeamRun> runs_;
};

}  // namespace

void Partition::index() {
  first_.assign(rows.size() + 1, 0);
  for (std::size_t c = 0; c < rows.size(); ++c)
    first_[c + 1] = first_[c] + static_cast<std::uint32_t>(rows[c].size()) + 1;
}

std::size_t Partition::pieces() const { return first_.back(); }

std::uint32_t Partition::piece(std::size_t column, std::size_t row) const {
  return first_[column] + static_cast<std::uint32_t>(row);
}

std::vector<PagePoint> Partition::share(std::size_t column, std::size_t row) const {
  const auto& seams = rows[column];
  const StepSeam above{{xs[column], xs[column + 1]}, {top}};
  const StepSeam below{{xs[column], xs[column + 1]}, {bottom}};
  const StepSeam& upper = row == 0 ? above : seams[row - 1];
  const StepSeam& lower = row == seams.size() ? below : seams[row];
  std::vector<PagePoint> polygon;
  const auto corner = [&](double x, double y) {
    const PagePoint p{x, y};
    const std::size_t n = polygon.size();
    // A seam that goes straight on has no corner here.
    if (n > 1 && polygon[n - 1].y == y && polygon[n - 2].y == y) polygon.pop_back();
    if (polygon.empty() || polygon.back() != p) polygon.push_back(p);
  };
  for (std::size_t i = 0; i < upper.y.size(); ++i) {
    corner(upper.x[i], upper.y[i]);
    corner(upper.x[i + 1], upper.y[i]);
  }
  for (std::size_t i = lower.y.size(); i-- > 0;) {
    corner(lower.x[i + 1], lower.y[i]);
    corner(lower.x[i], lower.y[i]);
  }
  return polygon;
}

std::uint32_t Partition::piece_at(const PagePoint& p) const {
  const std::size_t c = column_at(p.x);
  const auto row = std::find_if(rows[c].begin(), rows[c].end(),
                                [&](const StepSeam& seam) { return p.y < seam.at(p.x); });
  return piece(c, static_cast<std::size_t>(row - rows[c].begin()));
}

void uncut_stretches(const LineIndex& lines, const AxisLine& line, double from, double to,
                     const SeamScan& scan, std::vector<SeamStretch>& out) {
  out.clear();
  const auto add = [&](double a, double b) {
    if (b - a > kOn && lines.is_paper(line.point((a + b) / 2, 0))) out.push_back({a, b, 0, 0});
  };
  auto next = scan.breaks.begin();
  const auto free_part = [&](double a, double b) {
    while (next != scan.breaks.end() && *next <= a + kOn) ++next;
    for (; next != scan.breaks.end() && *next < b - kOn; ++next) {
      add(a, *next);
      a = *next;
    }
    add(a, b);
  };
  double at = from;
  for (const SeamStretch& cut : scan.covered) {
    if (cut.from > at) free_part(at, cut.from);
    at = std::max(at, cut.to);
  }
  if (at < to) free_part(at, to);
}

std::vector<SeamRun> seam_runs(const Partition& partition, const LineIndex& lines,
                               double min_panel_mm) {
  return Runs(partition, lines, min_panel_mm).all();
}

}  // namespace popcut
