// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "core/design/facets/label_card.hpp"

namespace popcut {

/// What other patches enclose on all sides: stretches of strips, by strip, that hang together. It
/// touches one plane only, and so could fall out (`fill_enclosed`).
struct EnclosedPiece {
  struct Stretch {
    int strip{}, begin{}, end{};
  };
  std::vector<Stretch> stretches;
};

/// Where labels that were filled differ from those that are there.
///
/// @param filled   the labels after `fill_enclosed`
/// @param by_card  what wall or ground enclose; false: what other paper encloses
[[nodiscard]] std::vector<EnclosedPiece> enclosed_pieces(const LabelImage& image,
                                                         const LabelImage& filled, bool by_card);

/// The strip of a piece that costs least to go on to wall and ground, where the piece then hangs
/// (a bridge). None if it costs less to leave the piece out.
[[nodiscard]] std::optional<NewStrip> bridge(Labelling& labelling, const EnclosedPiece& piece,
                                             const LabelImage& filled);

/// The filled labels, but with the pieces in other paper without which the card costs far more than
/// a strut does. A strut cuts that paper: a window in it shows the card, and of most letters no
/// more is there.
[[nodiscard]] LabelImage with_worthy_pieces(Labelling& labelling, const LabelImage& filled);

}  // namespace popcut
