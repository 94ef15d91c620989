// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/layout/partition.hpp"

namespace popcut {

/// A seam that turned out to be invalid when all tabs were placed; the search must not use it
/// again.
struct BannedSeam {
  bool vertical{};
  double at{}, from{}, to{};
  double reach_mm{};  ///< how far beside `at` the ban reaches
  [[nodiscard]] bool bans(const AxisLine& line, double a, double b) const {
    return vertical == line.vertical && line.at >= at - reach_mm && line.at <= at + reach_mm &&
           from < b && to > a;
  }
};

/// What the search must respect.
struct SearchLimits {
  double width_mm{}, height_mm{};  ///< size of the largest piece including its tabs
  TabShape tabs;
  double min_panel_mm{};
  std::vector<double> asked_x, asked_y;
  std::vector<BannedSeam> banned;
  bool swapped{false};  ///< x and y of the drawing are swapped; errors swap them back
  bool full{false};     ///< true: full pieces and a rest; false: pieces of equal size
};

/// The cost of a seam that cannot be.
inline constexpr double kNoSeam = std::numeric_limits<double>::infinity();
/// What one more piece costs, in mm of glue.
inline constexpr double kOnePieceMore = 300.0;

/// The cheapest seams and their cost.
struct FoundSeams {
  Partition partition;
  double cost{};  ///< mm of glue, plus the cost of crossings and pieces
};

/// What the sides of a column require of the rows that meet them: the stretches glued there.
struct ColumnEnds {
  std::vector<SeamStretch> left, right;
  double least_mm{};  ///< shortest stretch that a row may leave
  [[nodiscard]] bool allows(bool right_side, double y) const;
};

/// Cost of a straight seam in mm of glue; infinite if it is not valid.
[[nodiscard]] double seam_cost(LineIndex& lines, const SearchLimits& limits, const AxisLine& line,
                               double from, double to);

/// Finds the cheapest seams that leave no piece larger than the limits. Dynamic programming over
/// candidate lines (all parallel cuts and a grid) finds the columns, then the rows of each column.
/// Rows are straight, or they step along existing cuts where that is cheaper or the only valid way.
/// After a ban, `find` searches only where the ban changes something.
class SeamSearch {
 public:
  SeamSearch(LineIndex& lines, SearchLimits limits) : lines_(&lines), limits_(std::move(limits)) {}

  /// @retval Infeasible  there are no valid seams; the detail names the direction
  [[nodiscard]] Result<FoundSeams> find();
  void ban(const std::vector<BannedSeam>& seams);

 private:
  struct Lines {
    std::vector<double> at, costs;
  };
  struct Column {
    double left{}, right{};
    std::vector<double> met;  ///< y where the rows of the previous column end
    std::vector<StepSeam> seams;
    double cost{};
  };
  struct Chosen {
    std::vector<double> at;
    double cost{};
  };
  [[nodiscard]] Lines priced(bool vertical, double from, double to, const ColumnEnds* ends);
  [[nodiscard]] Result<Chosen> straight(bool vertical, const Lines& lines, double from, double to);
  [[nodiscard]] Result<Column> rows(double left, double right, std::vector<double> met);
  [[nodiscard]] std::vector<SeamStretch> glued(double x);

  LineIndex* lines_;
  SearchLimits limits_;
  std::optional<Lines> columns_;
  std::vector<Column> known_;
};

/// Stepped seams across a column and their cost in mm of glue.
struct SteppedRows {
  std::vector<StepSeam> seams;
  double cost{std::numeric_limits<double>::infinity()};
};

/// Finds the cheapest stepped seams across the column `left`..`right`. A seam has one height in
/// each strip between two lines along y, and changes it only along cuts. Each seam stays in its own
/// band, so that no piece is higher than the limit. Within a band the seam is a shortest path over
/// strips and heights: O(strips x heights).
[[nodiscard]] SteppedRows find_stepped(LineIndex& lines, const SearchLimits& limits,
                                       const ColumnEnds& ends, double left, double right);

}  // namespace popcut
