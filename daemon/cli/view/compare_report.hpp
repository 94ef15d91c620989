// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/comparison.hpp"
#include "core/compare/placement.hpp"
#include "core/compare/printed.hpp"
#include "core/compare/volume.hpp"

namespace popcut::cli {

/// What cutting the pattern takes, by the model of the machine.
struct CutCost {
  bool ran{false};
  std::string why;  ///< one sentence, where it did not run
  std::string machine, material;
  std::optional<double> seconds;  ///< none: popcut does not drive the machine
  std::array<double, 2> seconds_range{};
  double cut_mm{}, fold_mm{}, travel_mm{};
  std::size_t sheets{}, pieces{};
};

/// What the paper has to do. None of a structure that is a mesh.
struct PaperFigures {
  std::size_t folds{};
  double smallest_joint_mm{};  ///< 0: no joint
  std::size_t pieces{};        ///< of the pattern and, where it was planned, of its sheets
};

/// All that `popcut compare` found.
struct CompareReport {
  std::string pattern, target;  ///< names of files
  std::optional<double> psi_rad;
  bool around{};
  int pixels{};
  std::string placed_by;  ///< "options", "pattern", "spec", "fit" or "file"
  likeness::ModelPlacement placement;
  std::optional<double> misfit;  ///< of a placement that was searched for
  likeness::Figures figures;
  std::optional<likeness::PrintedFigures> printed;  ///< of a printed card, where it was asked for
  likeness::Volume model, card;
  CutCost cost;
  std::optional<PaperFigures> paper;
  std::vector<std::string> notes;

  /// The one figure: as printed where that was asked for.
  [[nodiscard]] double error() const { return printed ? printed->error() : figures.error(); }
  /// |model - card| / model; none where the model has no volume.
  [[nodiscard]] std::optional<double> volume_error() const;
};

/// What `popcut compare --printed` finds of a card of several parts.
struct PartsReport {
  std::string pattern, target;
  int pixels{};
  bool opens_flat{};  ///< seen from above its pages, else from around the diagonal
  likeness::PrintedFigures printed;
};
[[nodiscard]] std::string compare_text(const PartsReport& report);
[[nodiscard]] std::string compare_json(const PartsReport& report);

/// The report in words, a line a figure, the error last.
[[nodiscard]] std::string compare_text(const CompareReport& report);
/// The report as JSON, the error last; lengths in the unit of their name.
[[nodiscard]] std::string compare_json(const CompareReport& report);

}  // namespace popcut::cli
