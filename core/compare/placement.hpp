// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/compare/depth_image.hpp"
#include "core/compare/view.hpp"

namespace popcut::likeness {

/// How a model stands among what it is compared with: its point q is at
/// `turn (scale q) + shift_mm`.
struct ModelPlacement {
  double scale_mm{1.0};
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vec3 shift_mm;

  /// The same turned by R_z R_y R_x, angles about x, y and z in degrees; exact for right angles.
  [[nodiscard]] static Eigen::Matrix3d turn_of(const std::array<double, 3>& degrees);
  /// Angles about x, y and z, in degrees, that give `turn`.
  [[nodiscard]] std::array<double, 3> degrees() const;
};

[[nodiscard]] std::vector<float> placed(Triangles model, const ModelPlacement& placement);

/// Where a model stands that nothing is known of, and how well it fits there.
struct FoundPlacement {
  ModelPlacement placement;
  double misfit{};  ///< 0: the depths agree at each pixel; 1: nowhere
};

/// Finds the placement in which the model looks most like the structure: its size, its turn and its
/// shift. It begins with the 24 ways to turn it by right angles, standing in the corner or with its
/// middle on the spine, and improves the best of them by steps that are halved. Compared are depths
/// in five coarse views; the model is made coarse too. The same input gives the same result.
///
/// A shape that looks alike from several sides fits in several ways; the first is taken.
[[nodiscard]] FoundPlacement find_placement(Triangles model, Triangles structure,
                                            const std::optional<Corner>& corner);

/// The same for a model whose place is known but for its shift along the spine: only that is
/// changed.
[[nodiscard]] FoundPlacement find_shift_along_spine(Triangles model,
                                                    const ModelPlacement& placement,
                                                    Triangles structure,
                                                    const std::optional<Corner>& corner);

}  // namespace popcut::likeness
