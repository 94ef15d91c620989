// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/artwork/colour_image.hpp"
#include "core/artwork/colour_mesh.hpp"
#include "core/artwork/face_pixels.hpp"
#include "core/artwork/model_view.hpp"
#include "core/artwork/pixel_frame.hpp"
#include "core/progress.hpp"

namespace popcut {

/// What is printed on a pattern, on its page: x = v, y = u.
struct Artwork {
  PixelFrame frame;
  ColourImage image;
  std::vector<std::uint8_t> on_paper;  ///< one a pixel: 1 where the pattern is
};

/// How far colours go beyond the lines where they would end, since no cut is where it should be.
struct Trapping {
  double trap_mm{0.3};   ///< over a cut, to either side of it
  double bleed_mm{1.0};  ///< around the outline, at least `trap_mm`
};

/// The colour of the model's nearest point at each place of the opened structure.
///
/// @param mesh       in space: (x, v, z) of the opened card, mm
/// @param bare       faces that get no ink, one a face; empty: all are printed
/// @param light      its opening is a right one, as the mesh is in space
/// O(pixels log triangles).
[[nodiscard]] ColourImage nearest_colours(const ColourMesh& mesh, const FaceSurface& surface,
                                          const PixelFrame& frame, const Lighting& light,
                                          std::span<const std::uint8_t> bare = {},
                                          const Progress& progress = {});

/// An image laid over `box` of the page as it is: its first row along the top of the wall, its
/// first column along v = 0. Stretched in both directions to fit; no ink beyond.
[[nodiscard]] ColourImage laid_flat(const Texture& image, const Box& box, const PixelFrame& frame);

/// Which faces lie in the planes of wall and ground: one a face.
[[nodiscard]] std::vector<std::uint8_t> faces_of_card(const Pattern& pattern);

/// Traps a picture, so that a cut that is `trap_mm` off shows no bare paper and no sliver of what
/// is beyond it:
///
/// - beside each cut whose two sides have colours, each side's colour goes over into that of the
///   place mirrored at the cut: half and half at the cut, all its own from `trap_mm` on (where
///   `blends`: a picture that goes on over its cuts as if they were not there needs no blending);
/// - where one side has ink and the other has none, the ink goes `trap_mm` over the cut and past
///   its end; the outline of a picture that goes on over its cuts stays as it is where it crosses
///   one;
/// - around the pattern the outermost colours go on for `bleed_mm`.
///
/// Ink off the paper is taken away first.
///
/// @param face     of each pixel, see `face_pixels`
/// @param borders  further lines that ink goes over into what is bare, as it does over cuts
void trap(ColourImage& image, std::span<const std::uint32_t> face, std::span<const CutLine> cuts,
          std::span<const CutLine> borders, const PixelFrame& frame, const Trapping& how,
          bool blends);

/// Lets ink go on for a few pixels into what has none, so that a picture does not fade to white
/// within its own outline when it is looked at between pixels.
void grow(ColourImage& image, std::size_t pixels);

}  // namespace popcut
