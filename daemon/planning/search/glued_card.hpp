// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/printed.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/plan_options.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/search/candidate.hpp"
#include "daemon/planning/search/card_search.hpp"

namespace popcut::planning {

/// What a card of several parts is made of, beside the cards of one sheet that a search found.
struct GluedRequest {
  DesignStyle style{};  ///< layers or boxes
  const TriangleMesh& mesh;
  std::span<const likeness::Rgb> colours;  ///< of its triangles, one each; empty: clay
  CandidateModel model;                    ///< how the spec names it
  std::array<double, 3> rotate_deg{};      ///< as it stands in the recommended card
  std::array<double, 2> area_mm{};         ///< that the open card and each part fit on
  PlanOptions plan;                        ///< machine, material and mat
  std::vector<std::string> tables;         ///< users' tables
  double most_s{};                         ///< of cutting
  HandLimits hands;
  Progress progress;
};

/// A card of layers or of boxes that was made for a model.
struct FoundGlued {
  std::string spec;  ///< `design` makes exactly this card from it
  std::optional<judge::SoundLayers> layers;
  std::optional<judge::SoundBoxes> boxes;  ///< in place of layers
  likeness::PrintedFigures printed;        ///< `judge::layers_likeness` or `judge::boxes_likeness`
  hands::Handwork hands;
  double seconds{};  ///< of cutting
  std::array<double, 2> seconds_range{};
  double cut_mm{}, fold_mm{};
  std::vector<DrawnPart> places;  ///< of its parts on their common page

  [[nodiscard]] const char* style() const { return layers ? "layers" : "boxes"; }
  /// What it is made of: "5 layers", "1 box".
  [[nodiscard]] std::string made_of() const;
  [[nodiscard]] const Structure& card() const {
    return layers ? layers->made.card : boxes->made.card;
  }
  [[nodiscard]] const std::vector<Warning>& warnings() const {
    return layers ? layers->made.warnings : boxes->made.warnings;
  }
  [[nodiscard]] double wobble_mm() const {
    return (layers ? layers->report : boxes->report).wobble_mm.value_or(0.0);
  }
};

/// Makes a card of layers or of boxes as large as fits, proves it, plans it and compares it
/// printed.
///
/// @retval Infeasible  it cannot be made (with the place in its design), or it breaks a limit
///                     (without a place); the detail says which
[[nodiscard]] Result<FoundGlued> glued_card(const GluedRequest& request);

/// The cards of layers and of boxes beside the cards that a search found, with the model as it
/// stands in the recommended one. A note says why one is left out; none, where a model is not made
/// of boxes. Empty if the search is for one style, for books or for bare paper.
///
/// @param asked  the request of that search; its mesh is not looked at
[[nodiscard]] std::vector<FoundGlued> glued_beside(const SearchRequest& asked, FoundCards& found);

}  // namespace popcut::planning
