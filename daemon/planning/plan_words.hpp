// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/plan/marks.hpp"
#include "core/plan/order/order.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace popcut::planning {

/// What the options about the order of strokes were given as.
struct OrderWords {
  std::string method{"quick"};
  double effort{1.0};
  std::uint64_t seed{1};
  bool mat_free{false};
  bool progress{true};                       ///< on a terminal, once it takes over two seconds
  std::function<bool(double)> keep_going{};  ///< as in `OrderOptions`; none: it runs to its end
};

/// The search that they ask for.
///
/// @retval Usage  the word is not known, or the effort is not from 0.01 to 1000
[[nodiscard]] Result<OrderOptions> order_options(const OrderWords& words);

/// What the options about the knife were given as.
struct KnifeWords {
  std::string folds, direction{"any"}, overcut, snap;
};

/// Puts what they say into `options`.
///
/// @retval Usage  a word or a number is none of those that are lawful
[[nodiscard]] Result<void> read_knife_words(const KnifeWords& words, PlanOptions& options);

/// What each tool holder of a sheet holds: a blade has its offset told to the firmware.
[[nodiscard]] std::vector<ToolKind> holders_for(const PlannedSheet& sheet);

/// What the options about drawings larger than the mat were given as.
struct SplitWords {
  std::vector<double> seams_x, seams_y;
  std::string labels{"auto"};
  bool never{false};
};

/// @retval Usage  a word is not known, a seam is no finite number, or seams without splitting
[[nodiscard]] Result<void> read_split_words(const SplitWords& words, PlanOptions& options);

/// The options about registration marks.
struct MarkWords {
  bool wanted{false};
  std::string form{"arm"};
};

/// The marks of a sheet; none where they are not wanted.
///
/// @retval Usage       the form is not known
/// @retval Infeasible  the sheet is too small
[[nodiscard]] Result<std::optional<MarkLayout>> read_mark_words(const MarkWords& words,
                                                                const Machine& machine,
                                                                std::array<double, 2> area_mm);

/// The words that say how an input becomes sheets, as a user gives them to `popcut plan` or to
/// popcutd. Errors about them name the option ("--mat") as their place.
struct PlanWords {
  std::string machine, material, mat, at, dialect;
  OrderWords order{};
  std::string svg_profile{"popcut"};
  double curve_tolerance_mm{0.02}, svg_dpi{96};
  bool clip{false};
  KnifeWords knife{};
  SplitWords split{};
  MarkWords marks{};
};

}  // namespace popcut::planning
