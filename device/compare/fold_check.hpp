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

/// What was done to a straight fold. Each list is sorted by `from`.
struct FoldState {
  double length_mm{};
  std::vector<Stretch> dashes;  ///< as drawn
  std::vector<Stretch> bare;    ///< need no dash: clearance from ends and cuts
  std::vector<Stretch> cut;     ///< lie under cuts, which are judged by themselves
};

struct FoldFault {
  enum class Kind : std::uint8_t { NotDashed, TooOften, Solid, ToItsEnd };
  Kind kind{};
  Stretch where;
};

/// "not dashed", "dashed more often than it should be", ...
[[nodiscard]] std::string_view words_of(FoldFault::Kind kind);

/// The first thing that is wrong with a fold: a bare stretch longer than the gap, where clearance
/// leaves room for a dash; a dash longer than dash and gap together; more dashes over each other
/// than `passes`; a dash that comes nearer to an end than half the clearance. Lengths within
/// `slack` of these bounds are right.
[[nodiscard]] std::optional<FoldFault> check_fold(const FoldState& fold, const DashShape& shape,
                                                  int passes, double slack_mm);

}  // namespace popcut
