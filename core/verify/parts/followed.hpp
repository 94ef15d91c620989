// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "core/verify/parts/assembled.hpp"

namespace popcut::verify {

/// A place of each body in space. The right page stays where its sheet is flat.
using BodyState = std::vector<Eigen::Isometry3d>;

/// A card of several parts on its way from shut to open.
struct Followed {
  std::vector<double> opening_rad;  ///< between the pages, ascending
  std::vector<BodyState> states;    ///< one an opening
  double gap_mm{};                  ///< largest gap that is left in a joint
  double first_gap_mm{};            ///< the same of the file's own angles, before correction
  std::string shut_stopped;         ///< why it does not shut; empty if it does
  std::string open_stopped;         ///< why it does not open flat
};

/// Bodies that nothing connects to the pages.
[[nodiscard]] std::vector<std::uint32_t> loose_bodies(const Assembled& card);

/// The parts put together, as one card that its joints hold.
///
/// @param therefore  what cannot be done if they do not: ", so ..."; may be empty
/// @retval Infeasible  the joints do not fit, or do not hold all parts
[[nodiscard]] Result<Assembled> whole_card(const JointModel& model, std::string_view therefore);

/// Moves the card from the opened pose that the file's fold angles give, by rigid bodies on closed
/// joints: Gauss-Newton steps at each opening, continued to both ends in steps that are halved
/// where a correction fails or lands elsewhere.
///
/// @param opening_rad  where to stop and look, ascending, between 0 and pi (both excluded)
[[nodiscard]] Followed follow(const Assembled& card, const std::vector<double>& opening_rad);

/// The opening between the pages in a state: pi less the fold angle of the spine.
[[nodiscard]] double opening_of(const Assembled& card, const BodyState& state);

/// Freedoms by the rank of the joints' equations, to first order.
struct JointRank {
  std::size_t degrees_of_freedom{};
  double largest_zero{}, smallest_nonzero{};  ///< singular values; 0: none
  bool is_clear{};                            ///< whether the gap between them is wide
};
[[nodiscard]] JointRank rank_of(const Assembled& card, const BodyState& state);

/// The rms by which the farthest point of each body moves under the play of folds in paper, mm:
/// lines that are `kLinePlay_mm` off, their ends `kEndPlay_mm`; both pages held. Weighted least
/// squares over all joints; empty where the joints do not hold all bodies.
///
/// @param points  some of each body, in it
[[nodiscard]] std::vector<double> play_mm(const Assembled& card, const BodyState& state,
                                          const std::vector<std::vector<Vec3>>& points);

inline constexpr double kLinePlay_mm = 0.1, kEndPlay_mm = 0.15;

}  // namespace popcut::verify
