// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut::hands {

/// A fold as a hand makes it: a straight line between two cuts.
struct GuideFold {
  PatternVertex from, to;
  EdgeRole role{};                    ///< Mountain: toward the eye that sees the pop-up side
  std::vector<std::uint32_t> panels;  ///< on its sides: faces of the pattern, ascending
  [[nodiscard]] bool is_mountain() const { return role == EdgeRole::Mountain; }
  [[nodiscard]] double length_mm() const;
};

enum class StepKind : std::uint8_t {
  Waste,   ///< take out what is cut off
  Crease,  ///< fold each of its folds to and fro
  Push     ///< while the card shuts, push panels
};
/// From where a person sees the panels of a step best, before the standing card.
enum class LookFrom : std::uint8_t { Right, Left };
/// The side of the sheet that is pushed.
enum class PushFrom : std::uint8_t { Behind, Front };

struct GuideStep {
  StepKind kind{};
  std::vector<std::uint32_t> folds;   ///< to crease: indices into `FoldGuide::folds`
  std::vector<std::uint32_t> panels;  ///< to light: faces of the pattern, none of wall and ground
  LookFrom look_from{};
  PushFrom push_from{};  ///< of a push
  std::string words;     ///< one or two sentences
};

/// An order in which a person folds a card.
struct FoldGuide {
  std::vector<GuideFold> folds;
  std::vector<std::vector<std::uint32_t>> waste;  ///< vertices around each piece
  std::vector<GuideStep> steps;
  bool stands{true};  ///< false: the pattern says only how it lies flat, so no side is better
};

/// A step creases no more folds.
inline constexpr std::size_t kMostFoldsAStep = 8;
/// Nobody folds more of them by hand.
inline constexpr std::size_t kMostGuideFolds = 2000;

/// Orders the folds of a pattern (docs/hands.md, section 3): the waste first; then the creases,
/// from wall and ground inward, figure by figure; then what to push while the card shuts. A flat
/// sheet without wall and ground is a net: its last step folds it up.
///
/// A figure is all that stands in one stretch along the spine. A fold comes after those that lead
/// to it from wall and ground by the fewest panels: these push it. Folds equally far in that lie
/// beside each other along the spine come in one step; in it, those nearer to the spine come first,
/// since panels farther from it hide them while the card is half folded. A step looks from the side
/// where less hides its panels. O(edges log edges), and for each step O(faces).
///
/// @retval OutOfRange  more than `kMostGuideFolds` folds
[[nodiscard]] Result<FoldGuide> fold_guide(const Pattern& pattern);

/// Guides as one JSON document, one card each: `folds` (`from` and `to` on the sheet as [u, v] in
/// mm, `sense`) and `steps` (`kind`, `words`, `folds`, `panels`, `look_from`, and of a push
/// `push_from`).
[[nodiscard]] std::string fold_guide_json(std::span<const FoldGuide> guides,
                                          std::span<const Pattern> patterns);

/// "mountain" or "valley".
[[nodiscard]] std::string_view sense_of(const GuideFold& fold);
/// "waste", "crease" or "push".
[[nodiscard]] std::string_view name_of(StepKind kind);
/// "right" or "left".
[[nodiscard]] std::string_view name_of(LookFrom side);

}  // namespace popcut::hands
