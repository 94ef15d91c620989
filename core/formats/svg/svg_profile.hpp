// SPDX-License-Identifier: MIT
#pragma once

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
/// layer labels if `names`, else by the first rule that fits, else `otherwise`.
struct StrokeProfile {
  std::string name, title;
  bool names{true};
  bool nearest{
      false};  ///< true: match the nearest of the rules' colours; false: only the exact colour
  std::map<std::string, StrokeUse, std::less<>> labels;  ///< layer labels, see `plain_label`
  std::vector<StrokeRule> rules;
  StrokeUse otherwise{Operation::Cut};
  StrokeUse fills;   ///< the outline of shapes with a fill and no stroke
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

/// A label in the form used for comparison: lower case, spaces and underscores as hyphens.
[[nodiscard]] std::string plain_label(std::string_view label);

/// The name of a layer from the id that Illustrator makes of it: `_x5F_` is the character 5F (hex),
/// `_2_` at the end tells two of the same name apart, other underscores are spaces.
[[nodiscard]] std::string illustrator_name(std::string_view id);

/// What a layer's label means; none if the profile does not know it.
[[nodiscard]] std::optional<StrokeUse> use_of_label(const StrokeProfile& profile,
                                                    std::string_view label);

/// What a `data-assignment` means: B M V C F U J (FOLD), or the name of an operation.
[[nodiscard]] std::optional<StrokeUse> use_of_assignment(std::string_view word);

/// What the first rule that fits says; none if no rule fits.
[[nodiscard]] std::optional<StrokeUse> use_of_stroke(const StrokeProfile& profile,
                                                     std::uint32_t rgb, LineStyle line,
                                                     std::string_view classes);

}  // namespace popcut
