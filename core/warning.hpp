// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace popcut {

/// Where a warning applies. What is not known is left out.
struct WarningPlace {
  int sheet{};                           ///< of a plan, from 1; 0: all of them
  std::optional<double> u_mm{}, v_mm{};  ///< on the pattern
  std::string source{};                  ///< in the drawing: "svg/g[2]/path", "layer \"Fold\""

  [[nodiscard]] bool is_known() const { return sheet > 0 || u_mm || !source.empty(); }
};

/// What is not wrong, but may not be what the person wants.
struct Warning {
  std::string code;  ///< for programs: "no_unit", "force_out_of_range"; never changes its meaning
  std::string message;  ///< one sentence for people
  WarningPlace place{};
  bool spoils{false};  ///< the cut sheet may be useless: a person must accept it before the cut
};

/// Those of which a person must know before the cut.
[[nodiscard]] std::vector<Warning> spoiling(const std::vector<Warning>& warnings);
/// The messages alone.
[[nodiscard]] std::vector<std::string> messages_of(const std::vector<Warning>& warnings);

}  // namespace popcut
