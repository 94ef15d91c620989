// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/geometry/interval_bins.hpp"
#include "core/geometry/segment_grid.hpp"
#include "core/layout/tabs.hpp"

namespace popcut {

/// What lies closer to a line than this lies on it, mm.
inline constexpr double kOn = 1e-6;

/// Sorts stretches and joins those that meet.
void merge_stretches(std::vector<SeamStretch>& stretches);

/// Sorts places and drops those that lie on the one before.
void sort_places(std::vector<double>& at);

/// Everything that a straight seam meets along its way.
struct SeamScan {
  std::vector<SeamStretch> covered;  ///< where a cut or an outline runs along it, merged and sorted
  std::vector<double> breaks;        ///< where lines end on it or cross it, sorted
  double fold_mm{};                  ///< length of folds along it; a valid seam has none
  double sliver_mm{};  ///< length of lines closer than the narrowest panel; a valid seam has none
  std::uint32_t folds_crossed{}, cuts_crossed{};
};

/// An index of a drawing's lines for the search of seams and tabs. Ignores lines drawn with a pen.
class LineIndex {
 public:
  /// @param reach_mm  how far around themselves tabs look for lines
  LineIndex(const LineWork& work, double reach_mm);

  /// Finds what the line meets between `from` and `to`.
  void scan(const AxisLine& line, double from, double to, double min_panel_mm, SeamScan& out) const;

  /// The distance from the line to the first other line on `side` over `from`..`to`, at most `most`
  /// mm.
  [[nodiscard]] double free_depth(const AxisLine& line, double from, double to, int side,
                                  double most);

  /// Whether `p` is on the paper: inside an odd number of closed lines, or inside the drawing's box
  /// if it has no closed lines.
  [[nodiscard]] bool is_paper(const PagePoint& p) const;

  /// The segments that reach into or touch the strip between two lines along y (`by_x`) or along x,
  /// each once. O(k) for k segments in and near the strip.
  [[nodiscard]] std::vector<std::uint32_t> between(bool by_x, double from, double to) const;

  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] std::span<const Segment> segments() const { return segments_; }
  [[nodiscard]] PenOperation operation(std::size_t i) const { return operations_[i]; }

 private:
  // Segments sorted into slices of one coordinate; a seam looks into a single slice. In each slice
  // the long segments come first. The others are sorted by where they begin; each knows how far the
  // segments up to it reach.
  struct Slices {
    IntervalBins items;
    std::vector<std::uint32_t> first_short;
    std::vector<double> begin, reach;
  };
  void sort_slices(bool by_x, Slices& slices) const;
  template <typename Visit>
  void visit(const AxisLine& line, double from, double to, Visit&& visit) const;
  [[nodiscard]] Slices slices(bool by_x, const std::vector<std::uint32_t>& which,
                              double reach) const;

  /// Reads the segments. @return those of closed lines, which bound the paper
  std::vector<std::uint32_t> read(const LineWork& work);

  std::vector<PenOperation> operations_;
  std::vector<Segment> segments_;
  std::vector<std::uint32_t> borders_;  ///< declared after what its construction fills
  Box box_;
  std::array<Slices, 2> slices_;  ///< by x, by y
  Slices border_;                 ///< closed lines by y
  SegmentGrid grid_;
  std::vector<std::uint32_t> near_;
};

}  // namespace popcut
