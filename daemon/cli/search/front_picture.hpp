// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/artwork/colour_mesh.hpp"
#include "core/result.hpp"
#include "daemon/planning/search/card_search.hpp"

namespace popcut::cli {

/// The folder of a card of the front: "card-01" is the quickest to fold.
[[nodiscard]] std::string front_folder(const planning::FoundCard& card, std::size_t k);

/// A card beside its model, from three sides (PNG): as `popcut compare` draws it.
///
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::string> card_picture(const planning::FoundCards& found,
                                               const planning::FoundCard& card,
                                               const std::string& title);

/// All cards of the front on one page (SVG): the model first, then each card as it looks printed,
/// with its time and its error, and a graph of the errors over the times.
///
/// @param model  in units and axes of its file; none: cards are drawn bare, from the diagonal
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::string> front_picture(const planning::FoundCards& found,
                                                const std::string& title,
                                                const std::optional<ColourMesh>& model);

/// How a card's model stands: the axes of the file that point up and out of the card, "y" and "-z".
/// One that is turned by other than right angles has the nearest ones.
struct Stand {
  std::string up, front;
};
[[nodiscard]] Stand stand_of(const planning::FoundCard& card);

/// Six ways in which the model can stand, from the front, each with the options that ask for it
/// (SVG): the four with `up` upright, and two others. The one of `taken` is marked.
///
/// @param up  a word of `up_words`; "any": as `taken`
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::string> sides_picture(const TriangleMesh& mesh, const std::string& up,
                                                const Stand& taken);

}  // namespace popcut::cli
