// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/fit/triangle_soup.hpp"
#include "core/pattern/pattern.hpp"
#include "core/picture/slabs.hpp"

namespace popcut {

/// What is written beside the card: nothing; a bar of round millimetres on the floor before it; or
/// also the card's sizes along its edges, a caption and the legend of the colours.
enum class Labels : std::uint8_t { None, Bar, All };

/// The viewing direction of a picture of a deployed pattern, and the picture's size.
struct View {
  double azimuth_rad{
      0.5};  ///< direction of the eye, from straight ahead towards growing v; 0 < azimuth < pi/2
  double width_px{900.0};
  double px_per_mm{0.0};  ///< fixed scale in place of `width_px`; 0: fill the width
  Labels labels{Labels::None};
};

/// How a panel stands out from the others.
enum class PanelTone : std::uint8_t {
  Paper,
  Pale,  ///< it steps back behind those that are lit
  Lit,
  Loose,  ///< it does not hold in paper
};

/// A line of the pattern that is drawn over everything.
struct SceneLine {
  PatternVertex from, to;
  std::string colour;
  const Kite* kite{};  ///< that it lies on
};

/// What a scene shows beside the pattern.
struct SceneOptions {
  const TriangleSoup*
      ghost{};  ///< the target (`target_on_sheet`), drawn translucent at the design's angle
  const TriangleSoup* target{};     ///< panels are coloured by their distance from it; none: paper
  std::size_t most_panels{12'000};  ///< a pattern with more is drawn with wider strips and steps
  int places_across{3};  ///< so many places along and across each panel measure its distance
};

/// A pattern made ready to be drawn in any pose. Refers to the pattern and the ghost.
struct CardScene {
  const Pattern* pattern{};
  const TriangleSoup* ghost{};
  Slabs slabs;
  /// Mean distance from the target of each panel of each slab, mm; 0 for wall and ground. Empty:
  /// not measured.
  std::vector<std::vector<double>> error_mm;
  double largest_error_mm{};
  std::vector<PanelTone> tones;  ///< one a face; empty: all are paper
  std::vector<SceneLine> lines;
};
[[nodiscard]] CardScene card_scene(const Pattern& pattern, const SceneOptions& options = {});

/// Draws a scene opened to `psi_rad` (0 < psi_rad <= pi) as a shaded picture seen from the pop-up
/// side: parallel projection, v to the right, z up, the eye on the bisector of wall and ground and
/// at most 0.55 rad above the ground.
///
/// The painting order is exact, not sorted by depth (`cut_into_slabs`). Panels are lighter the more
/// they face the lamp and the nearer they are; what was cut out of wall and ground is dark. Colours
/// of errors are on a scale from 0 to `largest_error_mm`.
void write_deployed_svg(const CardScene& scene, double psi_rad, const View& view,
                        std::ostream& out);

/// Whether the scene's ghost is drawn at `psi_rad`: at the angle that the pattern is designed for.
[[nodiscard]] bool is_shown_at(const CardScene& scene, double psi_rad);

/// Width and height of that picture in px, not yet rounded up.
[[nodiscard]] std::array<double, 2> deployed_size_px(const CardScene& scene, double psi_rad,
                                                     const View& view);

/// A legend of the scene's colours of errors, 200 px wide and 44 px high, as an SVG group whose
/// upper left corner is (x, y); empty where nothing was measured.
[[nodiscard]] std::string error_legend(const CardScene& scene, double x, double y);

/// What a picture leaves out of a scene, in words; empty: nothing.
[[nodiscard]] std::string thinned_in_words(const CardScene& scene);

/// The card's size in words: "wall 50 x 80 mm, ground 60 x 80 mm".
[[nodiscard]] std::string card_in_words(const Pattern& pattern);

}  // namespace popcut
