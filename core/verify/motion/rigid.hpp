// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Sparse>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/hinge_lines.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Rigid panels on hinge lines, for the solver. A state is one `PanelMotion` per panel.
struct RigidSheet {
  std::vector<HingeLine> lines;
  std::vector<PanelFrame> frames;
  /// One per panel: whether it stays in place; one panel of each piece does.
  std::vector<std::uint8_t> held;
  /// Panels, each after the one that it hangs on; held panels first.
  std::vector<std::uint32_t> order;
  /// One per panel: the line on which it hangs; -1 for held panels.
  std::vector<std::int32_t> hangs_on;
  double reach_mm{};  ///< size of the whole sheet
};

/// @param held  the panel that stays in place; in other pieces, the first panel does
[[nodiscard]] RigidSheet rigid_sheet(const FoldModel& file, const Sheet& sheet, std::uint32_t held);

using RigidState = std::vector<PanelMotion>;

/// The state in which every line of the tree of panels is folded by `angle_rad`. Hinges of lines
/// outside the tree may open.
[[nodiscard]] RigidState state_from_tree(const RigidSheet& sheet, std::span<const double> angle_rad,
                                         const PanelMotion& held = {});

/// Fold angles in radians, one per line: + valley, - mountain, within -pi and pi.
[[nodiscard]] std::vector<double> fold_angles_rad(const RigidSheet& sheet, const RigidState& state);

/// Largest distance in mm between the two places that panels give an end of a line.
[[nodiscard]] double largest_gap_mm(const RigidSheet& sheet, const RigidState& state);

/// The places of the vertices in a state, as a pose made by popcut.
///
/// @param how  verb for the pose's place: "opened", "moved"
[[nodiscard]] Pose pose_of(const FoldModel& file, const Sheet& sheet, const RigidState& state,
                           double psi_rad, std::string_view how);

/// Requires that a line fold by an angle. A small weight only pulls the line towards it.
struct AngleGoal {
  std::size_t line{};
  double angle_rad{};
  double weight{1.0};
};

/// Closes the hinges of a state by Gauss-Newton steps.
///
/// The unknowns are the twists of all panels that are not held (angular velocity scaled by the
/// panel's size, velocity of its middle). The equations are that both panels of a line agree on its
/// middle and its direction. The Jacobian is sparse. It has full column rank if the goals fix all
/// degrees of freedom; otherwise a shift of the normal matrix makes the step the shortest one. A
/// sparse Cholesky factorises the normal matrix, with an ordering that is computed once.
class RigidSolver {
 public:
  explicit RigidSolver(const RigidSheet& sheet);

  struct End {
    double gap_mm{};        ///< largest remaining gap
    double goal_off_rad{};  ///< largest deviation from a goal with weight 1
    std::size_t iterations{};
  };
  /// Moves `state` until hinges are closed up to rounding, nothing improves, or after `most` steps.
  /// @param shift  added to the normal matrix; dimensionless, 1e-12 has no effect
  [[nodiscard]] End correct(RigidState& state, std::span<const AngleGoal> goals, std::size_t most,
                            double shift = 1e-12);
  /// Gauss-Newton steps so far, over all calls.
  [[nodiscard]] std::size_t iterations() const { return iterations_; }
  /// Number of unknowns.
  [[nodiscard]] std::size_t unknowns() const { return static_cast<std::size_t>(columns_); }

 private:
  using Sparse = Eigen::SparseMatrix<double>;
  [[nodiscard]] double lever(const HingeLine& line) const {
    return std::min(sheet_.frames[line.left].size_mm, sheet_.frames[line.right].size_mm);
  }
  [[nodiscard]] Eigen::VectorXd residual(const RigidState& state,
                                         std::span<const AngleGoal> goals) const;
  [[nodiscard]] Sparse jacobian(const RigidState& state, std::span<const AngleGoal> goals) const;
  bool step(RigidState& state, std::span<const AngleGoal> goals, const Eigen::VectorXd& off,
            double shift);

  const RigidSheet& sheet_;
  std::vector<int> column_;  ///< one per panel; -1 for held panels
  int columns_{};
  std::size_t iterations_{};
  bool ordered_{false};
  Eigen::SimplicialLLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
};

}  // namespace popcut::verify
