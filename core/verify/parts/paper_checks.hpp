// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/verify/parts/assembled.hpp"
#include "core/verify/parts/followed.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/tiling.hpp"

namespace popcut::verify {

/// Checks that each tab lies on paper of the panel that it is glued to, all of it, and that no two
/// tabs on one side of a panel lie on each other.
///
/// @param triangles  one a part
/// @param opened     an opened pose, which tells on what side of its panel a tab lies; nullptr:
/// none
///                   is known, and tabs are not compared with each other
void check_tabs(const JointModel& model, const Assembled& card,
                const std::vector<Triangles>& triangles, const BodyState* opened,
                VerifyCheck& check);

/// Checks that what slides through a slit stays in it: at every opening the paper of the second
/// face that lies on the slit's line is in the slit, and there is some. Of two faces that cross,
/// no place on the line has paper of both, each has some, and slots are as wide as the other's
/// paper needs when the card is open.
void check_slots(const JointModel& model, const Assembled& card, const Followed& motion,
                 VerifyCheck& check);

}  // namespace popcut::verify
