// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/printed.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/plan_options.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/search/candidate.hpp"
#include "daemon/planning/search/card_search.hpp"

namespace popcut::planning {

/// What a card of layers is made of, beside the cards of one sheet that a search found.
struct LayersRequest {
  const TriangleMesh& mesh;
  std::span<const likeness::Rgb> colours;  ///< of its triangles, one each; empty: clay
  CandidateModel model;                    ///< how the spec names it
  std::array<double, 3> rotate_deg{};      ///< as it stands in the recommended card
  std::array<double, 2> area_mm{};         ///< that the open card and each layer fit on
  PlanOptions plan;                        ///< machine, material and mat
  std::vector<std::string> tables;         ///< users' tables
  double most_s{};                         ///< of cutting
  HandLimits hands;
  Progress progress;
};

/// A card of layers that was made for a model.
struct FoundLayers {
  std::string spec;  ///< `design` makes exactly this card from it
  judge::SoundLayers sound;
  likeness::PrintedFigures printed;  ///< `judge::layers_likeness`
  hands::Handwork hands;
  double seconds{};  ///< of cutting
  std::array<double, 2> seconds_range{};
  double cut_mm{}, fold_mm{};
  std::vector<DrawnPart> places;  ///< of its parts on their common page
};

/// Makes a card of layers as large as fits, proves it, plans it and compares it printed.
///
/// @retval Infeasible  it cannot be made, or breaks a limit; the detail says which
[[nodiscard]] Result<FoundLayers> layers_card(const LayersRequest& request);

/// The card of layers beside the cards that a search found, with the model as it stands in the
/// recommended one. None, and a note says why, where it cannot be made; none, too, if the search
/// is for one style, for books or for bare paper.
///
/// @param asked  the request of that search; its mesh is not looked at
[[nodiscard]] std::optional<FoundLayers> layers_beside(const SearchRequest& asked,
                                                       FoundCards& found);

}  // namespace popcut::planning
