// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace popcut {

/// A failure: where (JSON pointer into the FOLD file) and what.
struct VerifyFailure {
  std::string place;
  std::string detail;
};

/// Where a face or an edge stands in a FOLD file.
[[nodiscard]] inline std::string face_place(std::size_t f) {
  return fmt::format("/faces_vertices/{}", f);
}
[[nodiscard]] inline std::string edge_place(std::size_t e) {
  return fmt::format("/edges_vertices/{}", e);
}

/// After so many failures of one kind the search for more ends.
inline constexpr std::size_t kMostReported = 1000;

/// One check of a pattern. It lists the first `kListed` failures and counts the rest.
struct VerifyCheck {
  static constexpr std::size_t kListed = 20;

  std::string name;    ///< stable, so that scripts can look for it
  std::string detail;  ///< the figures, in a sentence
  bool ran{true};      ///< false: the check could not run, and `detail` says why
  std::size_t failed{};
  std::vector<VerifyFailure> failures;

  [[nodiscard]] bool ok() const { return failed == 0; }
  void fail(std::string place, std::string what) {
    ++failed;
    if (failures.size() < kListed) failures.push_back({std::move(place), std::move(what)});
  }
  /// Marks the check as not made, unless it has already found a failure.
  void not_judged(std::string why) {
    if (failed > 0) return;
    ran = false;
    detail = "not checked: " + std::move(why);
  }
  /// Takes back what was found: it does not say whether the pattern is sound.
  void undecided(std::string why) {
    ran = false;
    failed = 0;
    failures.clear();
    detail = "not judged: " + std::move(why);
  }
};

/// Sizes of the flat sheet.
struct Tiling {
  double sheet_u_mm{}, sheet_v_mm{};  ///< extent of the flat sheet
  double area_mm2{};                  ///< sum of the faces' areas
  std::size_t holes{};
  std::size_t slits{};  ///< border loops without area
};

/// How a pattern without an opened pose was opened.
struct OpeningFigures {
  std::size_t driver_edge{};          ///< a fold of the driving line, whose angle is pi - psi
  double driver_length_mm{};          ///< of the whole driving line
  double reached_psi_rad{};           ///< smallest opening angle reached; pi: none
  std::size_t steps{}, iterations{};  ///< continuation steps; Gauss-Newton iterations in total
  double gap_mm{};                    ///< largest remaining gap in a hinge, over all poses
};

/// Distances of fold vertices from the target surface, in mm.
struct TargetDistance {
  std::size_t vertices{};
  double rms_mm{};
  double max_mm{};
};

/// The distances of a pattern: of its inner fold vertices, and of all with the ends at wall and
/// ground.
struct TargetDistances {
  TargetDistance inner, all;
};

}  // namespace popcut
