// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/angle.hpp"
#include "core/geometry/overlap.hpp"

namespace popcut {

/// From this length in mm on, segments are found by their line.
inline constexpr double kLongSegment = 5.0;

/// The line that a segment lies on: its direction (0 to pi), its distance from the middle of the
/// drawing (to the left of that direction), and where the segment begins and ends, measured from
/// the foot of the perpendicular from the middle. In mm and radians.
struct LongLine {
  float radians{}, offset{}, from{}, to{};
};

/// A hash of a number.
[[nodiscard]] inline std::uint64_t mixed(std::uint64_t key) {
  key *= 0x9E3779B97F4A7C15ULL;
  key ^= key >> 29;
  key *= 0xBF58476D1CE4E5B9ULL;
  return key ^ (key >> 32);
}

/// Sorts long segments by the lines that they lie on, so that those that may share a part are in
/// one bin or in bins beside each other: of 0.005 rad, of the tolerance and half a percent of the
/// drawing across, and of twice the usual length along. Segments of 5 mm or more that share a part
/// differ by less (see `overlap`). A grid of cells would be filled by long lines from end to end,
/// and what crosses there is not asked for.
class LineBins {
 public:
  /// @param middle    the middle of the drawing
  /// @param reach     how far the drawing goes from there, mm
  /// @param usual_mm  the mean length of its long segments
  LineBins(const PagePoint& middle, double reach, double usual_mm, double tolerance);

  [[nodiscard]] LongLine line_of(const Segment& segment) const;

  /// Calls `visit(bin)` for each bin that holds a part of `line`.
  template <typename Visit>
  void each_bin(const LongLine& line, Visit&& visit) const {
    const std::uint64_t row = key(angle_of(line), offset_of(line));
    const std::int64_t last = along_of(line.to);
    for (std::int64_t a = along_of(line.from); a <= last; ++a)
      visit(row + static_cast<std::uint64_t>(a));
  }
  [[nodiscard]] std::uint64_t first_bin(const LongLine& line) const {
    return key(angle_of(line), offset_of(line)) + static_cast<std::uint64_t>(along_of(line.from));
  }

  /// Calls `visit(bin, seen)` for all bins with segments that may share a part with `line`. `seen`
  /// is the line as seen from that bin, for `may_share`. A segment in several bins is visited
  /// several times.
  template <typename Visit>
  void each_near(const LongLine& line, Visit&& visit) const {
    const std::int64_t middle = angle_of(line);
    // The last bin is narrower than the others, so two bins beside it are searched.
    for (std::int64_t a = middle - 2; a <= middle + 2; ++a) {
      if (std::abs(a - middle) > 1 && a >= 0 && a < kAngles) continue;
      const std::int64_t angle = (a + kAngles) % kAngles;
      LongLine seen = line;
      if (a != angle) {  // beyond half a turn the direction reverses
        const double radians = static_cast<double>(line.radians) + (a < 0 ? kPi : -kPi);
        seen = {static_cast<float>(radians), -line.offset, -line.to, -line.from};
      }
      const std::int64_t offset = offset_of(seen);
      const std::int64_t first = along_of(seen.from - drift_), last = along_of(seen.to + drift_);
      for (std::int64_t r = offset - 1; r <= offset + 1; ++r)
        for (std::int64_t c = first; c <= last; ++c)
          visit(key(angle, r) + static_cast<std::uint64_t>(c), seen);
    }
  }

  /// Whether two lines are within the tolerance of each other at both ends of their common part.
  /// Sometimes true if they only nearly are.
  [[nodiscard]] bool may_share(const LongLine& seen, const LongLine& other) const {
    const float turn = other.radians - seen.radians;
    if (std::abs(turn) > kMostTurn) return false;
    const float shift = other.offset * turn;  // the two lines have different feet
    const float from = std::max(seen.from, other.from - shift);
    const float to = std::min(seen.to, other.to - shift);
    if (from > to + slack_) return false;
    const float foot = seen.offset * (1.0F - turn * turn / 2) - other.offset;
    return std::abs(foot - from * turn) <= near_ && std::abs(foot - to * turn) <= near_;
  }

 private:
  static constexpr double kRadians = 0.005;
  static constexpr std::int64_t kAngles = 629;  // bins over half a turn
  static constexpr float kMostTurn = 0.0045F;   // 0.02 mm on 5 mm, and rounding

  [[nodiscard]] static std::int64_t angle_of(const LongLine& line) {
    const auto bin = static_cast<std::int64_t>(static_cast<double>(line.radians) / kRadians);
    return std::clamp<std::int64_t>(bin, 0, kAngles - 1);
  }
  [[nodiscard]] std::int64_t offset_of(const LongLine& line) const {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(line.offset) / bin_mm_));
  }
  [[nodiscard]] std::int64_t along_of(float mm) const {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(mm) / along_mm_));
  }
  // Keys of neighbouring bins across and along are consecutive numbers.
  [[nodiscard]] static std::uint64_t key(std::int64_t angle, std::int64_t offset) {
    return mixed(static_cast<std::uint64_t>(angle)) + static_cast<std::uint64_t>(offset) * kAlongs;
  }

  static constexpr std::uint64_t kAlongs = 128;  // more than the bins along a line

  PagePoint middle_;
  double bin_mm_, along_mm_;
  float near_, slack_;  ///< with allowance for rounding and small angles
  float drift_;         ///< shift along the line between segments that share a part
};

}  // namespace popcut
