// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/hinge_lines.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Rigid panels on hinge lines: what the solver moves. A state is one `RigidMotion` a panel.
struct RigidSheet {
  std::vector<HingeLine> lines;
  std::vector<PanelFrame> frames;
  std::vector<std::uint8_t> held;      ///< one a panel: one of each piece stays where it is
  std::vector<std::uint32_t> order;    ///< panels, each after the one it hangs on; held ones first
  std::vector<std::int32_t> hangs_on;  ///< one a panel: the line by which it does, -1 for held ones
  double reach_mm{};                   ///< size of the whole
};

/// @param held  the panel that stays; of other pieces, the first one does
[[nodiscard]] RigidSheet rigid_sheet(const FoldModel& file, const Sheet& sheet, std::uint32_t held);

using RigidState = std::vector<RigidMotion>;

/// The state in which every line is folded by `angle_rad` as far as panels hang on each other in a
/// tree; all other lines stay open.
[[nodiscard]] RigidState state_from_tree(const RigidSheet& sheet, std::span<const double> angle_rad,
                                         const RigidMotion& held = {});

/// Fold angles in radians, one a line: + valley, - mountain, within -pi and pi.
[[nodiscard]] std::vector<double> fold_angles_rad(const RigidSheet& sheet, const RigidState& state);

/// Largest distance in mm between the two places that panels give an end of a line.
[[nodiscard]] double largest_gap_mm(const RigidSheet& sheet, const RigidState& state);

/// The vertices where a state puts them, as a pose that popcut made itself.
///
/// @param how  the word for it in the pose's place: "opened", "moved"
[[nodiscard]] Pose pose_of(const FoldModel& file, const Sheet& sheet, const RigidState& state,
                           double psi_rad, std::string_view how);

/// Asks that a line fold by an angle. Lines that only lean toward theirs have a small weight.
struct AngleGoal {
  std::size_t line{};
  double angle_rad{};
  double weight{1.0};
};

/// Closes the hinges of a state by Gauss-Newton steps.
///
/// Unknowns are the twists of all panels that are not held (angular velocity scaled by the panel's
/// size, velocity of its middle), equations that both panels of a line agree on its middle and its
/// direction. The Jacobian is sparse and of full column rank where the goals pin all freedoms;
/// where they do not, a shift of the normal matrix makes the step the shortest one. The normal
/// matrix is factored by a sparse Cholesky whose ordering is computed once.
class RigidSolver {
 public:
  explicit RigidSolver(const RigidSheet& sheet);
  ~RigidSolver();
  RigidSolver(RigidSolver&&) noexcept;
  RigidSolver& operator=(RigidSolver&&) noexcept;

  struct End {
    double gap_mm{};        ///< largest gap that is left
    double goal_off_rad{};  ///< largest deviation from a goal of weight 1
    std::size_t iterations{};
  };
  /// Moves `state` until hinges are closed to rounding, nothing improves, or `most` steps are done.
  /// @param shift  what is added to the normal matrix: pure number, 1e-12 changes nothing
  [[nodiscard]] End correct(RigidState& state, std::span<const AngleGoal> goals, std::size_t most,
                            double shift = 1e-12);
  /// Gauss-Newton steps done so far, of all calls.
  [[nodiscard]] std::size_t iterations() const;
  /// Unknowns.
  [[nodiscard]] std::size_t unknowns() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace popcut::verify
