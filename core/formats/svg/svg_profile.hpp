// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/formats/pens/layer_words.hpp"
#include "core/result.hpp"

namespace popcut {

/// What a stroke is for; none: ignore it.
using StrokeUse = std::optional<Operation>;

/// How a stroke is drawn: without gaps, with dashes, or with dashes of two alternating lengths
/// (dash-dot).
enum class LineStyle : std::uint8_t { Solid, Dashed, DashDot };

/// One rule of a profile. All conditions that it names must hold. `Dashed` includes dash-dot lines.
struct StrokeRule {
  std::vector<std::uint32_t> colours;  ///< 0xRRGGBB, any one of these; empty: all colours
  std::optional<LineStyle> line;
  std::string css_class;  ///< one of the element's own classes; empty: no condition
  StrokeUse use;
};

/// How a drawing says what its lines are for (a row of svg_profiles.json): by `data-assignment` and
/// names of layers, groups and lines if `names`, else by the first rule that fits, else
/// `otherwise`.
struct StrokeProfile {
  std::string name, title;
  bool names{true};
  bool nearest{
      false};  ///< true: match the nearest of the rules' colours; false: only the exact colour
  std::vector<ColourUse> colours{};  ///< what a person says of colours; before all rules
  LayerUses labels;                  ///< names whose meaning is another than that of their words
  std::vector<StrokeRule> rules;
  StrokeUse otherwise{Operation::Cut};
  StrokeUse fills;   ///< the outline of shapes with a fill and no stroke
  StrokeUse whites;  ///< white fills without a stroke; none: left out, as the page's background
  StrokeUse pages;   ///< dark fills that cover the page; none: left out
  bool asks{false};  ///< true: refuse several colours of solid strokes without a meaning
};

/// The built-in profiles, then those of the users' tables. A user's profile replaces a built-in one
/// of the same name.
///
/// @retval Malformed  a table is not valid; place is a JSON pointer
[[nodiscard]] Result<std::vector<StrokeProfile>> all_stroke_profiles(
    const std::vector<std::string>& user_tables = {});

/// @retval Usage  no profile has this name; place is /options/svg-profile
[[nodiscard]] Result<StrokeProfile> find_stroke_profile(
    std::string_view name, const std::vector<std::string>& user_tables = {});

/// The name of a layer from the id that Illustrator makes of it: `_x5F_` is the character 5F (hex),
/// `_2_` at the end tells two of the same name apart, other underscores are spaces.
[[nodiscard]] std::string illustrator_name(std::string_view id);

/// What the name of a layer, group or line means in a profile; Wordless if it ignores names.
[[nodiscard]] LayerMeaning meaning_of_label(const StrokeProfile& profile, std::string_view label);

/// What is done with lines of a known meaning.
[[nodiscard]] StrokeUse use_of(LayerMeaning meaning);

/// What a `data-assignment` means: B M V C F U J (FOLD), the name of an operation, or a word of a
/// layer.
[[nodiscard]] std::optional<StrokeUse> use_of_assignment(std::string_view word);

/// What the first rule that fits says; none if no rule fits.
[[nodiscard]] std::optional<StrokeUse> use_of_stroke(const StrokeProfile& profile,
                                                     std::uint32_t rgb, LineStyle line,
                                                     std::string_view classes);

}  // namespace popcut
