// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/result.hpp"

namespace popcut {

/// What the name of a layer, a group or a line says about its lines.
enum class LayerMeaning : std::uint8_t {
  Wordless,  ///< nothing: "Layer 1", "path4242", "0"
  Unknown,   ///< it has words, and popcut knows none of them
  Ignore,
  Draw,
  Score,
  Fold,  ///< of unknown side
  FoldMountain,
  FoldValley,
  Cut,
  Outline,
};

/// Decides by the words in a name, in any case and with or without accents: core/data/
/// layer_words.json has them in many languages. Words are runs of letters, parts of "valleyFold"
/// and "Schnittlinie", and what stands anywhere in scripts without blanks. A fold wins over a cut,
/// because a wrong cut cannot be undone. "No cut" means nothing to cut; "no fold" and "cut without
/// fold" are Unknown. So is a single letter other than M and V, the folds of FOLD. Text that is not
/// UTF-8 counts as Latin-1.
[[nodiscard]] LayerMeaning layer_meaning(std::string_view name);

/// Whether a name is the letter M or V, perhaps with a number: the folds in FOLD and crease
/// patterns. Beside such a name, the letters B and C (`is_letter_of_cut`) are border and cut.
[[nodiscard]] bool is_letter_of_fold(std::string_view name);
[[nodiscard]] bool is_letter_of_cut(std::string_view name);

/// Whether it says what is done with the lines, or that nothing is.
[[nodiscard]] constexpr bool is_known(LayerMeaning meaning) {
  return meaning != LayerMeaning::Wordless && meaning != LayerMeaning::Unknown;
}

/// What a known meaning, other than Ignore, does. A fold of unknown side is a valley fold.
[[nodiscard]] Operation operation_of(LayerMeaning meaning);

/// The words of a name in lower case without accents: "Kiss_Cut" and "kiss cut" are one name.
[[nodiscard]] std::string layer_key(std::string_view name);

/// Meanings that a person gave to names, by `layer_key`.
using LayerUses = std::map<std::string, LayerMeaning, std::less<>>;

/// Reads "Wing=fold; Notes=ignore". The uses are cut, outline, score, fold, fold-mountain,
/// fold-valley, draw and ignore; "mountain" and "valley" are folds, too.
///
/// @retval Usage  no name, no use, or an unknown one; place is /options/layers
[[nodiscard]] Result<LayerUses> parse_layer_uses(std::string_view text);

/// A meaning that a person gave to a colour.
struct ColourUse {
  std::optional<std::uint32_t> rgb;  ///< 0xRRGGBB
  std::optional<int> index;          ///< AutoCAD's
  LayerMeaning use{};
};

/// Reads "red=fold-mountain; #00f=fold-valley; colour 30=score", with the uses of
/// `parse_layer_uses`. A colour is one of CSS, or an AutoCAD colour index.
///
/// @retval Usage  no colour, no use, or an unknown one; place is /options/colors
[[nodiscard]] Result<std::vector<ColourUse>> parse_colour_uses(std::string_view text);

/// What `uses` say of a colour, or of an AutoCAD colour index; none: nothing.
[[nodiscard]] std::optional<LayerMeaning> use_of_colour(std::span<const ColourUse> uses,
                                                        std::uint32_t rgb);
[[nodiscard]] std::optional<LayerMeaning> use_of_index(std::span<const ColourUse> uses, int index);

/// The values of an AutoCAD colour index: 1 to 7 are red, yellow, green, cyan, blue, magenta, and
/// black or white. Green has two values, because that of CSS is darker. None for the others.
[[nodiscard]] std::optional<std::array<std::uint32_t, 2>> values_of_index(int index);

/// How `parse_colour_uses` reads an AutoCAD colour index: "#ff0000", "colour 30".
[[nodiscard]] std::string index_text(int index);

/// What `uses` says of a name, else `layer_meaning`.
[[nodiscard]] LayerMeaning meaning_of_name(const LayerUses& uses, std::string_view name);

/// What is wrong with names that nobody knows beside names with a meaning, and what to type.
[[nodiscard]] std::string unknown_names(std::span<const std::string> names);

/// The warning of a drawing whose names are all unknown, where its lines have different ones: they
/// are cut.
/// @param names  at least one
[[nodiscard]] std::string only_unknown_names(std::span<const std::string> names);

}  // namespace popcut
