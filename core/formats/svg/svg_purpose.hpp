// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/svg_profile.hpp"
#include "core/formats/svg/svg_style.hpp"
#include "core/formats/svg/syntax/svg_notes.hpp"

namespace popcut {

/// What a shape is for.
struct SvgPurpose {
  StrokeUse use;
  bool fill{false};  ///< the shape has no stroke: use the outline of its fill
};

/// Decides what the shapes of one drawing are for: by their names, else by the profile.
class SvgPurposes {
 public:
  SvgPurposes(const SvgText& text, const StrokeProfile& profile, SvgNotes& notes)
      : text_(text), profile_(profile), notes_(notes) {}

  /// What the shape `e` is for. None if it is invisible, or if its fill does not count; this adds a
  /// note.
  [[nodiscard]] std::optional<SvgPurpose> of(const SvgElement& e, const SvgStyle& style,
                                             const SvgDashes& dashes);
  /// Whether any shape so far had a name.
  [[nodiscard]] bool has_names() const { return has_names_; }
  /// A warning if strokes of several colours all got the same purpose; else empty.
  [[nodiscard]] std::string colour_warning() const;

 private:
  const SvgText& text_;
  const StrokeProfile& profile_;
  SvgNotes& notes_;
  std::vector<std::uint32_t> colours_;  ///< the first colours that no rule knows
  bool has_names_{false};
};

}  // namespace popcut
