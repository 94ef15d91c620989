// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/compare/comparison.hpp"
#include "core/compare/picture.hpp"
#include "core/model/triangle_mesh.hpp"

namespace popcut {

/// A way for a model to stand in the corner of a card: turned, then moved so that its box touches
/// wall and ground and begins at 0 along the spine. Lengths are in units of the model.
struct Way {
  std::array<double, 3> rotate_deg{};  ///< as `TargetPlacement`
  MeshBox box;                         ///< of the turned model, before it is moved
  double shut_reach{};                 ///< the largest x + z: how far it reaches when shut
  double misfit{};                     ///< `misfit_of`
  double detail{};                     ///< `detail_of`, where it was asked for
  std::optional<double> roof_off{};    ///< `roof_off_of`

  [[nodiscard]] double length() const { return box.high[1] - box.low[1]; }
  /// From units of the model to those of `standing_model`, in which the box's diagonal is 100 mm.
  [[nodiscard]] double to_target() const;
};

/// The way of a turn. O(triangles).
[[nodiscard]] Way way_of(const TriangleMesh& model, const std::array<double, 3>& rotate_deg);

/// The model as it stands, nine numbers a triangle (x, v, z), 100 mm large.
[[nodiscard]] std::vector<float> standing_model(const TriangleMesh& model, const Way& way);

/// What is seen along the diagonal of a model that stands, as a surface: no card of one sheet shows
/// more of it. A net of `points` x `points`, torn where the depth jumps.
[[nodiscard]] std::vector<float> seen_along_diagonal(const std::vector<float>& standing,
                                                     int points);

/// How well a way suits cards: the error (`likeness::Figures::error`) of the part of the model that
/// is seen along the diagonal, from nine directions, 64 pixels wide.
[[nodiscard]] double misfit_of(const TriangleMesh& model, const Way& way);

/// How much there is to see of a model from where people look at a card (`PrintedTarget::detail`).
/// @param colours  of the triangles, one each; empty: clay
[[nodiscard]] double detail_of(const TriangleMesh& model, std::span<const likeness::Rgb> colours,
                               const Way& way);
/// The ways that show nearly as much as the one that shows most (`Way::detail`), without those that
/// show less than their back. What is seen of the back of a cat fits a card as well as its face
/// does, and nobody wants that card.
[[nodiscard]] std::vector<Way> telling_ways(std::vector<Way> ways);

/// How far a model must stand off the wall, in its own units, so that its largest roof can be a
/// sloped panel (`plan_kites`). None: it has no roof, or stands better without.
[[nodiscard]] std::optional<double> roof_off_of(const TriangleMesh& model, const Way& way);
/// The way as far off the wall as its roof asks.
[[nodiscard]] Way off_wall(Way way);

/// Which side of a model is up, as a direction along one of its axes; none: any of them may be.
using UpSide = std::optional<std::array<int, 3>>;

/// Which side of a model faces away from the wall, likewise.
using FrontSide = UpSide;

/// The words for both: "any", or an axis with its sign.
[[nodiscard]] const std::vector<std::string>& up_words();
/// @param word  one of `up_words`
[[nodiscard]] UpSide up_side(const std::string& word);

/// For `up`: as files of its kind usually stand, y for OBJ and glTF, z for STL.
inline constexpr const char* kUsualUp = "usual";
/// `up_words`, and `kUsualUp` before them.
[[nodiscard]] const std::vector<std::string>& up_choices();
/// The one of `up_words` that is meant for a file. "any" where its name does not tell, or the front
/// lies along that axis.
/// @param up, front  one of `up_choices`, of `up_words`
[[nodiscard]] std::string up_for_file(const std::string& up, std::string_view file,
                                      const std::string& front);

/// The turns by right angles: 24, or the four that leave `up` upright or put `front` in front, or
/// the one that does both. None where both are along one axis.
[[nodiscard]] std::vector<std::array<double, 3>> upright_turns(const UpSide& up,
                                                               const FrontSide& front = {});
/// Turns near one of them: about the vertical, and where `tilts`, about the other axes too.
[[nodiscard]] std::vector<std::array<double, 3>> turns_near(const std::array<double, 3>& turn,
                                                            bool tilts);

/// Up to `count` ways, the least misfit first. Of those that suit equally, as of a shape that looks
/// alike from several sides, the first is taken.
[[nodiscard]] std::vector<Way> best_ways(std::vector<Way> ways, std::size_t count);

}  // namespace popcut
