// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace popcut {

/// A sheet size that has a name, upright.
struct Paper {
  const char* name;
  double width_mm, height_mm;
};

/// ISO 216 A0 to A6, the sizes of North America, and the cutters' own 12 x 12 and 12 x 24 inches.
inline constexpr std::array<Paper, 12> kPapers{{
    {"A0", 841, 1189},
    {"A1", 594, 841},
    {"A2", 420, 594},
    {"A3", 297, 420},
    {"A4", 210, 297},
    {"A5", 148, 210},
    {"A6", 105, 148},
    {"letter", 215.9, 279.4},
    {"legal", 215.9, 355.6},
    {"tabloid", 279.4, 431.8},
    {"12x12", 304.8, 304.8},
    {"12x24", 304.8, 609.6},
}};

/// The paper that `word` names, ignoring case: "a4", "Letter"; "A4-landscape" lies on its side.
/// Nothing if there is none.
[[nodiscard]] std::optional<Paper> find_paper(std::string_view word);

}  // namespace popcut
