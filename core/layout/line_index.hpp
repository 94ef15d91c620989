// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/layout/tabs.hpp"
#include "core/drawing/linework.hpp"
#include "core/geometry/segment_grid.hpp"

namespace popcut {

/// What lies closer to a line than this lies on it, mm.
inline constexpr double kOn = 1e-6;

/// Everything that a straight seam meets on its way.
struct SeamScan {
  std::vector<SeamStretch> covered;  ///< where a cut or an outline runs along it, merged and sorted
  std::vector<double> breaks;        ///< where lines end on it or cross it, sorted
  double fold_mm{};                  ///< folds that run along it: unlawful
  double sliver_mm{};                ///< lines beside it, nearer than the narrowest panel: unlawful
  std::uint32_t folds_crossed{}, cuts_crossed{};
};

/// The lines of a drawing, ready for questions that seams ask. Lines drawn with a pen do not count.
class LineIndex {
 public:
  /// `reach_mm`: how far tabs look around themselves.
  LineIndex(const LineWork& work, double reach_mm);

  /// What the line meets between `from` and `to`.
  void scan(const AxisLine& line, double from, double to, double min_panel_mm, SeamScan& out) const;

  /// How far one can go from the line to `side` over `from`..`to` until the first line, at most
  /// `most` mm.
  [[nodiscard]] double free_depth(const AxisLine& line, double from, double to, int side,
                                  double most);

  /// Whether the sheet is there: inside an odd number of closed lines, or, where the drawing has
  /// none, inside its box.
  [[nodiscard]] bool is_paper(const PagePoint& p) const;

  /// The segments that reach into the strip between two lines along y (`by_x`) or x, touching it
  /// included, each once. O(k) for what lies in and near the strip.
  [[nodiscard]] std::vector<std::uint32_t> between(bool by_x, double from, double to) const;

  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] std::span<const Segment> segments() const { return segments_; }
  [[nodiscard]] Operation operation(std::size_t i) const { return operations_[i]; }

 private:
  // Segments by slices of one coordinate: a seam looks into one. Within a slice the long ones come
  // first, the others by where they begin along it, with how far any up to there reaches.
  struct Slices {
    double from{}, width{1.0};
    std::vector<std::uint32_t> first, items;
    std::vector<std::uint32_t> first_short;
    std::vector<double> begin, reach;
    [[nodiscard]] std::size_t slice(double at) const;
    [[nodiscard]] std::size_t size(std::size_t k) const { return first[k + 1] - first[k]; }
    [[nodiscard]] std::span<const std::uint32_t> of(double at) const;
  };
  void sort_slices(bool by_x, Slices& slices) const;
  template <typename Visit>
  void visit(const AxisLine& line, double from, double to, Visit&& visit) const;
  [[nodiscard]] Slices slices(bool by_x, const std::vector<std::uint32_t>& which,
                              double reach) const;

  std::vector<Operation> operations_;  ///< before the segments, which are made with them
  std::vector<Segment> segments_;
  Box box_;
  std::array<Slices, 2> slices_;  ///< by x, by y
  Slices border_;                 ///< closed lines by y
  bool has_border_{false};
  SegmentGrid grid_;
  std::vector<std::uint32_t> near_;
};

}  // namespace popcut
