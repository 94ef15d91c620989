// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/verify.hpp"

namespace popcut {

struct PartsVerifyOptions {
  std::size_t degrees_of_freedom{1};  ///< required number
  std::size_t openings{60};           ///< at which crossings are looked for
  Progress progress{};
};

/// A card whose panels move by more, where folds are 0.1 mm off their lines, is loose: a note says
/// so.
inline constexpr double kHolds_mm = 1.0;

/// What a card of several parts is, and whether it is sound.
struct PartsVerifyReport {
  std::vector<std::string> names;   ///< of the parts
  std::vector<VerifyReport> parts;  ///< their flat sheets
  std::vector<VerifyCheck> checks;  ///< of the glued whole
  std::vector<std::string> notes;
  std::size_t joints{}, tabs{}, folds{};
  std::optional<std::size_t> degrees_of_freedom;
  double largest_zero{}, smallest_nonzero{};  ///< singular values
  double gap_mm{};                            ///< largest in a joint on the way
  double from_deg{}, to_deg{};                ///< openings that it was followed through
  double page_mm{};                           ///< of the smaller page, from the spine outward
  double closed_mm{};                         ///< how far the parts reach from the spine when shut
  std::size_t stack_layers{};                 ///< of paper in the thickest place of the shut card
  double stack_mm{};
  std::optional<double> wobble_mm;  ///< the largest of a panel, open
  std::string wobbles_most;         ///< its part

  [[nodiscard]] bool ok() const;
  /// How many things fail, over all checks.
  [[nodiscard]] std::size_t failed() const;
};

/// Judges a card of several parts from its FOLD file alone (docs/parts.md). The first part is the
/// card: two pages with a fold between them.
///
///     parts      each is one piece of paper, sound and flat
///     joints     everything hangs on the pages, and what is glued twice fits
///     tabs       each lies on paper of one panel, and on no other tab
///     opening    rigid panels on closed joints move from shut to open, followed from the pose that
///                the fold angles give
///     degrees_of_freedom   by the rank of the joints' equations
///     slots      what slides through a slit stays in it
///     crossing   no face passes through another, at `openings` places on the way
///     closed     shut, all lies inside the pages
///
/// @retval Malformed, OutOfRange  as `read_joint_model`
[[nodiscard]] Result<PartsVerifyReport> verify_parts(std::string_view fold_text,
                                                     const PartsVerifyOptions& options = {});

/// The report as text: a line a part that fails and a line a check, with the first failures.
[[nodiscard]] std::string verify_text(const PartsVerifyReport& report);
/// The report as a JSON document.
[[nodiscard]] std::string verify_json(const PartsVerifyReport& report);

}  // namespace popcut
