// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/verify/parts/joint_model.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/hinge_lines.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Two bodies that turn about one line: a fold, a hinge, or the line in which two slots cross.
struct BodyHinge {
  std::uint32_t right{}, left{};
  Vec3 right_at, left_at;          ///< the line's middle, in each body
  Vec3 right_along, left_along;    ///< its direction, of length 1
  Vec3 right_beside, left_beside;  ///< square to it in each panel, from right to left on the sheet
  double length_mm{};
  double angle_rad{};  ///< by which left is turned in the opened pose
  Eigen::Isometry3d left_to_right{Eigen::Isometry3d::Identity()};  ///< in that pose
  std::size_t part{};                                              ///< of the fold
};

/// The ends of a line in one body that stay in a plane of another.
struct BodySlot {
  std::uint32_t slit{}, slides{};
  std::array<Vec3, 2> at;  ///< in `slit`
  Vec3 origin, normal;     ///< of the plane, in `slides`
  std::size_t joint{};
};

/// The panels of all parts, those that are glued as one body. Panels are numbered through all
/// parts, and faces too.
struct Assembled {
  std::vector<Sheet> sheets;               ///< one a part
  std::vector<std::size_t> first_panel;    ///< one a part
  std::vector<std::uint32_t> body;         ///< one a panel
  std::vector<Eigen::Isometry3d> in_body;  ///< one a panel: from its flat sheet into its body
  std::vector<Vec3> middle;                ///< one a body, in it
  std::size_t bodies{};
  std::vector<BodyHinge> hinges;
  std::vector<BodySlot> slots;
  std::size_t drive{};  ///< the spine between the pages: the longest fold of both
  double reach_mm{};    ///< size of the largest part

  [[nodiscard]] std::size_t panel_of(std::size_t part, std::size_t face) const {
    return first_panel[part] + sheets[part].panel_of_face[face];
  }
};

/// A point of a flat sheet in space.
[[nodiscard]] inline Vec3 lifted(Vec2 p) { return {p.x(), p.y(), 0.0}; }

/// The motion that lays `from` on `to`, both on flat sheets; `turned` over its line, or not.
[[nodiscard]] Eigen::Isometry3d laid_on(const std::array<Vec2, 2>& from,
                                        const std::array<Vec2, 2>& to, bool turned);

/// Puts the parts together. `check` gets what does not fit: panels that are glued twice in
/// different places.
///
/// @param sheets  one a part, as `make_sheet` finds it
/// @retval OutOfRange  the first part has no fold, or none between the named pages
[[nodiscard]] Result<Assembled> assemble(const JointModel& model, std::vector<Sheet> sheets,
                                         VerifyCheck& check);

}  // namespace popcut::verify
