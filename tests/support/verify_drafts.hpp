// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/verify/motion/motion.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"

namespace popcut::testing {

/// The report on a draft; a draft that cannot be read fails the test.
[[nodiscard]] VerifyReport verified(const FoldDraft& draft, const VerifyOptions& options = {});

/// All failures of one check, one per line.
[[nodiscard]] std::string failures(const VerifyReport& report, const std::string& name);

[[nodiscard]] bool passes(const VerifyReport& report, const std::string& name);

[[nodiscard]] bool has(const std::string& text, const std::string& part);

[[nodiscard]] std::size_t vertex_at(const FoldDraft& draft, double u, double v);
[[nodiscard]] std::size_t edge_between(const FoldDraft& draft, std::size_t a, std::size_t b);

/// One strip of paper, 10 wide, folded across at the places `at` by `turn_deg` each (+ valley),
/// in one pose. The pose gives the opening angle of its driving fold, the first valley.
[[nodiscard]] FoldDraft folded_strip(const std::vector<double>& at,
                                     const std::vector<double>& turn_deg);

/// A card with one V-fold on its crease (docs/geometry.md, section 7): apex O, slit B-A-C.
[[nodiscard]] FoldDraft splayed_card(double alpha, double psi);

/// Largest distance of a vertex between two poses whose largest panels are laid on each other, mm.
[[nodiscard]] double largest_difference(const verify::FoldModel& file, const verify::Sheet& sheet,
                                        const verify::Pose& opened, const verify::Pose& known);

}  // namespace popcut::testing
