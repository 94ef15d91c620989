// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/compare/comparison.hpp"
#include "core/compare/picture.hpp"

namespace popcut::likeness {

/// How a printed card looks beside the model that it shows (docs/hands.md, section 5).
struct PrintedFigures {
  double colour{};   ///< mean difference where both are seen: CIE L*a*b*, of 100
  double contour{};  ///< mean distance of the outlines, both ways: of the target's diagonal
  double cover{};    ///< share of the target's pixels at which the card shows paper or print
  /// The one figure: colour + contour + (1 - cover). 0 is the target itself.
  [[nodiscard]] double error() const { return colour + contour + (1.0 - cover); }
};

enum class Looks : std::uint8_t { Good, Fair, Poor };
/// The word for a figure. The thresholds were set on pictures (docs/hands.md, section 5).
[[nodiscard]] Looks looks(const PrintedFigures& figures);
[[nodiscard]] const char* name_of(Looks looks);

/// A layer of a card, printed with the target as it is seen along (1, 0, fall). It shows what lies
/// between the two depths first; else what is nearest in front of them; else behind.
struct PrintedLayer {
  Triangles triangles;
  double far_mm{}, near_mm{};  ///< x of the target
  double fall{};
  double bend{};    ///< at y, both depths are `bend * |y|` less
  double raised{};  ///< what is printed at y is that of a place `raised * |y|` nearer
};

/// A panel of a card, its triangles counter-clockwise on the printed side. There it shows the
/// target as it is seen square to it: what is at most `near_mm` off first, its outermost; else what
/// is nearest to the panel. Less than 0: bare paper.
struct PrintedPanel {
  Triangles triangles;
  double near_mm{};
};

/// A target in its colours, that printed structures are compared with. What is printed on a
/// structure is the target as it is seen along (1, 0, 1): a place of the structure has the colour
/// of the target's nearest point on the ray through it, or of bare paper where there is none
/// (`view_of_model` prints this). Light is in the colours, so both are lit alike.
///
/// Values in, values out, const: one target serves many threads, each with its own `Buffers`.
class PrintedTarget {
 public:
  /// @param triangles  must outlive this to be compared with layers or panels
  /// @param colours    of the triangles, one each; empty: clay
  PrintedTarget(Triangles triangles, std::span<const Rgb> colours, const Scene& scene);

  [[nodiscard]] bool is_unseen() const { return pixels_ == 0; }
  /// How much there is to see: how long the outlines, jumps of depth and borders of colours are
  /// together, from the mean view, in diagonals of the target. A back has less than a face.
  /// O(pixels of all views).
  [[nodiscard]] double detail() const;
  /// O(triangles + pixels of all views).
  [[nodiscard]] PrintedFigures measure(Triangles structure, Buffers& buffers) const;
  [[nodiscard]] PrintedFigures measure(Triangles structure) const {
    Buffers buffers;
    return measure(structure, buffers);
  }
  /// The same of layers. The pages below them are bare, and no part of the card.
  [[nodiscard]] PrintedFigures measure_layers(std::span<const PrintedLayer> layers) const;
  /// The same of panels, which are bare on their other side.
  [[nodiscard]] PrintedFigures measure_panels(std::span<const PrintedPanel> panels) const;

 private:
  using Lab = std::array<float, 3>;
  /// The target from one side: its colours, and a depth above `kNothing` where it is.
  struct Seen {
    Frame frame;
    DepthImage image, backdrop;
    std::vector<Lab> colour;
    ContourPixels outline;
    DistanceImage distances;
  };
  /// Triangles with their colours from one side; `is_better(here, before)`: which of two depths is
  /// shown.
  template <typename IsBetter>
  [[nodiscard]] Seen painted(const Frame& frame, Triangles triangles, std::span<const Lab> colours,
                             const IsBetter& is_better) const;
  /// All of the target from one side.
  [[nodiscard]] Frame frame_of(const View& view, int pixels) const;
  [[nodiscard]] Seen seen_from(const View& view, int pixels, Triangles triangles,
                               std::span<const Lab> colours) const;
  /// A place of the target moved up or down so that the look of a layer is along x.
  [[nodiscard]] Vec3 fallen(const PrintedLayer& layer, const Vec3& place) const;
  /// The target along the look of a layer, with the depths of the layer first.
  [[nodiscard]] Seen print_of(const PrintedLayer& layer) const;
  [[nodiscard]] Seen print_of(const PrintedPanel& panel) const;
  /// The colour at a place of the card; null: bare paper.
  [[nodiscard]] static const Lab* printed_at(const Seen& print, const Vec3& place);
  /// Draws a structure, and the print on wall and ground, as seen from a side; `own`: its colours.
  void draw_card(const Seen& seen, Triangles structure, DepthImage& image,
                 std::vector<Lab>& own) const;

  /// Draws pieces (with `triangles`) as `draw_card` a structure; `print_at(k, place)`: the colour
  /// of piece k at a place.
  template <typename Piece, typename PrintAt>
  void draw_pieces(const Seen& seen, std::span<const Piece> pieces, const PrintAt& print_at,
                   DepthImage& image, std::vector<Lab>& own) const;
  /// Compares what `draw_own` draws with the target, from all sides.
  template <typename Draw>
  [[nodiscard]] PrintedFigures compared(Buffers& buffers, const Draw& draw_own) const;

  Triangles triangles_;  ///< the caller's, for `print_of`
  std::vector<Lab> lit_;
  Scene scene_;
  Box box_;
  double diagonal_mm_{};
  Seen print_;  ///< along the diagonal
  std::vector<Seen> seen_;
  std::size_t pixels_{};
};

}  // namespace popcut::likeness
