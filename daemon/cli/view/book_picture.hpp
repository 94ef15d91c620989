// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/compare/view.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// A book that stands open all around, (x, v, z) in mm with the spine along v.
struct BookScene {
  std::vector<float> pages;      ///< everything of paper
  std::vector<float> structure;  ///< the same without what lies in the pages
  std::vector<float> model;      ///< what is shown; empty: not drawn
};

/// A picture (SVG) from eight sides, a little from above: the book, what stands between its pages,
/// and the model.
///
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::string> book_picture(const BookScene& scene, const std::string& title);

/// A card that opens flat, as it is seen by a person at a table: x points to that person, the
/// second coordinate is the height, mm.
struct OpenedCard {
  std::string words;             ///< "open", "half open"
  std::vector<float> triangles;  ///< pages and all that stands on them
};

/// A picture (SVG) of a card at some openings, and of the model, from in front, from both sides and
/// from above.
///
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::string> opened_picture(const std::vector<OpenedCard>& openings,
                                                 const std::vector<float>& model,
                                                 const std::string& title);

}  // namespace popcut::cli
