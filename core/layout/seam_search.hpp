// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "core/layout/partition.hpp"

namespace popcut {

/// A seam that turned out to be unlawful when all tabs were placed: not to be taken again.
struct BannedSeam {
  bool vertical{};
  double at{}, from{}, to{};
  double reach_mm{};  ///< beside `at` that is banned too
  [[nodiscard]] bool bans(const AxisLine& line, double a, double b) const {
    return vertical == line.vertical && line.at >= at - reach_mm && line.at <= at + reach_mm &&
           from < b && to > a;
  }
};

/// What the search has to keep to.
struct SearchLimits {
  double width_mm{}, height_mm{};  ///< of the largest piece, tabs included
  TabShape tabs;
  double min_panel_mm{};
  std::vector<double> asked_x, asked_y;
  std::vector<BannedSeam> banned;
  bool swapped{false};  ///< x and y of the drawing have changed places, for what errors say
  bool full{false};     ///< rather full pieces and a rest than pieces of one size
};

struct FoundSeams {
  Partition partition;
  double cost{};  ///< mm of glue, with what crossings and pieces are worth in it
};

/// What the sides of a column ask of the rows that meet them: the stretches that are glued there.
struct ColumnEnds {
  std::vector<SeamStretch> left, right;
  double least_mm{};  ///< no stretch may be parted into less
  [[nodiscard]] bool lawful(bool right_side, double y) const;
};

/// What a straight seam costs, in mm of glue; infinite where it is unlawful.
[[nodiscard]] double seam_cost(LineIndex& lines, const SearchLimits& limits, const AxisLine& line,
                               double from, double to);

/// Finds the cheapest seams that leave no piece larger than the limits: columns by dynamic
/// programming over candidate lines (all cuts parallel to them and a grid), then rows in each
/// column, straight, or stepped along existing cuts where that is cheaper or nothing else is
/// lawful. Asked again after a ban it looks again only where that changes something.
class SeamSearch {
 public:
  SeamSearch(LineIndex& lines, SearchLimits limits) : lines_(&lines), limits_(std::move(limits)) {}

  /// @retval Infeasible  there are none; the detail says in which direction
  [[nodiscard]] Result<FoundSeams> find();
  void ban(const std::vector<BannedSeam>& seams);

 private:
  struct Lines {
    std::vector<double> at, costs;
  };
  struct Column {
    double left{}, right{};
    std::vector<double> met;  ///< y of the rows of the column before, where they end
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

}  // namespace popcut
