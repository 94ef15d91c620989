// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/depth_image.hpp"
#include "core/compare/placement.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::verify {
struct Target;
}

namespace popcut::cli {

/// What stands opened: a pattern, or the mesh of one.
struct ComparedStructure {
  std::vector<float> triangles;  ///< nine numbers each, (x, v, z) in mm
  /// None: parts of it lie behind it, so it is no card in a corner of wall and ground.
  std::optional<likeness::Corner> corner;
  bool is_book{};  ///< cards around one spine, without their pages
  bool is_mesh{};  ///< or poses without a flat sheet; then the figures of the paper are 0
  std::optional<double> psi_rad;
  std::optional<likeness::ModelPlacement> model;  ///< where the pattern says that it stands
  std::size_t folds{};
  double smallest_joint_mm{};
  std::size_t pieces{};
  std::vector<std::string> notes;
  std::string fold_text;  ///< the FOLD file; of a drawing, its lines as one; of a mesh, empty
};

/// Reads a pattern (FOLD, SVG, DXF) and opens it, or a mesh (STL, OBJ) of an opened one. A FOLD
/// file that has no flat sheet is taken as its folded form stands.
///
/// @param psi_rad  opening angle; none: the one it is designed for
/// @retval Malformed, OutOfRange  it cannot be read or opened, or all of it lies in wall and
/// ground;
///                                with the file's name
[[nodiscard]] Result<ComparedStructure> read_structure(const std::string& file,
                                                       std::optional<double> psi_rad,
                                                       const Progress& progress);

/// How a user says where the model stands; absent members are 1 mm, no turn and no shift.
struct GivenPlacement {
  std::optional<double> scale_mm;
  std::optional<std::array<double, 3>> rotate_deg, move_mm;
  bool fit{};  ///< search for it whatever is known
  [[nodiscard]] bool is_given() const { return scale_mm || rotate_deg || move_mm; }
};

/// A target where it stands.
struct ComparedTarget {
  std::vector<float> triangles;
  bool is_solid{};        ///< triangles of a file, which may have an inside
  std::string placed_by;  ///< "options", "pattern", "spec", "fit" or "file"
  likeness::ModelPlacement placement;
  std::optional<double> misfit;  ///< of a placement that was searched for
};

/// Reads a mesh (STL, OBJ), heights (CSV) or the surface of a design (JSON), and puts it where the
/// user says; else where the design or the pattern says; else where it fits best. Two meshes are
/// compared as they are.
///
/// @retval Malformed, OutOfRange  it cannot be read, or has no size; with the file's name
[[nodiscard]] Result<ComparedTarget> read_compared_target(const std::string& file,
                                                          const ComparedStructure& structure,
                                                          const GivenPlacement& given,
                                                          const Progress& progress);

/// How far the strips of a pattern lie on the sheet from their places along a target, along the
/// spine, mm. None where the pattern's strips are not those of the target's design.
[[nodiscard]] std::optional<double> shift_along_spine(const std::string& fold_text,
                                                      const verify::Target& target);

}  // namespace popcut::cli
