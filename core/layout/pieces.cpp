// SPDX-License-Identifier: MIT
// Part of core/layout/partition.hpp.
#include <algorithm>
#include <cmath>

#include "core/layout/line_index.hpp"
#include "core/layout/partition.hpp"

namespace popcut {
namespace {

class Splitter {
 public:
  Splitter(const LineWork& drawing, const Partition& partition)
      : drawing_(drawing), partition_(partition), pieces_(partition.pieces()) {}

  std::vector<LineWork> run() {
    for (LineWork& piece : pieces_) piece.name = drawing_.name;
    for (const DrawnLine& line : drawing_.lines) split(line);
    return std::move(pieces_);
  }

 private:
  void split(const DrawnLine& line) {
    const auto points = drawing_.points_of(line);
    way_.clear();
    for (std::size_t i = 1; i < points.size(); ++i) {
      const PagePoint &a = points[i - 1], &b = points[i];
      crossings(a, b);
      for (std::size_t k = 1; k < at_.size(); ++k) {
        if (at_[k] <= at_[k - 1]) continue;
        const PagePoint from = between(a, b, at_[k - 1]), to = between(a, b, at_[k]);
        if (from == to) continue;
        const PagePoint middle = between(a, b, (at_[k - 1] + at_[k]) / 2);
        if (along_seam(from, to, middle))
          end(line.operation);
        else
          go(line.operation, partition_.piece_at(middle), from, to);
      }
    }
    end(line.operation);
  }

  // Where a..b meets seams, as fractions of its length, including 0 and 1.
  void crossings(const PagePoint& a, const PagePoint& b) {
    at_.assign({0.0, 1.0});
    const double x0 = std::min(a.x, b.x), x1 = std::max(a.x, b.x);
    const auto add = [&](double k) {
      if (k > 0.0 && k < 1.0) at_.push_back(k);
    };
    const std::vector<double>& xs = partition_.xs;
    for (auto x = std::upper_bound(xs.begin() + 1, xs.end() - 1, x0); x != xs.end() - 1 && *x < x1;
         ++x)
      add((*x - a.x) / (b.x - a.x));
    std::size_t c = partition_.column_at(x0 - kOn);
    for (; c + 1 < xs.size() && xs[c] <= x1 + kOn; ++c)
      for (const StepSeam& seam : partition_.rows[c]) rows(a, b, seam, x0, x1, add);
    std::sort(at_.begin(), at_.end());
  }

  template <typename Add>
  static void rows(const PagePoint& a, const PagePoint& b, const StepSeam& seam, double x0,
                   double x1, Add&& add) {
    std::size_t i = part_at(seam.x, x0 - kOn);
    for (; i < seam.y.size() && seam.x[i] <= x1 + kOn; ++i) {
      if (a.y != b.y) add((seam.y[i] - a.y) / (b.y - a.y));
      if (a.x != b.x && i > 0) add((seam.x[i] - a.x) / (b.x - a.x));
    }
  }

  [[nodiscard]] bool along_seam(const PagePoint& a, const PagePoint& b,
                                const PagePoint& middle) const {
    const std::vector<double>& xs = partition_.xs;
    if (std::abs(a.x - b.x) <= kOn) {
      const auto x = std::lower_bound(xs.begin() + 1, xs.end() - 1, middle.x - kOn);
      if (x != xs.end() - 1 && std::abs(*x - middle.x) <= kOn) return true;
    }
    const std::size_t c = partition_.column_at(middle.x);
    for (const StepSeam& seam : partition_.rows[c]) {
      if (std::abs(a.y - b.y) <= kOn && std::abs(seam.at(middle.x) - middle.y) <= kOn) return true;
      if (std::abs(a.x - b.x) > kOn) continue;
      const auto x = std::lower_bound(seam.x.begin() + 1, seam.x.end() - 1, middle.x - kOn);
      if (x == seam.x.end() - 1 || std::abs(*x - middle.x) > kOn) continue;
      const auto i = static_cast<std::size_t>(x - seam.x.begin());
      const double low = std::min(seam.y[i - 1], seam.y[i]);
      const double high = std::max(seam.y[i - 1], seam.y[i]);
      if (middle.y > low && middle.y < high) return true;
    }
    return false;
  }

  void go(PenOperation operation, std::uint32_t piece, const PagePoint& from, const PagePoint& to) {
    if (!way_.empty() && (piece != piece_ || way_.back() != from)) end(operation);
    piece_ = piece;
    if (way_.empty()) way_.push_back(from);
    way_.push_back(to);
  }

  void end(PenOperation operation) {
    if (way_.size() > 1) pieces_[piece_].append(operation, way_);
    way_.clear();
  }

  const LineWork& drawing_;
  const Partition& partition_;
  std::vector<LineWork> pieces_;
  std::vector<double> at_;
  std::vector<PagePoint> way_;
  std::uint32_t piece_{};
};

}  // namespace

std::vector<LineWork> split_lines(const LineWork& drawing, const Partition& partition) {
  return Splitter(drawing, partition).run();
}

void add_borders(const std::vector<SeamRun>& runs, const std::vector<Tab>& tabs,
                 const LineIndex& lines, Operation border, std::vector<LineWork>& pieces) {
  std::vector<PagePoint> way;
  for (const SeamRun& run : runs) {
    const AxisLine line{run.vertical, run.at};
    for (const SeamStretch& cut : run.covered) {
      const double middle = (cut.from + cut.to) / 2;
      const std::array<PagePoint, 2> ends{line.point(cut.from, 0), line.point(cut.to, 0)};
      if (lines.is_paper(line.point(middle, -1e-3))) pieces[run.lower].append(border, ends);
      if (lines.is_paper(line.point(middle, 1e-3))) pieces[run.upper].append(border, ends);
    }
    for (const SeamStretch& stretch : run.uncut)
      for (const std::uint32_t piece : {run.lower, run.upper}) {
        way.assign({line.point(stretch.from, 0)});
        for (std::uint32_t i = 0; i < stretch.tabs; ++i) {
          const Tab& tab = tabs[stretch.first_tab + i];
          if (tab.on != piece) continue;
          for (std::size_t k = 0; k < 4; ++k)
            if (way.back() != tab.corners[k]) way.push_back(tab.corners[k]);
        }
        if (const PagePoint last = line.point(stretch.to, 0); way.back() != last)
          way.push_back(last);
        pieces[piece].append(border, way);
      }
  }
}

}  // namespace popcut
