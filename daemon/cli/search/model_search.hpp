// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/artwork/colour_mesh.hpp"
#include "core/result.hpp"
#include "core/search/standing.hpp"
#include "daemon/planning/search/card_search.hpp"
#include "daemon/planning/search/glued_card.hpp"

namespace popcut::cli {

/// What a user says about the card of a model.
struct ModelSearchOptions {
  std::string model;  ///< file
  std::string machine, material, mat;
  std::string style{"any"}, up{kUsualUp}, front{"any"};
  int cards{1};  ///< of a book
  double max_minutes{15.0}, effort{1.0};
  std::uint64_t seed{1};
  unsigned threads{0};        ///< 0: as many as the computer has
  std::int64_t most_folds{};  ///< 0: any number
  double shortest_fold_mm{};
  std::string label{};  ///< "easy", "medium", "hard"; empty: any
  bool any_hold{};
  bool plain{};       ///< cards are judged without their print
  bool marks{false};  ///< cards fit between registration marks
};

/// A model that was searched, with what writing its cards needs.
struct SearchedModel {
  std::string name;   ///< of the file, without folders
  std::string file;   ///< as the specs give it
  std::string bytes;  ///< of the file
  std::string up;     ///< one of `up_words`: what was asked for, or what such files usually have
  Material material;
  planning::FoundCards found;
  /// The model in its colours; clay where they cannot be read. None: cards are shown bare.
  std::optional<ColourMesh> colours{};
  /// Cards of layers and of boxes beside them (`planning::glued_beside`).
  std::vector<planning::FoundGlued> glued{};
};

/// Reads a mesh and searches its best cards (`planning::search_cards`).
///
/// @param spec_folder  where specs will be, from which they name the mesh
/// @retval Malformed, OutOfRange  it cannot be read, with its name; a design or another file that
///                                is no mesh
/// @retval Usage, Infeasible, Refused  as `planning::search_cards`
[[nodiscard]] Result<SearchedModel> search_model(const ModelSearchOptions& options,
                                                 const std::filesystem::path& spec_folder,
                                                 bool shows_progress,
                                                 const std::function<bool()>& stopped);

}  // namespace popcut::cli
