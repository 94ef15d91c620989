// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>

namespace popcut {

/// One form of GPGL's binary relative draw, BE1, BE2 and BE3 (Cameo 3 and later).
///
/// A delta is one number, `carriage' * W + feed'` with `W = 2 half` and both axes shifted by
/// `half`, written in base 224, least digit first, 0x20 added to each digit: no byte collides with
/// ETX or ESC. Observed on Cameo 3, firmware 1.60, except BE3, for which we have no capture; it is
/// assumed to follow the same rule.
struct DeltaForm {
  int number;         ///< the digit after BE
  int digits;         ///< bytes per point
  std::int64_t half;  ///< deltas of -(half - 1) .. half - 1 units fit in each axis
};

inline constexpr std::array<DeltaForm, 3> kDeltaForms{{{1, 2, 112}, {2, 3, 1676}, {3, 5, 375482}}};
inline constexpr std::int64_t kDeltaBase = 224;
inline constexpr unsigned char kDeltaZero = 0x20;

/// The shortest form that holds the delta; null if no form does.
[[nodiscard]] constexpr const DeltaForm* shortest_form(std::int64_t feed, std::int64_t carriage) {
  for (const DeltaForm& form : kDeltaForms) {
    if (feed > -form.half && feed < form.half && carriage > -form.half && carriage < form.half)
      return &form;
  }
  return nullptr;
}

/// Writes `form.digits` bytes of one delta by `put(char)`. The delta must fit the form.
template <typename Put>
constexpr void put_delta(const DeltaForm& form, std::int64_t feed, std::int64_t carriage, Put put) {
  std::int64_t index = (carriage + form.half) * 2 * form.half + (feed + form.half);
  for (int k = 0; k < form.digits; ++k) {
    put(static_cast<char>(static_cast<unsigned char>(index % kDeltaBase + kDeltaZero)));
    index /= kDeltaBase;
  }
}

struct Delta {
  std::int64_t feed{};
  std::int64_t carriage{};
};

/// The delta that an index encodes.
[[nodiscard]] constexpr Delta delta_of(const DeltaForm& form, std::int64_t index) {
  return {index % (2 * form.half) - form.half, index / (2 * form.half) - form.half};
}

}  // namespace popcut
