// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/deploy/sheet_mesh.hpp"
#include "core/pattern/pattern.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// The cards of a book, read from their FOLD files.
struct DeployedBook {
  std::string name;
  std::vector<Pattern> cards;

  [[nodiscard]] std::vector<const Pattern*> pointers() const;
};

/// Reads the cards of a book by its folder or book.json.
///
/// @retval Malformed, OutOfRange  a card cannot be read, or cards differ in their design angle
[[nodiscard]] Result<DeployedBook> read_deployed_book(const std::string& file);

/// All cards as one mesh, each on bodies of its own.
///
/// @retval OutOfRange  a face is not a simple polygon
[[nodiscard]] Result<SheetMesh> book_mesh(const DeployedBook& book, double thickness_mm);

/// Writes "psi_NNN.stl" for each angle: all cards around the spine, each open to the angle, in mm
/// with the axes x (along the first ground), v (along the spine) and z.
[[nodiscard]] Result<void> add_book_meshes(const DeployedBook& book, const SheetMesh& mesh,
                                           const std::vector<double>& psi_rad, OutputFolder& folder,
                                           const Progress& progress);

}  // namespace popcut::cli
