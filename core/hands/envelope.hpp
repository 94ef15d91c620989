// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string_view>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut::hands {

/// A shut card: along the spine, from the spine outward, and how high its stack of paper is.
struct ShutCard {
  double along_mm{}, out_mm{}, stack_mm{};
};

/// The room that an envelope leaves beside a card: `kEase_mm` in all, and the height of the stack,
/// by which paper that goes around it is shorter across.
inline constexpr double kEase_mm = 4.0;

/// The outside of the envelope that is asked for: "fit", a name (A2, A6, A7, 5x7, DL, C6, C5), or
/// width and height such as "120x170". Names are sizes of envelopes, but "5x7": that of a card of
/// 5 x 7 inches. The longer side of the card lies along the longer side of the envelope.
///
/// @return mm, the longer side first
/// @retval Usage       neither
/// @retval Infeasible  the card is too large for it: with the least that holds it
[[nodiscard]] Result<std::array<double, 2>> envelope_mm(std::string_view asked,
                                                        const ShutCard& card);

/// The net of an envelope in one sheet: a front, side flaps that are glued below a back, which
/// covers seven tenths of the front, and a flap that closes over it. A stack above `kFlat_mm` gets
/// walls of its height between them, each between two folds.
///
/// All folds are mountains seen from outside, by 180 degrees, or 90 at walls. Its outside is
/// printed.
///
/// @param outside_mm  of the front, the longer side first, as `envelope_mm` gives it
[[nodiscard]] Pattern envelope(const ShutCard& card, std::array<double, 2> outside_mm);
inline constexpr double kFlat_mm = 1.5;

/// A cover: two boards around a shut card with a back between them, as wide as the stack. Its
/// pages are glued to the boards, which go past them by `kPast_mm`.
[[nodiscard]] Pattern cover(const ShutCard& card);
inline constexpr double kPast_mm = 2.0;

}  // namespace popcut::hands
