// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/compare/depth_image.hpp"
#include "core/compare/view.hpp"

namespace popcut::likeness {

/// A pixel of the target counts as covered within this share of the target's diagonal, and depth
/// jumps by this much at a contour.
inline constexpr double kWithin = 0.02;
inline constexpr double kSide = 1.25;   ///< of an image, in diagonals of the target
inline constexpr double kTouch = 1e-4;  ///< of the diagonal: what is no nearer lies on the corner

/// How a target is looked at.
struct Scene {
  std::vector<View> views;  ///< at least one
  int pixels{512};          ///< along each side of an image, `kLeastPixels` to `kMostPixels`
  /// What stands behind both: a card's own wall and ground are no part of what is compared. None:
  /// there is nothing behind, and all of the structure counts.
  std::optional<Corner> corner{};
};

/// The figures of one view. Lengths in mm.
struct ViewFigures {
  Vec3 toward;
  double mean_mm{}, p95_mm{};  ///< of the depth difference, where both are seen
  double contour_mm{};         ///< mean distance of the contours, both ways
  double cover{};              ///< share of the target's pixels, 0 to 1
  double excess{};             ///< pixels that only the structure covers, over the target's
  std::size_t target_pixels{}, common_pixels{};
};

/// How far a structure is from a target, over all views.
struct Figures {
  double diagonal_mm{};  ///< of the box around the target
  double mean_mm{}, p95_mm{};
  double contour_mm{};
  double cover{};
  double excess{};
  std::vector<ViewFigures> views;

  /// Shares of the diagonal.
  [[nodiscard]] double surface() const { return mean_mm / diagonal_mm; }
  [[nodiscard]] double surface95() const { return p95_mm / diagonal_mm; }
  [[nodiscard]] double contour() const { return contour_mm / diagonal_mm; }
  /// The one figure: surface + contour + (1 - cover). 0 is the target itself.
  [[nodiscard]] double error() const { return surface() + contour() + (1.0 - cover); }
};

/// The memory of a comparison, kept from one to the next. One for each thread.
struct Buffers {
  DepthImage image;
  ContourPixels contours;
  DistanceImage distances;
  std::vector<float> differences, of_view;
};

/// A target that structures are compared with: what each view shows of it is drawn once.
///
/// Images are square, 1.25 diagonals of the target wide, around the middle of its box, whatever the
/// structure: figures of several structures can be ranked. What lies outside of them is not seen.
///
///     surface  |depth difference| where both are seen in front of the corner: mean and 95 %
///     contour  outlines against the corner or nothing, and where depth jumps by `kWithin`: mean
///              distance of those of one from the nearest of the other, both ways; a diagonal at
///              most, and where only one of both has any
///     cover    share of the target's pixels at which the structure is seen within `kWithin`
///     excess   pixels at which only the structure is seen, over the target's pixels: no part of
///              the error, which it enters by its contours alone
///
/// Depth differences and cover are taken over all pixels of all views, the contour is the mean of
/// the views. Where no pixel shows both, the surface is a whole diagonal off.
///
/// Values in, values out, const: one target serves many threads, each with its own `Buffers`.
class Target {
 public:
  Target(Triangles triangles, const Scene& scene);

  /// None of the views shows any of it in front of the corner: nothing can be measured.
  [[nodiscard]] bool is_unseen() const { return seen_pixels_ == 0; }
  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

  [[nodiscard]] Figures measure(Triangles structure, Buffers& buffers) const;
  [[nodiscard]] Figures measure(Triangles structure) const {
    Buffers buffers;
    return measure(structure, buffers);
  }

  /// What is compared in view `k`: depths in front of the corner, elsewhere `kNothing`.
  [[nodiscard]] const DepthImage& image(std::size_t k) const { return seen_[k].image; }
  [[nodiscard]] Frame frame(std::size_t k) const;
  /// The same image of a structure.
  void draw_view(std::size_t k, Triangles structure, DepthImage& image) const;

 private:
  struct Seen {
    DepthImage image, backdrop;
    ContourPixels contours;
    DistanceImage distances;
    std::size_t pixels{};
  };
  [[nodiscard]] ViewFigures measure_view(std::size_t k, Triangles structure, Buffers& buffers,
                                         std::size_t& covered, std::size_t& beyond) const;

  Scene scene_;
  Box box_;
  double diagonal_mm_{};
  std::vector<Seen> seen_;
  std::size_t seen_pixels_{};
};

/// The triangles that are not in ground or wall: those with a corner more than `touch_mm` in front
/// of both.
[[nodiscard]] std::vector<float> without_card(Triangles triangles, const Corner& corner,
                                              double touch_mm);

}  // namespace popcut::likeness
