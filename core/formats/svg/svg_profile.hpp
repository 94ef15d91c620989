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

/// What a stroke is for; none: it is left out.
using StrokeUse = std::optional<Operation>;

/// How a stroke is drawn: without gaps, with dashes, or with dashes of two lengths in turn
/// (dash-dot).
enum class LineStyle : std::uint8_t { Solid, Dashed, DashDot };

/// One rule of a profile: all that it names must hold. `Dashed` holds for dash-dot lines too.
struct StrokeRule {
  std::vector<std::uint32_t> colours;  ///< 0xRRGGBB, one of them; empty: any
  std::optional<LineStyle> line;
  std::string css_class;  ///< one of the element's own classes; empty: any
  StrokeUse use;
};

/// How a drawing says what its lines are for (a row of svg_profiles.json): `data-assignment` and
/// layer labels where `names` holds, then the first rule that fits, then `otherwise`.
struct StrokeProfile {
  std::string name, title;
  bool names{true};
  bool nearest{false};  ///< a stroke has the nearest of the rules' colours, else only the same one
  std::map<std::string, StrokeUse, std::less<>> labels;  ///< names of layers, see `plain_label`
  std::vector<StrokeRule> rules;
  StrokeUse otherwise{Operation::Cut};
  StrokeUse fills;  ///< the outline of what is filled and has no stroke
};

/// The built-in profiles and then those of the users' tables, which win.
///
/// @retval Malformed  a table is not of the form; place is a JSON pointer
[[nodiscard]] Result<std::vector<StrokeProfile>> all_stroke_profiles(
    const std::vector<std::string>& user_tables = {});

/// @retval Usage  no profile is called `name`; place is /options/svg-profile
[[nodiscard]] Result<StrokeProfile> find_stroke_profile(
    std::string_view name, const std::vector<std::string>& user_tables = {});

/// A label as it is compared: lower case, blanks and underscores as hyphens.
[[nodiscard]] std::string plain_label(std::string_view label);

/// What a layer's label means, if the profile knows it.
[[nodiscard]] std::optional<StrokeUse> use_of_label(const StrokeProfile& profile,
                                                    std::string_view label);

/// What a `data-assignment` means: B M V C F U J (FOLD), or an operation's name.
[[nodiscard]] std::optional<StrokeUse> use_of_assignment(std::string_view word);

/// What the first rule that fits says; none fits: nothing.
[[nodiscard]] std::optional<StrokeUse> use_of_stroke(const StrokeProfile& profile,
                                                     std::uint32_t rgb, LineStyle line,
                                                     std::string_view classes);

}  // namespace popcut
