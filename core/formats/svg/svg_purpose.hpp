// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/syntax/svg_notes.hpp"
#include "core/formats/svg/svg_profile.hpp"
#include "core/formats/svg/svg_style.hpp"

namespace popcut {

/// What a shape is for.
struct SvgPurpose {
  StrokeUse use;
  bool fill{false};  ///< its outline is that of its fill, for it has no stroke
};

/// Works out what the shapes of one drawing are for: by their names, else by the profile.
class SvgPurposes {
 public:
  SvgPurposes(const SvgText& text, const StrokeProfile& profile, SvgNotes& notes)
      : text_(text), profile_(profile), notes_(notes) {}

  /// What the shape `e` is for; none where it cannot be seen or its fill does not count, which is
  /// noted.
  [[nodiscard]] std::optional<SvgPurpose> of(const SvgElement& e, const SvgStyle& style,
                                             const SvgDashes& dashes);
  /// Whether any shape until now had a name.
  [[nodiscard]] bool has_names() const { return has_names_; }
  /// A warning where strokes of several colours were all taken for the same; else empty.
  [[nodiscard]] std::string colour_warning() const;

 private:
  const SvgText& text_;
  const StrokeProfile& profile_;
  SvgNotes& notes_;
  std::vector<std::uint32_t> colours_;  ///< the first of those that no rule knows
  bool has_names_{false};
};

}  // namespace popcut
