// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/design/chain/slicing.hpp"
#include "core/design/design.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/strips/strips.hpp"
#include "core/fit/fit.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {

/// Where places along the sheet (v, mm) lie along the target (s, mm): by the centre lines of the
/// slices that are laid, in a straight line between them. Without slices: s is v.
class SpineMap {
 public:
  SpineMap() = default;
  SpineMap(const Strips& strips, std::span<const double> s_mm);
  [[nodiscard]] double operator()(double v_mm) const;
  /// The way back: v of a place along the target.
  [[nodiscard]] double place_on_sheet(double s_mm) const;

 private:
  std::vector<double> v_, s_;
};

/// The opened structure: two triangles for each panel that is not in wall or ground, at the places
/// along the target. V-folds are as they pop: two triangles, and what they leave of their panels.
///
/// @param pattern  the strips' own: has their V-folds, and the opening angle that the target is for
[[nodiscard]] TriangleSoup structure_triangles(const Strips& strips, const Pattern& pattern,
                                               const SpineMap& along);

/// The target itself in space, over the stretch of the spine that the strips take, or whole where
/// it is a mesh or a grid.
///
/// @param report        its slices, and its units for how finely formulas are cut into triangles
/// @param least_chord   their chords may stray by this share of the structure's size, even where
///                      its units would ask for less
[[nodiscard]] TriangleSoup target_triangles(const Strips& strips, const SpineMap& along,
                                            const DesignReport& report,
                                            std::span<const TargetPiece> target,
                                            double least_chord = 0.0);

/// How far the opened structure and the target are from each other, both ways: for
/// `report.surface_fit`, which designing leaves out, since it takes as long as a small design. None
/// where one of them has no area.
[[nodiscard]] std::optional<FitFigures> surface_fit(const Design& design);

/// The fit in one line of words: how far off on average, and how much of the target is there.
[[nodiscard]] std::string fit_in_words(const FitFigures& fit);

}  // namespace popcut
