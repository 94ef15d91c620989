// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "core/geometry/vec.hpp"
#include "core/hands/fold_guide.hpp"
#include "core/hands/folding.hpp"
#include "core/pattern/pattern.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::judge {

/// A part of a card as a person has it on the table: flat, with its folds. On the sheet u and v are
/// the first and the second coordinate of the file.
struct GluePart {
  std::string name;
  Pattern sheet;           ///< flat: without a place in space
  hands::FoldGuide folds;  ///< its folds, and the waste that falls out of it
  /// Places of its faces in space, half open and nearly flat open; z is up.
  std::vector<Eigen::Isometry3d> half_open, open;
};

/// A tab of a card, and where it goes.
struct GlueTab {
  std::string letter;             ///< "A" is glued first
  std::size_t joint{};            ///< in the file
  std::size_t part{}, on_part{};  ///< of the tab, and of what it is glued on
  std::uint32_t face{}, on_face{};
  std::vector<Vec2> outline, place;  ///< on the two flat sheets, corner by corner
  bool on_front{};                   ///< it lies on the printed side of `on_part`
};

/// A slot of a part, and what it takes: a part that crosses it there.
struct GlueSlot {
  std::size_t joint{};         ///< in the file
  std::size_t part{}, onto{};  ///< what comes down, and what is there
  std::array<Vec2, 2> line;    ///< the slot on the flat sheet of `part`, from its open end
};

enum class GlueStepKind : std::uint8_t { Fold, Slide, Glue };

struct GlueStep {
  GlueStepKind kind{};
  std::size_t part{};                 ///< that is folded, or added to what stands
  std::vector<std::size_t> with;      ///< parts that are added with it
  std::vector<std::size_t> slots;     ///< of a slide step: indices into `GlueGuide::slots`
  Vec3 up{0.0, 0.0, 0.0};             ///< of a slide step: where it comes from, on the `open` card
  std::vector<std::uint32_t> folds;   ///< of a fold step: indices into `GluePart::folds.folds`
  std::vector<std::size_t> tabs;      ///< of a glue step: indices into `GlueGuide::tabs`
  std::vector<std::size_t> standing;  ///< of a slide or glue step: the parts that are there before
  std::string words;
};

/// An order in which a person folds and glues a card of several parts. The first part is the card.
struct GlueGuide {
  std::string name;
  std::vector<GluePart> parts;
  std::vector<GlueTab> tabs;    ///< in the order of gluing
  std::vector<GlueSlot> slots;  ///< in the order in which parts slide onto others
  std::vector<GlueStep> steps;
};

/// Orders the work on a card of several parts, from its FOLD file (docs/parts.md). First all parts
/// are folded. Then parts that cross in slots are put together, in the order of `slide_order`: each
/// comes down from straight above. Last, each part, or what was put together, is glued on what is
/// there. That order is that of `glue_order`: backwards, each can be taken off with room for a
/// finger at its tabs, as far as there is one.
///
/// @retval Malformed, OutOfRange  as `verify::read_joint_model`, or too many folds or parts
/// @retval Infeasible  the joints do not hold all parts, or the card does not open, or parts that
///                     cross in slots cannot be put together from above
[[nodiscard]] Result<GlueGuide> glue_guide(std::string_view fold_text,
                                           const Progress& progress = {});

/// What it takes to fold and glue it.
[[nodiscard]] hands::Handwork handwork(const GlueGuide& guide,
                                       const hands::Hands& hands = hands::built_in_hands());

/// The guide as a JSON document: `parts` (`name`, `waste`, `folds` as in `fold_guide_json`), `tabs`
/// (`letter`, `part`, `on`, `outline_mm`, `place_mm` as [u, v] on their sheets) and `steps`
/// (`kind`, `part`, `with`, `words`, `folds`, `tabs`, and `onto`: the parts that it slides onto).
[[nodiscard]] std::string glue_guide_json(const GlueGuide& guide);

/// "fold", "slide" or "glue".
[[nodiscard]] std::string_view name_of(GlueStepKind kind);

}  // namespace popcut::judge
