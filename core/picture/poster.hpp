// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <span>

#include "core/pattern/pattern.hpp"
#include "core/picture/deployed_svg.hpp"
#include "core/result.hpp"

namespace popcut {

/// The size of posters and films.
struct PosterOptions {
  int columns{3};
  double cell_px{420};  ///< width of the widest pose
  SceneOptions scene{.most_panels = 4'000};
};

/// Draws the poses side by side, all at one scale and from one side (`write_deployed_svg`), each
/// with its angle below in degrees; below them the name, the card's size and a bar of round
/// millimetres along the main fold.
///
/// @retval OutOfRange  no pose, more than 100, or one outside 0 < psi <= pi (`place` is its index)
[[nodiscard]] Result<void> write_poster_svg(const Pattern& pattern, std::span<const double> psi_rad,
                                            const PosterOptions& options, std::ostream& out);

/// Draws the poses one after the other in one place, as an SVG that plays by itself, there and
/// back, in browsers; programs that do not animate show the last pose.
///
/// @retval OutOfRange  as `write_poster_svg`
[[nodiscard]] Result<void> write_film_svg(const Pattern& pattern, std::span<const double> psi_rad,
                                          double seconds, const PosterOptions& options,
                                          std::ostream& out);

}  // namespace popcut
