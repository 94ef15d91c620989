// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/machines/machine.hpp"

namespace popcut {

/// A stretch of a line, mm along it.
struct Stretch {
  double from{}, to{};
};

/// How a straight fold was cut. Each list is sorted by `from`.
struct FoldState {
  double length_mm{};
  std::vector<Stretch> dashes;  ///< as drawn
  std::vector<Stretch> bare;    ///< may stay without a dash: clearance from ends and cuts
  std::vector<Stretch> cut;     ///< covered by cuts, which are checked separately
};

struct FoldFault {
  enum class Kind : std::uint8_t { NotDashed, TooOften, Solid, ToItsEnd };
  Kind kind{};
  Stretch where;
};

/// "not dashed", "dashed more often than it should be", ...
[[nodiscard]] std::string_view words_of(FoldFault::Kind kind);

/// The first fault of a fold: a bare stretch longer than the gap where clearance leaves room for a
/// dash; a dash longer than dash and gap together; more than `passes` dashes on each other; or a
/// dash nearer to an end than half the clearance. Lengths may exceed these bounds by `slack_mm`.
[[nodiscard]] std::optional<FoldFault> check_fold(const FoldState& fold, const DashShape& shape,
                                                  int passes, double slack_mm);

}  // namespace popcut
