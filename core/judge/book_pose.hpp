// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/compare/placement.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::judge {

/// Turns places, three numbers each, about the spine from the ground (x) toward the wall (z).
void turn_about_spine(std::vector<float>& places, double angle_rad);

/// The cards of a book as they stand around the spine, each opened as it was designed: the first
/// ground along x, each further card turned by the openings of those before it. What lies in the
/// pages is left out.
struct BookPose {
  std::vector<float> triangles;  ///< nine numbers each, (x, v, z) in mm
  /// Where the model stands, of the first card that says so, seen from the first card.
  std::optional<likeness::ModelPlacement> model;
  double psi_rad{};     ///< opening angle of the last card
  double turned_rad{};  ///< of all cards together
  std::size_t folds{};
  double smallest_joint_mm{};  ///< 0: none
  std::size_t pieces{};
  std::vector<std::string> notes;  ///< each begins with its card's name

  /// Puts the next card into its place; returns whether something stands between its pages.
  ///
  /// @param name  how errors and notes call it
  /// @retval Malformed, OutOfRange  it cannot be opened; place begins with its name
  [[nodiscard]] Result<bool> add(const std::string& name, std::string_view fold_text,
                                 const Progress& progress = {});
};

}  // namespace popcut::judge
